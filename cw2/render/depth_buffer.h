// A depth buffer on the host, for finding out what a picture hides before it is drawn.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace cw2 {

/// A corner of a triangle in a picture.
struct PictureCorner {
    float x, y;   ///< pixels from the upper left, each within kReach of the picture's
    float depth;  ///< the near plane's distance / the corner's: 1 there, 0 at infinity
};

/// Pixels, both ends included.
struct PixelRect {
    int left, top, right, bottom;
};

/// Twice the area of a triangle in square pixels; negative where its corners go around
/// counterclockwise as they are seen.
inline float signed_area(const std::array<PictureCorner, 3>& t) {
    return (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[1].y - t[0].y) * (t[2].x - t[0].x);
}

class DepthBuffer {
 public:
    /// Beyond the picture's borders, pixels.
    static constexpr float kReach = 16384.0f;

    /// Forgets all and takes a size, pixels, at most 2^14 either way.
    void clear(int width, int height);

    /// Draws a triangle, whatever side it shows. Its corners are rounded to 1/256 pixel and a pixel
    /// is covered if its centre is, by the top-left rule, as devices have it.
    void draw(const std::array<PictureCorner, 3>& triangle);

    /// Whether all pixels of `rect`, which is clipped to the picture, hold something nearer than
    /// `depth`; may say no where the answer is yes.
    bool hides(const PixelRect& rect, float depth);
    /// The same of every pixel, one after the other.
    bool hides_exactly(const PixelRect& rect, float depth) const;

    int width() const { return width_; }
    int height() const { return height_; }

 private:
    static constexpr int kTile = 4;  ///< pixels a side
    static constexpr std::uint8_t kStale = 1;

    struct Edges;
    void draw_small(const Edges& edges, const PixelRect& rect, float depth, float dx, float dy);
    PixelRect clipped(const PixelRect& rect) const;
    void mark(int y, int left, int right);
    float farthest(std::size_t tile);

    int width_ = 0;
    int height_ = 0;
    std::size_t stride_ = 0;           ///< a row's floats, a multiple of kTile
    std::vector<float> depths_;        ///< infinite beside the picture
    std::vector<float> farthest_;      ///< of each tile
    std::vector<std::uint8_t> stale_;  ///< the tiles whose farthest_ may be too far
};

}  // namespace cw2
