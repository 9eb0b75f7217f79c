// The glTF files of the render tests.
#pragma once

#include <filesystem>

/// Into a folder that holds the textures of make_test_scenes:
/// - mirrored_node.gltf, mirrored_node_tangents.glb: plate.obj, but its left half is the right one
///   under a node that mirrors it.
/// - texture_transform.glb: four plates with letters; upright, turned, repeated and moved.
/// - sides.glb: three plates; one faces the viewer, one faces away and is not drawn, one faces away
///   and is double-sided.
void write_gltf_scenes(const std::filesystem::path& folder);
