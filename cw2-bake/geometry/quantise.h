// Vertices to their packed form, and the error that this makes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cw2-bake/base/advance.h"
#include "cw2-bake/base/raw_vector.h"
#include "cw2-bake/geometry/chunks.h"
#include "mesh-format/layout.h"

namespace bake {

struct QuantiseSettings {
    mesh_format::FrameForm frame_form;
    mesh_format::PositionForm position_form;  ///< f32 keeps UVs as floats, too
};

/// The packed form of all meshes: the sections of the file that hold geometry.
struct PackedGeometry {
    mesh_format::SceneRecord scene{};
    std::vector<mesh_format::MeshRecord> meshes;  ///< as the input, in its order
    std::vector<mesh_format::ChunkRecord> chunks;
    RawVector<std::byte> vertices;
    std::span<const std::uint16_t> indices;  ///< the input's
};

/// Packs meshes that together are the scene. `materials` has an entry for each material.
///
/// Positions go to one lattice of a power-of-two step, the finest on which every mesh spans at
/// most 65,536 points and every coordinate stays below 2^24 steps from the origin. UVs go to a
/// lattice for each mesh; where half its step exceeds 1/8 texel the mesh keeps float UVs.
PackedGeometry quantise(const FramedScene& scene, const ChunkedScene& chunked,
                        std::span<const UvBudget> materials, const QuantiseSettings& settings,
                        const Advance& advance = kUnwatched);

}  // namespace bake
