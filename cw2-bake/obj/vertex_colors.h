// Colours of an OBJ's positions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "cw2-bake/obj/chunk.h"
#include "cw2-bake/obj/read_mtl.h"

namespace bake {

/// Gathers them in the order of the text.
class VertexColors {
 public:
    /// `color` is as stated.
    void set(std::size_t position, const glm::vec3& color);
    /// See ObjPolypaint; `positions` come before it in the text.
    void paint(std::size_t positions, std::uint32_t color);
    /// As ObjContents::colors. Where some value is 10 or more all are taken as 0 to 255, else they
    /// are clamped to [0, 1], of which `notes` has been told already.
    std::vector<std::uint32_t> finish(std::size_t position_count, std::vector<ObjNote>& notes) &&;

 private:
    void apply_paint();

    std::vector<glm::vec3> colors_;  // by position; NaN where there is none
    std::vector<std::uint32_t> paint_;
    std::size_t painted_positions_ = 0;
};

/// Gives corners the colours of their positions. A material that is used by such and states no
/// colour of its own gets the factor 1, and its other corners the grey that it would have had.
void color_corners(const std::vector<std::uint32_t>& colors, std::vector<MtlMaterial>& materials,
                   SourceScene& scene);

}  // namespace bake
