// Which triangles a picture shows, against rays in doubles.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <vector>

#include "cw2/render/camera.h"
#include "cw2/render/shown_triangles.h"
#include "cw2/render/visibility.h"

namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kNear = 0.01f;

/// Soups of triangles, a draw each of: opaque with both sides, opaque with front sides, masked.
struct Soup {
    std::vector<glm::vec3> positions;
    std::vector<std::uint16_t> indices;
    std::vector<cw2::SceneChunk> chunks;
    std::vector<cw2::Draw> draws;

    void add_draw(bool cull_back, bool alpha_mask) {
        cw2::Draw draw{};
        draw.shading = alpha_mask ? cw2::Shading::alpha_mask : cw2::Shading::opaque;
        draw.alpha_mask = alpha_mask;
        draw.cull_back = cull_back;
        draw.index_offset = indices.size() * sizeof(std::uint16_t);
        draws.push_back(draw);
    }
    /// Chunks are of triangles that follow each other; every third refers to its draw's first
    /// vertex, too, so that its vertices do not lie together.
    void add_chunk(const std::vector<std::array<glm::vec3, 3>>& triangles) {
        cw2::Draw& draw = draws.back();
        glm::vec3 low(1e30f), high(-1e30f);
        const auto draw_begin =
            static_cast<std::uint32_t>(draw.index_offset / sizeof(std::uint16_t));
        const auto first = static_cast<std::uint32_t>(indices.size()) - draw_begin;
        for (const auto& triangle : triangles) {
            for (const glm::vec3& corner : triangle) {
                indices.push_back(static_cast<std::uint16_t>(draw.vertex_count++));
                positions.push_back(corner);
                low = min(low, corner);
                high = max(high, corner);
            }
        }
        if (chunks.size() % 3 == 2) {
            for (int i = 0; i < 3; ++i) indices.push_back(0);
            const glm::vec3 far_away = positions[positions.size() - draw.vertex_count];
            low = min(low, far_away);
            high = max(high, far_away);
        }
        const glm::vec3 center = 0.5f * (low + high);
        chunks.push_back(
            {.center = center,
             .radius = 1.001f * glm::distance(center, high),
             .cone_axis = {0.0f, 0.0f, 1.0f},
             .cone_cutoff = 1.0f,
             .draw = static_cast<std::uint32_t>(draws.size() - 1),
             .first_index = first,
             .index_count = static_cast<std::uint32_t>(indices.size()) - draw_begin - first});
    }
    cw2::SceneTriangles triangles() const { return {positions, indices, chunks, draws}; }
};

Soup make_soup(std::mt19937& random, float size) {
    std::uniform_real_distribution<float> place(-3.0f, 3.0f), part(-1.0f, 1.0f);
    Soup soup;
    for (const auto& [cull_back, alpha_mask] :
         {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
        soup.add_draw(cull_back, alpha_mask);
        for (int chunk = 0; chunk < 8; ++chunk) {
            const glm::vec3 center(place(random), place(random), place(random));
            std::vector<std::array<glm::vec3, 3>> triangles;
            for (int i = 0; i < 40; ++i) {
                const float scale = i % 10 == 0 ? 4.0f * size : size;
                std::array<glm::vec3, 3> triangle;
                const glm::vec3 middle =
                    center + glm::vec3(part(random), part(random), part(random));
                for (glm::vec3& corner : triangle)
                    corner = middle + scale * glm::vec3(part(random), part(random), part(random));
                triangles.push_back(triangle);
            }
            soup.add_chunk(triangles);
        }
    }
    return soup;
}

/// Where a ray meets a triangle (Möller and Trumbore 1997), and whether its front.
struct Hit {
    double distance;
    bool front;
};
std::optional<Hit> hit(const glm::dvec3& from, const glm::dvec3& along,
                       const std::array<glm::dvec3, 3>& t) {
    const glm::dvec3 a = t[1] - t[0], b = t[2] - t[0], p = cross(along, b);
    const double det = dot(a, p);
    if (det == 0.0) return std::nullopt;
    const glm::dvec3 s = from - t[0], q = cross(s, a);
    const double u = dot(s, p) / det, v = dot(along, q) / det;
    if (u < 0.0 || v < 0.0 || u + v > 1.0) return std::nullopt;
    return Hit{dot(b, q) / det, det > 0.0};
}

using Name = std::array<std::uint32_t, 4>;  ///< a draw and three vertices of it

std::set<Name> names_of(const cw2::ShownTriangles& shown) {
    std::set<Name> names;
    for (const cw2::DrawRange& range : shown.ranges) {
        for (std::uint32_t i = 0; i < range.index_count; i += 3) {
            const auto* const corner = shown.indices.data() + range.first_index + i;
            names.insert({range.draw, corner[0], corner[1], corner[2]});
        }
    }
    return names;
}

struct Picture {
    cw2::Camera camera;
    VkRect2D area;
    glm::vec2 offset{0.0f};  ///< of the samples from the pixels' centres

    cw2::PictureView view() const {
        glm::mat4 projection =
            cw2::clip_from_view(camera.vertical_fov, static_cast<float>(kWidth) / kHeight, kNear);
        projection[2][0] = 2.0f * offset.x / kWidth;
        projection[2][1] = 2.0f * offset.y / kHeight;
        return {projection * cw2::view_from_world(camera), kNear, {kWidth, kHeight}, area};
    }
    glm::dvec3 along(int x, int y) const {
        const cw2::CameraAxes axes = cw2::axes_of(camera);
        const double slope = std::tan(0.5 * static_cast<double>(camera.vertical_fov));
        const double right = (2.0 * (x + 0.5 + static_cast<double>(offset.x)) - kWidth) / kHeight;
        const double down = (2.0 * (y + 0.5 + static_cast<double>(offset.y)) - kHeight) / kHeight;
        return -axes.back + slope * (right * axes.right - down * axes.up);
    }
};

/// All that some pixel shows: the nearest opaque triangle, and masked ones before it.
std::set<Name> seen_by_rays(const Soup& soup, const Picture& picture) {
    struct Known {
        Name name;
        std::array<glm::dvec3, 3> corners;
        const cw2::Draw* draw;
    };
    std::vector<Known> all;
    std::size_t vertex = 0;
    for (std::uint32_t d = 0; d < soup.draws.size(); ++d) {
        for (const cw2::SceneChunk& chunk : soup.chunks) {
            if (chunk.draw != d) continue;
            const auto* const corner = soup.indices.data() +
                                       soup.draws[d].index_offset / sizeof(std::uint16_t) +
                                       chunk.first_index;
            for (std::uint32_t i = 0; i < chunk.index_count; i += 3)
                all.push_back(
                    {{d, corner[i], corner[i + 1], corner[i + 2]},
                     {soup.positions[vertex + corner[i]], soup.positions[vertex + corner[i + 1]],
                      soup.positions[vertex + corner[i + 2]]},
                     &soup.draws[d]});
        }
        vertex += soup.draws[d].vertex_count;
    }
    std::set<Name> seen;
    const glm::dvec3 eye = picture.camera.position;
    for (int y = picture.area.offset.y;
         y < picture.area.offset.y + static_cast<int>(picture.area.extent.height); ++y) {
        for (int x = picture.area.offset.x;
             x < picture.area.offset.x + static_cast<int>(picture.area.extent.width); ++x) {
            const glm::dvec3 along = picture.along(x, y);
            double nearest = 1e30;
            std::multimap<double, const Known*> hits;
            for (const Known& known : all) {
                const auto found = hit(eye, along, known.corners);
                // Beyond the near plane: the direction goes 1 along the camera's.
                if (!found || found->distance < static_cast<double>(kNear) ||
                    (known.draw->cull_back && !found->front))
                    continue;
                hits.emplace(found->distance, &known);
                if (!known.draw->alpha_mask) nearest = std::min(nearest, found->distance);
            }
            for (const auto& [distance, known] : hits)
                if (distance <= nearest) seen.insert(known->name);
        }
    }
    return seen;
}

cw2::ShownTriangles shown_of(const Soup& soup, const Picture& picture) {
    std::vector<std::uint32_t> chunks;
    const cw2::PictureView view = picture.view();
    cw2::find_visible(soup.chunks, soup.draws, view.clip_from_world, picture.camera.position,
                      chunks);
    cw2::BandDepths depths;
    return cw2::shown_triangles(soup.triangles(), chunks, view, depths);
}

constexpr VkRect2D kAll{{0, 0}, {kWidth, kHeight}};

TEST(ShownTriangles, HoldAllThatRaysMeet) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> place(-4.0f, 4.0f), offset(-0.5f, 0.5f);
    for (const float size : {0.05f, 0.4f, 3.0f}) {
        for (int i = 0; i < 4; ++i) {
            const Soup soup = make_soup(random, size);
            const Picture picture{{{place(random), place(random), place(random)},
                                   {place(random), place(random), 0.5f},
                                   i % 2 == 0 ? 1.0f : 2.2f},
                                  i == 3 ? VkRect2D{{31, 17}, {40, 50}} : kAll,
                                  {offset(random), offset(random)}};
            const std::set<Name> shown = names_of(shown_of(soup, picture));
            std::size_t missing = 0;
            for (const Name& name : seen_by_rays(soup, picture)) missing += !shown.contains(name);
            EXPECT_EQ(missing, 0u) << "size " << size << ", picture " << i;
            std::size_t count = 0;
            for (const cw2::SceneChunk& chunk : soup.chunks) count += chunk.index_count / 3;
            EXPECT_LT(shown.size(), count * 4 / 5) << "size " << size << ", picture " << i;
        }
    }
}

TEST(ShownTriangles, AWallHidesWhatIsBehindAndAMaskedOneDoesNot) {
    const std::array<glm::vec3, 3> upper{glm::vec3{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}};
    const std::array<glm::vec3, 3> lower{glm::vec3{-9, -9, 0}, {9, 9, 0}, {-9, 9, 0}};
    std::vector<std::array<glm::vec3, 3>> behind;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 at(0.02f * static_cast<float>(i % 10), 0.02f * static_cast<float>(i / 10),
                           -1);
        behind.push_back({at, at + glm::vec3(0.3f, 0, 0), at + glm::vec3(0, 0.3f, 0)});
    }
    const Picture picture{{{0, 0, 3}, {0, 0, 0}, 1.0f}, kAll};
    for (const bool masked : {false, true}) {
        Soup soup;
        soup.add_draw(true, masked);
        soup.add_chunk({upper, lower});
        soup.add_draw(true, false);
        soup.add_chunk(behind);
        const std::size_t shown = names_of(shown_of(soup, picture)).size();
        EXPECT_EQ(shown, masked ? 102u : 2u);
        // From behind the wall's back sides are culled: it hides nothing, nor do backs draw.
        Picture back = picture;
        back.camera.position.z = -3;
        EXPECT_EQ(names_of(shown_of(soup, back)).size(), 0u);
    }
}

TEST(ShownTriangles, AreFewMoreThanPixelsWhereTrianglesAreTiny) {
    // Some seven triangles a pixel, in chunks of several draws by turns.
    constexpr int kColumns = 480, kRows = 36;
    Soup soup;
    for (int draw = 0; draw < 4; ++draw) {
        soup.add_draw(true, false);
        for (int row = draw * kRows / 4; row < (draw + 1) * kRows / 4; ++row) {
            std::vector<std::array<glm::vec3, 3>> triangles;
            for (int column = 0; column < kColumns; ++column) {
                const auto at = [&](int x, int y) {
                    return glm::vec3(0.01f * static_cast<float>(column + x - kColumns / 2),
                                     0.01f * static_cast<float>(row + y - kRows / 2), 0.0f);
                };
                triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
                triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
            }
            soup.add_chunk(triangles);
        }
    }
    const Picture picture{{{0, 0, 3}, {0, 0, 0}, 1.0f}, {{60, 50}, {40, 20}}};
    const std::set<Name> shown = names_of(shown_of(soup, picture));
    const std::set<Name> seen = seen_by_rays(soup, picture);
    EXPECT_TRUE(std::ranges::includes(shown, seen));
    EXPECT_GT(seen.size(), 200u);
    EXPECT_LT(shown.size(), seen.size() * 8 / 5);
}

TEST(ShownTriangles, FewOfManyDrawsGoTogether) {
    // Chunks of one triangle, side by side, of two draws by turns.
    Soup soup;
    std::vector<cw2::SceneChunk> chunks;
    for (int draw = 0; draw < 2; ++draw) {
        soup.add_draw(true, false);
        for (int i = draw; i < 200; i += 2) {
            const glm::vec3 at(0.01f * static_cast<float>(i) - 1.0f, 0.0f,
                               0.001f * static_cast<float>(i));
            soup.add_chunk({{at, at + glm::vec3(0.1f, 0, 0), at + glm::vec3(0, 0.1f, 0)}});
        }
    }
    const cw2::ShownTriangles shown = shown_of(soup, {{{0, 0, 3}, {0, 0, 0}, 1.0f}, kAll});
    EXPECT_EQ(names_of(shown).size(), 200u);
    EXPECT_EQ(shown.ranges.size(), 2u);
}

TEST(ShownTriangles, ATriangleThroughTheCameraHidesToo) {
    // A floor of two triangles that reaches behind the camera, and tiles below it.
    Soup soup;
    soup.add_draw(false, false);
    soup.add_chunk({{glm::vec3{-500, -1, -500}, {500, -1, -500}, {500, -1, 500}},
                    {glm::vec3{-500, -1, -500}, {500, -1, 500}, {-500, -1, 500}}});
    soup.add_draw(false, false);
    std::vector<std::array<glm::vec3, 3>> tiles;
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 at(static_cast<float>(i % 10) - 5.0f, -2.0f,
                           -2.0f - static_cast<float>(i / 10));
        tiles.push_back({at, at + glm::vec3(1, 0, 0), at + glm::vec3(0, 0, 1)});
    }
    soup.add_chunk(tiles);
    const Picture picture{{{0, 0, 0}, {0, -0.5f, -1}, 1.2f}, kAll};
    EXPECT_EQ(names_of(shown_of(soup, picture)).size(), 2u);
}

}  // namespace
