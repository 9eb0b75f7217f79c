#include "cw2/render/depth_buffer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/every_cpu.h"

namespace cw2 {

namespace {

constexpr int kLanes = 8;
using Floats [[gnu::vector_size(4 * kLanes)]] = float;
using Ints [[gnu::vector_size(4 * kLanes)]] = std::int32_t;
constexpr Ints kCount{0, 1, 2, 3, 4, 5, 6, 7};

constexpr std::int64_t kFixed = 256;  ///< parts of a pixel
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// From the centre of the picture's first pixel, in parts of a pixel.
std::int64_t rounded(float pixels) {
    constexpr double kAbove = 2.0 * DepthBuffer::kReach;
    return static_cast<std::int64_t>((static_cast<double>(pixels) + kAbove) * kFixed -
                                     0.5 * kFixed + 0.5) -
           static_cast<std::int64_t>(kAbove) * kFixed;
}

std::int64_t floor_division(std::int64_t value) {
    return value >> 8;
}
std::int64_t ceil_division(std::int64_t value) {
    return (value + kFixed - 1) >> 8;
}
static_assert(kFixed == 1 << 8);

struct Point {
    std::int64_t x, y;
};

}  // namespace

/// Pixel (x, y) is inside where dx x + dy y + at >= 0, for all three.
struct DepthBuffer::Edges {
    std::array<std::int64_t, 3> dx, dy, at;

    explicit Edges(const std::array<Point, 3>& p) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Point &a = p[i], &b = p[(i + 1) % 3];
            const std::int64_t along_x = a.y - b.y, along_y = b.x - a.x;
            // What lies on a left edge, or on a horizontal one at the top, is inside.
            const bool has_border = along_x > 0 || (along_x == 0 && along_y > 0);
            dx[i] = along_x * kFixed;
            dy[i] = along_y * kFixed;
            at[i] = -(along_x * a.x + along_y * a.y) - (has_border ? 0 : 1);
        }
    }
};

void DepthBuffer::clear(int width, int height) {
    if (width != width_ || height != height_) {
        width_ = width;
        height_ = height;
        // Lanes may reach beyond a row.
        stride_ = (static_cast<std::size_t>(width) + kLanes + kTile - 1) / kTile * kTile;
        const std::size_t rows = (static_cast<std::size_t>(height) + kTile - 1) / kTile * kTile;
        depths_.resize(stride_ * rows);
        farthest_.resize(stride_ / kTile * (rows / kTile));
        stale_.resize(farthest_.size());
    }
    std::ranges::fill(farthest_, 0.0f);
    std::ranges::fill(stale_, std::uint8_t{0});
    std::ranges::fill(depths_, 0.0f);
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
        const auto row = depths_.begin() + static_cast<std::ptrdiff_t>(y * stride_);
        std::fill(row + width, row + static_cast<std::ptrdiff_t>(stride_), kInfinity);
    }
    std::fill(depths_.begin() + static_cast<std::ptrdiff_t>(stride_) * height, depths_.end(),
              kInfinity);
}

void DepthBuffer::mark(int y, int left, int right) {
    const std::size_t row = static_cast<std::size_t>(y / kTile) * (stride_ / kTile);
    std::memset(stale_.data() + row + left / kTile, kStale,
                static_cast<std::size_t>(right / kTile - left / kTile + 1));
}

/// Of triangles of fewer pixels than this either way 32 bits hold all: 2 (96 256) (104 256) < 2^31.
constexpr std::int64_t kSmall = 96;

CW2_EVERY_CPU
void DepthBuffer::draw_small(const Edges& edges, const PixelRect& rect, float depth, float dx,
                             float dy) {
    std::array<Ints, 3> row, step;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto first = static_cast<std::int32_t>(edges.dx[i] * rect.left +
                                                     edges.dy[i] * rect.top + edges.at[i]);
        const auto along = static_cast<std::int32_t>(edges.dx[i]);
        row[i] = first + along * kCount;
        step[i] = Ints{} + along * kLanes;
    }
    const Floats across = dx * __builtin_convertvector(kCount, Floats);
    for (int y = rect.top; y <= rect.bottom; ++y) {
        float* out = depths_.data() + static_cast<std::size_t>(y) * stride_ + rect.left;
        Floats z = depth + dy * static_cast<float>(y - rect.top) + across;
        std::array<Ints, 3> at = row;
        for (int x = rect.left; x <= rect.right; x += kLanes) {
            const Ints inside = ~((at[0] | at[1] | at[2]) >> 31);
            Floats held;
            std::memcpy(&held, out, sizeof held);
            const Ints nearer = inside & (z > held);
            held = reinterpret_cast<Floats>((nearer & reinterpret_cast<Ints>(z)) |
                                            (~nearer & reinterpret_cast<Ints>(held)));
            std::memcpy(out, &held, sizeof held);
            for (std::size_t i = 0; i < 3; ++i) at[i] += step[i];
            z += dx * kLanes;
            out += kLanes;
        }
        for (std::size_t i = 0; i < 3; ++i) row[i] += static_cast<std::int32_t>(edges.dy[i]);
    }
    for (int y = rect.top / kTile; y <= rect.bottom / kTile; ++y)
        mark(y * kTile, rect.left, rect.right);
}

void DepthBuffer::draw(const std::array<PictureCorner, 3>& triangle) {
    std::array<PictureCorner, 3> t = triangle;
    std::array<Point, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = {rounded(t[i].x), rounded(t[i].y)};
    std::int64_t area =
        (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    if (area == 0) return;
    if (area < 0) {
        std::swap(t[1], t[2]);
        std::swap(p[1], p[2]);
        area = -area;
    }
    const auto [least_x, most_x] = std::minmax({p[0].x, p[1].x, p[2].x});
    const auto [least_y, most_y] = std::minmax({p[0].y, p[1].y, p[2].y});
    const PixelRect rect = clipped(
        {static_cast<int>(ceil_division(least_x)), static_cast<int>(ceil_division(least_y)),
         static_cast<int>(floor_division(most_x)), static_cast<int>(floor_division(most_y))});
    if (rect.left > rect.right || rect.top > rect.bottom) return;

    const double dz1 = static_cast<double>(t[1].depth) - static_cast<double>(t[0].depth);
    const double dz2 = static_cast<double>(t[2].depth) - static_cast<double>(t[0].depth);
    const auto x1 = static_cast<double>(p[1].x - p[0].x), y1 = static_cast<double>(p[1].y - p[0].y);
    const auto x2 = static_cast<double>(p[2].x - p[0].x), y2 = static_cast<double>(p[2].y - p[0].y);
    const double scale = kFixed / static_cast<double>(area);
    const double dx = (dz1 * y2 - dz2 * y1) * scale, dy = (dz2 * x1 - dz1 * x2) * scale;
    const auto depth_at = [&](std::int64_t x, std::int64_t y) {
        // Devices compute it in floats, whose errors are of the size of the largest depth's.
        constexpr double kErrors = 0x1p-22;
        const double away =
            kErrors * static_cast<double>(std::max({t[0].depth, t[1].depth, t[2].depth}));
        return static_cast<float>(
            static_cast<double>(t[0].depth) - away +
            dx * (static_cast<double>(x) - static_cast<double>(p[0].x) / kFixed) +
            dy * (static_cast<double>(y) - static_cast<double>(p[0].y) / kFixed));
    };

    const Edges edges(p);
    if (most_x - least_x < kSmall * kFixed && most_y - least_y < kSmall * kFixed) {
        draw_small(edges, rect, depth_at(rect.left, rect.top), static_cast<float>(dx),
                   static_cast<float>(dy));
        return;
    }
    for (int y = rect.top; y <= rect.bottom; ++y) {
        int left = rect.left, right = rect.right;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int64_t at = edges.dy[i] * y + edges.at[i];
            // Doubles hold all of these, and their quotients tell whole numbers from others.
            const double border = -static_cast<double>(at) / static_cast<double>(edges.dx[i]);
            if (edges.dx[i] > 0) {
                if (border > left)
                    left = border > right ? right + 1 : static_cast<int>(std::ceil(border));
            } else if (edges.dx[i] < 0) {
                if (border < right)
                    right = border < left ? left - 1 : static_cast<int>(std::floor(border));
            } else if (at < 0) {
                right = left - 1;
            }
        }
        if (left > right) continue;
        float* const out = depths_.data() + static_cast<std::size_t>(y) * stride_ + left;
        const float first = depth_at(left, y), step = static_cast<float>(dx);
        const int count = right - left + 1;
        for (int x = 0; x < count; ++x) {
            const float z = first + step * static_cast<float>(x);
            out[x] = out[x] < z ? z : out[x];
        }
        mark(y, left, right);
    }
}

PixelRect DepthBuffer::clipped(const PixelRect& rect) const {
    return {std::max(rect.left, 0), std::max(rect.top, 0), std::min(rect.right, width_ - 1),
            std::min(rect.bottom, height_ - 1)};
}

float DepthBuffer::farthest(std::size_t tile) {
    if (stale_[tile] == 0) return farthest_[tile];
    const std::size_t columns = stride_ / kTile;
    const float* row = depths_.data() + tile / columns * kTile * stride_ + tile % columns * kTile;
    std::array<float, kTile> least{row[0], row[1], row[2], row[3]};
    for (int y = 1; y < kTile; ++y) {
        row += stride_;
        for (std::size_t x = 0; x < kTile; ++x) least[x] = row[x] < least[x] ? row[x] : least[x];
    }
    stale_[tile] = 0;
    return farthest_[tile] = std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
}

bool DepthBuffer::hides(const PixelRect& rect, float depth) {
    const PixelRect r = clipped(rect);
    const std::size_t columns = stride_ / kTile;
    for (int y = r.top / kTile; y <= r.bottom / kTile; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * columns;
        for (int x = r.left / kTile; x <= r.right / kTile; ++x)
            if (!(farthest(row + static_cast<std::size_t>(x)) > depth)) return false;
    }
    return true;
}

bool DepthBuffer::hides_exactly(const PixelRect& rect, float depth) const {
    const PixelRect r = clipped(rect);
    for (int y = r.top; y <= r.bottom; ++y) {
        const float* const row = depths_.data() + static_cast<std::size_t>(y) * stride_;
        for (int x = r.left; x <= r.right; ++x)
            if (!(row[x] > depth)) return false;
    }
    return true;
}

}  // namespace cw2
