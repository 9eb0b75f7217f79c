// The faces around a vertex, where they plainly are one of MikkTSpace's groups, as nearly all are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>

#include "cw2-bake/geometry/tangent_directions.h"

namespace bake {

/// Holds anything until it is cleared.
class alignas(64) Fan {
 public:
    void clear() {
        weighted_s_ = s_ = t_ = glm::vec3(0.0f);
        count_ = usable_ = preserving_ = last_source_ = 0;
        in_order_ = true;
    }

    /// Adds lane `i` of a face's spokes at the vertex, with the vertices of the face that come next
    /// and before, and the face's number in the source.
    void add(const SpokeLanes& spokes, std::size_t i, std::uint32_t next, std::uint32_t previous,
             std::uint32_t source) {
        const std::size_t place = count_ < kFew ? count_ : kFew - 1;
        next_[place] = next;
        previous_[place] = previous;
        weighted_s_ += spokes.weighted_s.get(i);
        s_ += spokes.s.get(i);
        t_ += spokes.t.get(i);
        ++count_;
        usable_ += spokes.usable[i];
        preserving_ += spokes.preserving[i];
        in_order_ &= source >= last_source_;
        last_source_ = source;
    }

    /// That of the vertex, see FramedVertex, if it is shown that all faces are one group, no two of
    /// them opposite, and they came in the order of the source, in which MikkTSpace sums them.
    std::optional<glm::vec4> tangent() const;

 private:
    static constexpr std::size_t kFew = 8;
    bool hangs_together() const;

    glm::vec3 weighted_s_;
    glm::vec3 s_;
    glm::vec3 t_;
    std::uint32_t count_;  // of faces
    std::uint32_t usable_;
    std::uint32_t preserving_;
    std::uint32_t last_source_;
    bool in_order_;
    // Of the first few faces; left as they are by clear().
    alignas(64) std::uint32_t next_[kFew];
    std::uint32_t previous_[kFew];
};

}  // namespace bake
