// Scenes that lie far from where their coordinates count from: georeferenced scans, for example.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "cw2-bake/base/source_scene.h"

namespace bake {

/// An origin for positions that are so far from (0, 0, 0), measured by the extent of those that
/// corners refer to, that floats hold their differences badly: then the positions are to be read
/// again in double, relative to it. A multiple of a power of two near the extent, so that few
/// digits state it. What is then read can be so small that it lies far from that origin, again, up
/// to kMostOrigins times: each brings 24 bits, of the 53 of a double. Nothing where the positions
/// are close enough, which is nearly always and is told by looking at few of them.
std::optional<glm::dvec3> distant_origin(std::span<const glm::vec3> positions,
                                         std::span<const Corner> corners);
inline constexpr int kMostOrigins = 3;

}  // namespace bake
