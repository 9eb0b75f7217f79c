// Triangles as a compressed file holds them: they come back, whatever they are, and give their
// vertices neighbours.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "mesh-format/index_stream.h"
#include "random_triangles.h"

namespace {

using namespace mesh_format;
using Bytes = std::vector<std::byte>;
using Indices = std::vector<std::uint16_t>;

struct Decoded {
    bool sound;
    Indices indices;
    std::vector<Neighbours> neighbours;
};

Decoded decoded(const Bytes& stream, std::size_t index_count, std::size_t vertex_count) {
    Decoded result{false, Indices(index_count), std::vector<Neighbours>(vertex_count)};
    Scratch scratch;
    result.sound = decode_indices(stream, result.indices, result.neighbours, scratch);
    return result;
}

/// Each triangle starting at its smallest corner.
Indices turned(Indices indices) {
    for (auto triangle = indices.begin(); triangle != indices.end(); triangle += 3)
        std::rotate(triangle, std::min_element(triangle, triangle + 3), triangle + 3);
    return indices;
}

/// The triangles around each vertex of a sheet that are left once those of the vertices before it
/// are done, each from the edge of the one before; vertices in the order of their first use.
Indices fans(std::uint16_t side) {
    Indices indices;
    const auto at = [&](int x, int y) { return static_cast<std::uint16_t>(y * side + x); };
    for (std::uint16_t y = 1; y < side; ++y) {
        for (std::uint16_t x = 0; x < side; ++x) {
            if (x > 0)
                for (const auto v : {at(x, y - 1), at(x - 1, y), at(x - 1, y - 1)})
                    indices.push_back(v);
            if (x > 0)
                for (const auto v : {at(x, y - 1), at(x, y), at(x - 1, y)}) indices.push_back(v);
        }
    }
    Indices numbers(std::size_t{side} * side, 0xFFFF);
    std::uint16_t used = 0;
    for (std::uint16_t& index : indices) {
        if (numbers[index] == 0xFFFF) numbers[index] = used++;
        index = numbers[index];
    }
    return indices;
}

Indices shuffled(Indices indices) {
    std::mt19937 random(17);
    for (std::size_t i = indices.size() / 3; i-- > 1;) {
        const std::size_t other = random() % (i + 1);
        std::swap_ranges(&indices[3 * i], &indices[3 * i] + 3, &indices[3 * other]);
    }
    return indices;
}

/// Also with a hole, where vertices lie on the border twice, and with both sides of each triangle.
std::vector<Indices> all_kinds() {
    Indices holes = fans(20);
    for (std::size_t i = 0; i < holes.size(); i += 33)
        holes.erase(holes.begin() + static_cast<std::ptrdiff_t>(i / 3 * 3),
                    holes.begin() + static_cast<std::ptrdiff_t>(i / 3 * 3) + 3);
    Indices two_sided = fans(20);
    for (std::size_t i = 0; i < 1000; i += 3)
        two_sided.insert(two_sided.end(), {two_sided[i], two_sided[i + 2], two_sided[i + 1]});
    return {fans(20),       shuffled(fans(20)),  holes, two_sided, random_triangles(400, 900),
            Indices(30, 0), Indices{399, 0, 200}};
}

TEST(IndexStream, AnyTrianglesComeBack) {
    for (const Indices& indices : all_kinds()) {
        std::vector<Neighbours> neighbours(400);
        Indices as_decoded = indices;
        const Bytes stream = encode_indices(as_decoded, neighbours);
        EXPECT_LE(stream.size(), index_stream_bound(indices.size()));
        EXPECT_EQ(turned(as_decoded), turned(indices));
        const Decoded result = decoded(stream, indices.size(), 400);
        ASSERT_TRUE(result.sound);
        EXPECT_EQ(result.indices, as_decoded);
        EXPECT_EQ(result.neighbours, neighbours);
        for (std::uint16_t v = 1; v < 400; ++v) {
            const auto& [a, b, c, unused] = neighbours[v];
            EXPECT_LT(std::max({a, b, c}), v);
        }
    }
}

TEST(IndexStream, TheLargestMeshesComeBack) {
    Indices indices = random_triangles(kMaxMeshVertices, 100'000);
    std::vector<Neighbours> neighbours(kMaxMeshVertices);
    const Bytes stream = encode_indices(indices, neighbours);
    const Decoded result = decoded(stream, indices.size(), kMaxMeshVertices);
    ASSERT_TRUE(result.sound);
    EXPECT_EQ(result.indices, indices);
    EXPECT_EQ(result.neighbours, neighbours);
}

Bytes bytes(std::initializer_list<int> values) {
    Bytes result;
    for (const int value : values) result.push_back(std::byte(value));
    return result;
}

/// By docs/format.md, by hand.
TEST(IndexStream, IsThatOfTheFormat) {
    const struct {
        Indices indices;
        Bytes stream;
        std::vector<Neighbours> neighbours;
    } cases[] = {
        // Around vertex 0, once round.
        {{0, 1, 2, 0, 2, 3, 0, 3, 1},
         bytes({0xF0, 0x00, 0x01}),
         {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 1, 1, 0}, {0, 2, 1, 0}}},
        // A strip: at the vertex that came two before, to the next.
        {{0, 1, 2, 2, 1, 3, 2, 3, 4},
         bytes({0xF0, 0x08, 0x00}),
         {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 1, 1, 0}, {2, 1, 0, 0}, {2, 3, 1, 0}}},
        // At 0 two parts meet, so it lies on the border twice: between 3 and 4, and, once that is
        // closed, between 6 and 1.
        {{0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 0, 4, 0, 3, 0, 6, 1},
         bytes({0xF0, 0x00, 0xF0, 0x04, 0x02, 0x11, 0x00, 0x00}),
         {{0, 0, 0, 0},
          {0, 0, 0, 0},
          {0, 1, 1, 0},
          {0, 2, 1, 0},
          {3, 3, 3, 0},
          {4, 4, 4, 0},
          {4, 5, 5, 0}}},
        // No edge in common: from 3, the number 3 (+3), to 0 (-3), to the next.
        {{0, 1, 2, 0, 4, 3},
         bytes({0xF0, 0xF8, 0x06, 0x05, 0x00, 0x00}),
         {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 1, 1, 0}, {2, 2, 2, 0}, {3, 0, 0, 0}}},
    };
    for (const auto& each : cases) {
        std::vector<Neighbours> neighbours(each.neighbours.size());
        Indices indices = each.indices;
        EXPECT_EQ(encode_indices(indices, neighbours), each.stream);
        EXPECT_EQ(neighbours, each.neighbours);
        const Decoded result = decoded(each.stream, each.indices.size(), neighbours.size());
        EXPECT_TRUE(result.sound);
        EXPECT_EQ(result.indices, indices);
        EXPECT_EQ(turned(indices), turned(each.indices));
    }
}

/// One byte a triangle says it all, and nearly each vertex lies across an edge.
TEST(IndexStream, FansNeedNoNumbers) {
    constexpr std::uint16_t kSide = 60;
    Indices indices = fans(kSide);
    std::vector<Neighbours> neighbours(std::size_t{kSide} * kSide);
    const Bytes stream = encode_indices(indices, neighbours);
    EXPECT_LT(stream.size(), indices.size() / 3 + 6 * kSide);
    const auto alone = std::ranges::count_if(
        neighbours, [](const Neighbours& neighbour) { return neighbour.b == neighbour.c; });
    EXPECT_LT(alone, 3 * kSide);
}

TEST(IndexStream, AnyBytesBecomeTrianglesOrAreRefused) {
    std::mt19937 random(7);
    int sound = 0;
    for (int i = 0; i < 4000; ++i) {
        const std::size_t numbers = 2 * (random() % 40);
        Bytes stream(60 + numbers);
        for (std::byte& byte : stream) byte = std::byte(random() & 0xFF);
        // Mostly codes that ask for no number.
        const unsigned mask = i % 3 == 0 ? 0xFF : i % 3 == 1 ? 0x7B : 0x03;
        for (std::size_t k = 0; k < 60; ++k) stream[k] &= std::byte(mask);
        const std::size_t vertex_count = 1 + random() % 70;
        const Decoded result = decoded(stream, 180, vertex_count);
        if (!result.sound) continue;
        ++sound;
        EXPECT_LT(std::ranges::max(result.indices), vertex_count);
        for (std::size_t v = 1; v < vertex_count; ++v) {
            const auto& [a, b, c, unused] = result.neighbours[v];
            EXPECT_LT(std::max({a, b, c}), v);
        }
    }
    EXPECT_GT(sound, 5);
}

TEST(IndexStream, OtherSizesAreRefused) {
    Indices indices = shuffled(fans(9));
    std::vector<Neighbours> neighbours(81);
    const Bytes stream = encode_indices(indices, neighbours);
    for (std::size_t size = 0; size < stream.size(); ++size) {
        const Bytes less(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(decoded(less, indices.size(), 81).sound) << size;
    }
    for (const std::size_t more : {1, 2}) {
        Bytes longer = stream;
        longer.resize(stream.size() + more);
        EXPECT_FALSE(decoded(longer, indices.size(), 81).sound);
    }
    EXPECT_FALSE(decoded(stream, indices.size(), 80).sound);
    // The next two vertices, of which there is one.
    EXPECT_FALSE(decoded(bytes({0xF3}), 3, 1).sound);
}

}  // namespace
