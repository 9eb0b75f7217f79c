#include "cw2/render/shown_triangles.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "cw2/render/visibility.h"

namespace cw2 {

namespace {

/// Pixels; devices' floats and their rounding to 1/256 pixel move corners by less.
constexpr float kRounding = 1.0f / 64.0f;
/// Of a depth; devices' floats err by less.
constexpr float kDepthErrors = 3e-4f;
/// Triangles that are gathered, see Gatherer::gather().
constexpr std::size_t kRun = 4096;
constexpr float kAlwaysSeen = std::numeric_limits<float>::infinity();

/// A vertex, seen from the camera.
struct SeenCorner {
    glm::vec3 clip;  ///< x, y and w in clip space, where z is always the near plane's distance
    PictureCorner corner;  ///< if w is positive
};

using Triangle = std::array<PictureCorner, 3>;

/// A triangle, by when it is drawn.
struct Place {
    std::uint32_t chunk;        ///< its place among those that are looked at
    std::uint32_t first_index;  ///< in its chunk
    auto operator<=>(const Place&) const = default;
};

/// What may be seen of the triangles, until all that hides is drawn.
struct Candidate {
    PixelRect around;  ///< its pixels and one more to each side
    float nearest;     ///< depth
    Place place{};
};

/// Rows of a picture, which are found out about apart. A band's depths have one row more to each
/// side, for what is next to a triangle.
struct Band {
    int top, bottom;  ///< rows of the picture, bottom is the last

    int first_row() const { return std::max(top - 1, 0); }
};

/// Bands of at least so many rows, as what lies in two is looked at twice.
std::vector<Band> bands_of(int height) {
    constexpr int kLeastRows = 32;
    const int count = std::clamp(height / kLeastRows, 1, int{std::tuple_size_v<BandDepths>});
    std::vector<Band> bands;
    for (int i = 0; i < count; ++i)
        bands.push_back({height * i / count, height * (i + 1) / count - 1});
    return bands;
}

float least(float a, float b, float c) {
    return std::min(std::min(a, b), c);
}
float most(float a, float b, float c) {
    return std::max(std::max(a, b), c);
}

/// The first and the last pixel whose centre may lie to one side of `edge`, pixels, which is
/// within a depth buffer's reach.
int first_center(float edge) {
    constexpr float kAbove = 2.0f * DepthBuffer::kReach;
    return static_cast<int>(kAbove) - static_cast<int>(kAbove - (edge - 0.5f - kRounding));
}
int last_center(float edge) {
    constexpr float kAbove = 2.0f * DepthBuffer::kReach;
    return static_cast<int>(kAbove + (edge - 0.5f + kRounding)) - static_cast<int>(kAbove);
}

/// Finds what is shown in a band.
class Finder {
 public:
    Finder(const SceneTriangles& scene, const PictureView& view, const Band& band,
           DepthBuffer& depth)
        : scene_(scene),
          near_(view.near),
          clip_(view.clip_from_world),
          depth_(depth),
          width_(static_cast<int>(view.area.extent.width)),
          height_(std::min(band.bottom + 1, static_cast<int>(view.area.extent.height) - 1) -
                  band.first_row() + 1),
          top_(band.top - band.first_row()),
          bottom_(band.bottom - band.first_row()),
          half_(0.5f * glm::vec2(view.extent.width, view.extent.height)),
          center_(half_ - glm::vec2(view.area.offset.x, view.area.offset.y + band.first_row())) {
        for (const Draw& draw : scene.draws) {
            first_vertex_.push_back(vertices_);
            vertices_ += draw.vertex_count;
        }
        // Of x, y, w, 1 in world space: what is above the band, and what is below it.
        const auto row = [&](glm::length_t i) {
            return glm::vec4(clip_[0][i], clip_[1][i], clip_[2][i], clip_[3][i]);
        };
        const auto edge = [&](int y) { return (static_cast<float>(y) - center_.y) / half_.y; };
        constexpr int kSpare = 2;
        planes_ = {row(1) - edge(-kSpare) * row(3), edge(height_ + kSpare) * row(3) - row(1)};
        for (std::size_t i = 0; i < 2; ++i) lengths_[i] = glm::length(glm::vec3(planes_[i]));
        depth_.clear(width_, height_);
    }

    /// The chunks' triangles, from near to far; `place` is the chunk's among them.
    void add(std::uint32_t place, const SceneChunk& chunk) {
        for (std::size_t i = 0; i < 2; ++i) {
            if (glm::dot(planes_[i], glm::vec4(chunk.center, 1.0f)) < -chunk.radius * lengths_[i])
                return;
        }
        const Draw& draw = scene_.draws[chunk.draw];
        const std::span<const std::uint16_t> corners = scene_.indices.subspan(
            draw.index_offset / sizeof(std::uint16_t) + chunk.first_index, chunk.index_count);
        std::uint16_t first = corners[0], last = corners[0];
        for (const std::uint16_t corner : corners) {
            first = std::min(first, corner);
            last = std::max(last, corner);
        }
        const glm::vec3* const positions =
            scene_.positions.data() + first_vertex_[chunk.draw] + first;
        // The vertices of a chunk lie together as a rule; then each is transformed once.
        const std::size_t range = std::size_t{last} - first + 1u;
        const bool lie_together = range <= corners.size();
        seen_.resize(lie_together ? range : corners.size());
        for (std::size_t i = 0; i < seen_.size(); ++i)
            see(positions[lie_together ? i : corners[i] - first], seen_[i]);
        for (std::uint32_t i = 0; i < corners.size(); i += 3) {
            const auto at = [&](std::uint32_t k) -> const SeenCorner& {
                return seen_[lie_together ? corners[k] - first : k];
            };
            std::optional<Candidate> candidate =
                draw_triangle({&at(i), &at(i + 1), &at(i + 2)}, draw);
            if (!candidate) continue;
            candidate->place = {place, i};
            candidates_.push_back(*candidate);
        }
    }

    /// Of what was added, in that order.
    std::vector<Place> shown() {
        std::vector<Place> shown;
        for (const Candidate& candidate : candidates_) {
            if (!is_hidden(candidate)) shown.push_back(candidate.place);
        }
        return shown;
    }

 private:
    void see(const glm::vec3& p, SeenCorner& out) const {
        const float x = clip_[0].x * p.x + clip_[1].x * p.y + clip_[2].x * p.z + clip_[3].x;
        const float y = clip_[0].y * p.x + clip_[1].y * p.y + clip_[2].y * p.z + clip_[3].y;
        const float w = clip_[0].w * p.x + clip_[1].w * p.y + clip_[2].w * p.z + clip_[3].w;
        out = {{x, y, w}, in_picture({x, y, w})};
    }

    PictureCorner in_picture(const glm::vec3& clip) const {
        const float scale = 1.0f / clip.z;
        return {clip.x * scale * half_.x + center_.x, clip.y * scale * half_.y + center_.y,
                near_ * scale};
    }

    /// Whether one of a few pixels' centres is in the triangle or next to its edges.
    static bool covers_center(const Triangle& t, const PixelRect& centers) {
        constexpr int kFew = 2;
        if (centers.right - centers.left >= kFew || centers.bottom - centers.top >= kFew)
            return true;
        const float side = signed_area(t) < 0.0f ? -1.0f : 1.0f;
        for (int y = centers.top; y <= centers.bottom; ++y) {
            for (int x = centers.left; x <= centers.right; ++x) {
                bool inside = true;
                for (std::size_t i = 0; i < 3; ++i) {
                    const PictureCorner &a = t[i], &b = t[(i + 1) % 3];
                    const float dx = b.x - a.x, dy = b.y - a.y;
                    const float at = side * (dx * (static_cast<float>(y) + 0.5f - a.y) -
                                             dy * (static_cast<float>(x) + 0.5f - a.x));
                    inside &= at >= -kRounding * (std::abs(dx) + std::abs(dy));
                }
                if (inside) return true;
            }
        }
        return false;
    }

    /// Draws it if it hides what is behind it. Nothing where it is not seen.
    std::optional<Candidate> draw_triangle(const std::array<const SeenCorner*, 3>& corners,
                                           const Draw& draw) {
        const float nearest_w = least(corners[0]->clip.z, corners[1]->clip.z, corners[2]->clip.z);
        if (nearest_w < near_ * (1.0f + kDepthErrors)) return draw_cut(corners, draw);
        const Triangle triangle{corners[0]->corner, corners[1]->corner, corners[2]->corner};
        const float left = least(triangle[0].x, triangle[1].x, triangle[2].x);
        const float right = most(triangle[0].x, triangle[1].x, triangle[2].x);
        const float top = least(triangle[0].y, triangle[1].y, triangle[2].y);
        const float bottom = most(triangle[0].y, triangle[1].y, triangle[2].y);
        // NaNs fail all comparisons.
        if (!(left > -DepthBuffer::kReach && top > -DepthBuffer::kReach &&
              right < DepthBuffer::kReach && bottom < DepthBuffer::kReach))
            return draw_cut(corners, draw);
        const PixelRect centers{first_center(left), first_center(top), last_center(right),
                                last_center(bottom)};
        if (centers.left > centers.right || centers.top > centers.bottom) return std::nullopt;
        if (centers.right < 0 || centers.bottom < 0 || centers.left >= width_ ||
            centers.top >= height_)
            return std::nullopt;

        const float area = signed_area(triangle);
        const float length = (right - left) + (bottom - top);
        const bool looks_away = draw.cull_back && area > 0.0f;
        if (looks_away && area > kRounding * length) return std::nullopt;
        const Candidate candidate{
            {centers.left - 1, centers.top - 1, centers.right + 1, centers.bottom + 1},
            (1.0f + kDepthErrors) * near_ / nearest_w};
        if (!covers_center(triangle, centers)) return std::nullopt;
        // What is hidden now stays so.
        if (depth_.hides(candidate.around, candidate.nearest)) return std::nullopt;
        if (!looks_away && occludes(draw)) depth_.draw(triangle);
        if (centers.bottom < top_ || centers.top > bottom_) return std::nullopt;
        return candidate;
    }

    static bool occludes(const Draw& draw) { return !draw.alpha_mask; }

    /// The same of one that reaches behind the near plane, or far beside the picture: it is cut,
    /// and taken to be seen.
    std::optional<Candidate> draw_cut(const std::array<const SeenCorner*, 3>& corners,
                                      const Draw& draw) {
        if (most(corners[0]->clip.z, corners[1]->clip.z, corners[2]->clip.z) <
            near_ * (1.0f - kDepthErrors))
            return std::nullopt;
        const Candidate candidate{{0, 0, width_, height_}, kAlwaysSeen};
        if (!occludes(draw)) return candidate;
        // Half of what a depth buffer takes.
        const float reach_x = 0.5f * DepthBuffer::kReach / half_.x;
        const float reach_y = 0.5f * DepthBuffer::kReach / half_.y;
        const std::array<glm::vec4, 5> planes{
            // Of x, y, w, 1.
            glm::vec4{0.0f, 0.0f, 1.0f, -near_ * (1.0f + kDepthErrors)},
            glm::vec4{1.0f, 0.0f, reach_x, 0.0f}, glm::vec4{-1.0f, 0.0f, reach_x, 0.0f},
            glm::vec4{0.0f, 1.0f, reach_y, 0.0f}, glm::vec4{0.0f, -1.0f, reach_y, 0.0f}};
        const CutTriangle polygon =
            cut({corners[0]->clip, corners[1]->clip, corners[2]->clip}, planes);
        for (std::size_t i = 2; i < polygon.count; ++i) {
            const Triangle triangle{in_picture(polygon.corners[0]),
                                    in_picture(polygon.corners[i - 1]),
                                    in_picture(polygon.corners[i])};
            const bool is_finite = std::ranges::all_of(triangle, [](const PictureCorner& corner) {
                return std::abs(corner.x) < DepthBuffer::kReach &&
                       std::abs(corner.y) < DepthBuffer::kReach;
            });
            const bool looks_away = draw.cull_back && signed_area(triangle) > 0.0f;
            if (is_finite && !looks_away) depth_.draw(triangle);
        }
        return candidate;
    }

    bool is_hidden(const Candidate& candidate) {
        constexpr int kFewPixels = 64;
        const PixelRect& r = candidate.around;
        if (depth_.hides(r, candidate.nearest)) return true;
        return (r.right - r.left + 1) * (r.bottom - r.top + 1) <= kFewPixels &&
               depth_.hides_exactly(r, candidate.nearest);
    }

    const SceneTriangles& scene_;
    float near_;
    glm::mat4 clip_;
    DepthBuffer& depth_;
    int width_;  ///< of what is drawn, pixels
    int height_;
    int top_;  ///< the band's first row of these, and its last
    int bottom_;
    glm::vec2 half_;    ///< of the picture, pixels
    glm::vec2 center_;  ///< of the picture, pixels from what is drawn
    std::array<glm::vec4, 2> planes_{};
    std::array<float, 2> lengths_{};
    std::vector<std::size_t> first_vertex_;
    std::size_t vertices_ = 0;
    std::vector<SeenCorner> seen_;  ///< of the chunk at hand
    std::vector<Candidate> candidates_;
};

/// Puts triangles together as they are drawn.
class Gatherer {
 public:
    Gatherer(const SceneTriangles& scene, std::span<const std::uint32_t> chunks)
        : scene_(scene), chunks_(chunks) {}

    ShownTriangles gathered(std::vector<Place> places) const {
        ShownTriangles shown;
        shown.indices.resize(3 * places.size());
        std::uint16_t* end = shown.indices.data();
        for (std::size_t first = 0; first < places.size(); first += kRun) {
            const std::span run =
                std::span(places).subspan(first, std::min(kRun, places.size() - first));
            gather(run);
            for (const Place& place : run) end = append(place, end, shown);
        }
        return shown;
    }

 private:
    const SceneChunk& chunk_of(const Place& place) const {
        return scene_.chunks[chunks_[place.chunk]];
    }

    /// A draw call takes as long as some dozens of triangles: where the order from near to far asks
    /// for one for every few, those of a draw go together.
    void gather(std::span<Place> run) const {
        constexpr std::size_t kFew = 32;
        const auto rank = [&](const Place& place) {
            const std::uint32_t draw = chunk_of(place).draw;
            return std::pair(scene_.draws[draw].shading, draw);
        };
        std::size_t calls = 0;
        for (std::size_t i = 1; i < run.size(); ++i) calls += rank(run[i - 1]) != rank(run[i]);
        if (calls * kFew > run.size()) std::ranges::stable_sort(run, {}, rank);
    }

    /// Writes its corners to `end`, and returns where the next ones go.
    std::uint16_t* append(const Place& place, std::uint16_t* end, ShownTriangles& shown) const {
        const SceneChunk& chunk = chunk_of(place);
        if (shown.ranges.empty() || shown.ranges.back().draw != chunk.draw) {
            const auto first = static_cast<std::uint32_t>(end - shown.indices.data());
            shown.ranges.push_back({chunk.draw, first, 0});
        }
        const std::uint16_t* const corners =
            scene_.indices.data() + scene_.draws[chunk.draw].index_offset / sizeof(std::uint16_t) +
            chunk.first_index + place.first_index;
        shown.ranges.back().index_count += 3;
        return std::copy_n(corners, 3, end);
    }

    const SceneTriangles& scene_;
    std::span<const std::uint32_t> chunks_;
};

/// Of two ordered lists, what is in one of them or in both.
std::vector<Place> united(const std::vector<Place>& a, const std::vector<Place>& b) {
    std::vector<Place> all;
    all.reserve(a.size() + b.size());
    std::ranges::set_union(a, b, std::back_inserter(all));
    return all;
}

}  // namespace

ShownTriangles shown_triangles(const SceneTriangles& scene, std::span<const std::uint32_t> chunks,
                               const PictureView& view, BandDepths& depths) {
    const std::vector<Band> bands = bands_of(static_cast<int>(view.area.extent.height));
    std::vector<std::vector<Place>> shown(bands.size());
    tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t i) {
        Finder finder(scene, view, bands[i], depths[i]);
        for (std::uint32_t place = 0; place < chunks.size(); ++place)
            finder.add(place, scene.chunks[chunks[place]]);
        shown[i] = finder.shown();
    });
    std::vector<Place> all;
    for (std::vector<Place>& of_band : shown) all = united(all, of_band);
    return Gatherer(scene, chunks).gathered(std::move(all));
}

}  // namespace cw2
