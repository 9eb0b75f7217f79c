// The host's depth buffer: which pixels a triangle covers, and how deep.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "cw2/render/depth_buffer.h"

namespace {

using cw2::DepthBuffer;
using cw2::PictureCorner;
using Triangle = std::array<PictureCorner, 3>;

constexpr int kWidth = 301, kHeight = 203;

/// Whether the buffer holds more than nothing at a pixel.
bool is_covered(const DepthBuffer& buffer, int x, int y) {
    return buffer.hides_exactly({x, y, x, y}, 0.0f);
}

/// The depth of a pixel, between two floats that follow each other.
float depth_at(const DepthBuffer& buffer, int x, int y) {
    float low = 0.0f, high = 2.0f;
    for (float middle = 1.0f; middle > low && middle < high; middle = 0.5f * (low + high))
        (buffer.hides_exactly({x, y, x, y}, middle) ? low : high) = middle;
    return high;
}

/// Corners of a grid of squares, moved by so little that no triangle turns over; those at the
/// border lie on it.
struct Sheet {
    int columns, rows;
    std::vector<PictureCorner> corners;

    Sheet(int across, int down, std::mt19937& random) : columns(across), rows(down) {
        std::uniform_real_distribution<float> shift(-0.2f, 0.2f);
        for (int y = 0; y <= rows; ++y) {
            for (int x = 0; x <= columns; ++x) {
                const bool free_x = x > 0 && x<columns, free_y = y> 0 && y < rows;
                const float u = (static_cast<float>(x) + (free_x ? shift(random) : 0.0f)) /
                                static_cast<float>(columns);
                const float v = (static_cast<float>(y) + (free_y ? shift(random) : 0.0f)) /
                                static_cast<float>(rows);
                corners.push_back({u * kWidth, v * kHeight, 0.5f});
            }
        }
    }
    /// Moves corners to the nearest pixel's centre; those at the border stay outside.
    void to_centers() {
        for (PictureCorner& corner : corners) {
            if (corner.x > 1.0f && corner.x < kWidth - 1.0f) corner.x = std::floor(corner.x) + 0.5f;
            if (corner.y > 1.0f && corner.y < kHeight - 1.0f)
                corner.y = std::floor(corner.y) + 0.5f;
        }
    }
    template <typename Use>
    void each_triangle(Use use) const {
        const auto at = [&](int x, int y) {
            return corners[static_cast<std::size_t>(y * (columns + 1) + x)];
        };
        for (int y = 0; y < rows; ++y) {
            for (int x = 0; x < columns; ++x) {
                use(Triangle{at(x, y), at(x + 1, y), at(x + 1, y + 1)});
                use(Triangle{at(x, y), at(x, y + 1), at(x + 1, y + 1)});
            }
        }
    }
};

TEST(DepthBuffer, EachPixelOfASheetIsCoveredByOneTriangle) {
    std::mt19937 random(7);
    // A few pixels a triangle, many, and triangles that are no longer small.
    for (const auto& [columns, rows, on_centers] :
         {std::tuple{50, 33, false}, {50, 33, true}, {5, 3, false}, {2, 1, false}, {2, 1, true}}) {
        Sheet sheet(columns, rows, random);
        if (on_centers) sheet.to_centers();
        std::vector<int> covered(kWidth * kHeight, 0);
        sheet.each_triangle([&](const Triangle& triangle) {
            DepthBuffer alone;
            const auto [left, right] = std::minmax({triangle[0].x, triangle[1].x, triangle[2].x});
            const auto [top, bottom] = std::minmax({triangle[0].y, triangle[1].y, triangle[2].y});
            alone.clear(kWidth, kHeight);
            alone.draw(triangle);
            for (int y = std::max(0, static_cast<int>(top) - 2);
                 y < std::min(kHeight, static_cast<int>(bottom) + 2); ++y) {
                for (int x = std::max(0, static_cast<int>(left) - 2);
                     x < std::min(kWidth, static_cast<int>(right) + 2); ++x)
                    covered[static_cast<std::size_t>(y * kWidth + x)] += is_covered(alone, x, y);
            }
        });
        EXPECT_EQ(std::ranges::count(covered, 1), kWidth * kHeight) << columns << " x " << rows;
    }
}

TEST(DepthBuffer, SheetsLeaveNoHoles) {
    std::mt19937 random(8);
    for (const auto& [columns, rows] : {std::pair{400, 300}, {50, 33}, {5, 3}, {2, 1}}) {
        DepthBuffer buffer;
        buffer.clear(kWidth, kHeight);
        Sheet(columns, rows, random).each_triangle([&](const Triangle& t) { buffer.draw(t); });
        EXPECT_TRUE(buffer.hides({0, 0, kWidth - 1, kHeight - 1}, 0.49f));
        EXPECT_FALSE(buffer.hides({0, 0, kWidth - 1, kHeight - 1}, 0.5f));
    }
}

TEST(DepthBuffer, DepthIsLinearAndTheNearestStays) {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> x(-200.0f, 500.0f), y(-150.0f, 350.0f), z(0.001f, 1.0f);
    DepthBuffer buffer;
    buffer.clear(kWidth, kHeight);
    std::vector<double> truth(kWidth * kHeight, 0.0), errors(kWidth * kHeight, 0.0);
    for (int i = 0; i < 60; ++i) {
        // Some of them small.
        const float size = i % 3 == 0 ? 0.05f : 1.0f;
        const PictureCorner first{x(random), y(random), z(random)};
        Triangle t{first, first, first};
        for (PictureCorner& corner : t) {
            corner.x += size * (x(random) - 150.0f);
            corner.y += size * (y(random) - 100.0f);
            corner.depth = z(random);
        }
        buffer.draw(t);
        const double area = static_cast<double>(cw2::signed_area(t));
        for (int py = 0; py < kHeight; ++py) {
            for (int px = 0; px < kWidth; ++px) {
                std::array<double, 3> parts;
                for (std::size_t k = 0; k < 3; ++k) {
                    const PictureCorner &a = t[(k + 1) % 3], &b = t[(k + 2) % 3];
                    parts[k] =
                        ((b.x - a.x) * (py + 0.5 - a.y) - (b.y - a.y) * (px + 0.5 - a.x)) / area;
                }
                const auto at = static_cast<std::size_t>(py * kWidth + px);
                const double least = *std::ranges::min_element(parts);
                // So close to an edge its rounding decides; and thin ones are steep.
                const double rounding = 0.01 *
                                        (std::abs(t[0].x - t[1].x) + std::abs(t[0].y - t[1].y) +
                                         std::abs(t[0].x - t[2].x) + std::abs(t[0].y - t[2].y)) /
                                        std::abs(area);
                if (least < -rounding) continue;
                double depth = 0.0;
                for (std::size_t k = 0; k < 3; ++k)
                    depth += parts[k] * static_cast<double>(t[k].depth);
                if (least < rounding) errors[at] = 1.0;
                errors[at] = std::max(errors[at], rounding);
                truth[at] = std::max(truth[at], depth);
            }
        }
    }
    std::size_t compared = 0;
    for (int py = 0; py < kHeight; ++py) {
        for (int px = 0; px < kWidth; ++px) {
            const auto at = static_cast<std::size_t>(py * kWidth + px);
            if (errors[at] > 0.005) continue;
            ++compared;
            EXPECT_NEAR(static_cast<double>(depth_at(buffer, px, py)), truth[at],
                        4.0 * errors[at] + 1e-6)
                << px << "," << py;
        }
    }
    EXPECT_GT(compared, kWidth * kHeight / 2u);
}

TEST(DepthBuffer, HidesOnlyWhatIsBehindEveryPixel) {
    std::mt19937 random(10);
    std::uniform_real_distribution<float> x(0.0f, 301.0f), y(0.0f, 203.0f), z(0.1f, 1.0f);
    std::uniform_int_distribution<int> column(-9, 310), row(-9, 210), extent(0, 40);
    DepthBuffer buffer;
    buffer.clear(kWidth, kHeight);
    int hidden = 0;
    for (int i = 0; i < 4000; ++i) {
        const float depth = z(random);
        if (i % 4 == 0)
            buffer.draw({PictureCorner{x(random), y(random), depth},
                         PictureCorner{x(random), y(random), depth},
                         PictureCorner{x(random), y(random), depth}});
        const int left = column(random), top = row(random);
        const cw2::PixelRect rect{left, top, left + extent(random), top + extent(random)};
        const float asked = 0.05f + 0.0001f * static_cast<float>(i);
        if (buffer.hides(rect, asked)) {
            ++hidden;
            EXPECT_TRUE(buffer.hides_exactly(rect, asked));
        }
    }
    EXPECT_GT(hidden, 500);
    // One pixel that is open is seen.
    DepthBuffer open;
    open.clear(64, 64);
    open.draw({PictureCorner{-1.0f, -1.0f, 0.5f}, PictureCorner{200.0f, -1.0f, 0.5f},
               PictureCorner{-1.0f, 200.0f, 0.5f}});
    EXPECT_TRUE(open.hides({0, 0, 63, 63}, 0.4f));
    open.clear(64, 64);
    EXPECT_FALSE(open.hides({0, 0, 63, 63}, 0.0f));
}

}  // namespace
