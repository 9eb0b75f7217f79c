#include "mesh-format/index_stream.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "mesh-format/zigzag.h"

namespace mesh_format {

namespace {

using Index = std::uint16_t;

/// Where a vertex lies on the border of the triangles so far.
struct Place {
    std::uint32_t edge;  // of the border's edge to the vertex: from() | beyond() << 16
    Index to;            ///< the border's edge from the vertex goes there
    Index covers;        ///< 1: the vertex lies on the border in another place, too

    unsigned from() const { return edge & 0xFFFF; }
    unsigned beyond() const { return edge >> 16; }  ///< the third vertex of that edge's triangle

    /// In one register: processors wait where words are written and read as something longer.
    void set(unsigned new_edge, unsigned new_to) {
        const std::uint64_t word = new_edge | std::uint64_t{new_to} << 32;
        static_assert(sizeof *this == sizeof word);
        std::memcpy(this, &word, sizeof word);
    }
};

enum class Corner { pivot, second, third };

/// What is known of the triangles so far. The last one goes from the pivot to the second and to the
/// third vertex. `Numbers` has a function
///     bool get(Corner, unsigned& vertex)
/// that is asked for the vertices that a code does not say.
class Triangles {
 public:
    Triangles(std::span<Neighbours> neighbours, Scratch& scratch)
        : neighbours_(neighbours),
          places_(scratch.take<Place>(2 * neighbours.size())),
          covered_(places_ + neighbours.size()) {
        places_[0].set(0, 0);  // where a stream may start
    }

    unsigned pivot() const { return pivot_; }
    unsigned third() const { return third_; }

    /// The last triangle's corners.
    void put(Index* corners) const {
        corners[0] = static_cast<Index>(pivot_);
        corners[1] = static_cast<Index>(second_);
        corners[2] = static_cast<Index>(third_);
    }

    /// The vertex after the largest so far.
    unsigned next() const { return next_; }
    const Place& place(unsigned vertex) const { return places_[vertex]; }
    unsigned seen(unsigned back) const { return seen_[(seen_count_ - back) % seen_.size()]; }

    /// False if there is no such triangle.
    template <typename Numbers>
    bool add(unsigned code, Numbers& numbers) {
        const unsigned start = code / kTriangleStart;
        unsigned p = pivot_;
        unsigned y = third_;
        unsigned beyond = second_;
        if (start != kGoesOn) {
            p = seen(start);
            if (start >= kPivotNumber) [[unlikely]] {
                if (!start_anew(start, p, y, numbers)) return false;
                beyond = y;
            }
            if (start <= kPivotNumber) {
                y = places_[p].from();
                beyond = places_[p].beyond();
            }
            see(y);
        }
        unsigned z = 0;
        if (!end(code, p, y, beyond, z, numbers)) return false;
        if (start > kPivotNumber) [[unlikely]] {
            places_[p].to = static_cast<Index>(y);
            places_[y].edge = p | z << 16;
        }
        see(z);
        pivot_ = p;
        second_ = y;
        third_ = z;
        return true;
    }

    /// Reaches the vertices of no triangle.
    void finish() {
        while (next_ < neighbours_.size()) reach_alone();
    }

 private:
    /// Sets the third vertex, and lets the border go round the triangle.
    template <typename Numbers>
    bool end(unsigned code, unsigned p, unsigned y, unsigned beyond, unsigned& z,
             Numbers& numbers) {
        // Tests of bits: a table of jumps is slower.
        if (code & kThirdNumber) {
            if ((code & (kClosesPivot | kClosesSecond)) || !numbers.get(Corner::third, z))
                return false;
            if (z >= next_) {
                reach(z, p, y, beyond);
                places_[z].set(y | p << 16, p);
            } else {
                covered_[z].set(y | p << 16, places_[z].to);
                places_[z].covers = 1;
                places_[z].to = static_cast<Index>(p);
            }
            places_[y].to = static_cast<Index>(z);
            places_[p].edge = z | y << 16;
        } else if (code & kClosesSecond) {
            if (code & kClosesPivot) {
                z = places_[p].to;
                uncover(p);
                uncover(y);
                uncover(z);
            } else {
                z = places_[y].from();
                uncover(y);
                places_[z].to = static_cast<Index>(p);
                places_[p].edge = z | y << 16;
            }
        } else if (code & kClosesPivot) {
            z = places_[p].to;
            uncover(p);
            places_[z].edge = y | p << 16;
            places_[y].to = static_cast<Index>(z);
        } else {
            z = next_;
            if (z == neighbours_.size()) return false;
            reach_next(p, y, beyond);
            places_[z].set(y | p << 16, p);
            places_[y].to = static_cast<Index>(z);
            places_[p].edge = z | y << 16;
        }
        return true;
    }

    /// A triangle that starts at no vertex seen of late.
    template <typename Numbers>
    bool start_anew(unsigned start, unsigned& p, unsigned& y, Numbers& numbers) {
        if (start == kNextTwo) {
            p = next_;
            y = next_ + 1;
            if (y >= neighbours_.size()) return false;
        } else if (!numbers.get(Corner::pivot, p)) {
            return false;
        }
        while (next_ <= p) reach_alone();
        if (start == kPivotNumber) return true;
        if (start == kTwoNumbers && !numbers.get(Corner::second, y)) return false;
        if (y >= next_) reach(y, p, p, p);
        return true;
    }

    void see(unsigned vertex) { seen_[seen_count_++ % seen_.size()] = static_cast<Index>(vertex); }
    void uncover(unsigned vertex) {
        if (places_[vertex].covers) [[unlikely]]
            places_[vertex] = covered_[vertex];
    }

    void reach_next(unsigned a, unsigned b, unsigned c) {
        neighbours_[next_] = {static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c),
                              0};
        ++next_;
    }
    void reach_alone() {
        places_[next_].set(0, 0);
        const unsigned before = next_ > 0 ? next_ - 1 : 0;
        reach_next(before, before, before);
    }
    void reach(unsigned vertex, unsigned a, unsigned b, unsigned c) {
        while (next_ < vertex) reach_alone();
        places_[next_].set(0, 0);
        reach_next(a, b, c);
    }

    std::span<Neighbours> neighbours_;
    Place* places_;                 // by vertex
    Place* covered_;                // its second place, if it has one
    std::array<Index, 32> seen_{};  // the last vertices that came
    unsigned seen_count_ = 0;
    unsigned next_ = 0;
    unsigned pivot_ = 0;
    unsigned second_ = 0;
    unsigned third_ = 0;
};

class Encoder {
 public:
    explicit Encoder(std::span<Neighbours> neighbours) : triangles_(neighbours, scratch_) {}

    void add(unsigned a, unsigned b, unsigned c) {
        Choice best{.bits = 1000};
        for (int corner = 0; corner < 3; ++corner) {
            consider(best, a, b, c);
            a = std::exchange(b, std::exchange(c, a));
        }
        choice_ = best;
        codes_.push_back(std::byte(best.code));
        triangles_.add(best.code, *this);
    }

    std::vector<std::byte> finish() {
        triangles_.finish();
        std::vector<std::byte> stream = std::move(codes_);
        for (const Index number : numbers_) stream.push_back(std::byte(number & 0xFF));
        for (const Index number : numbers_) stream.push_back(std::byte(number >> 8));
        return stream;
    }

    const Triangles& triangles() const { return triangles_; }

    bool get(Corner corner, unsigned& vertex) {
        vertex = choice_.vertices[static_cast<std::size_t>(corner)];
        numbers_.push_back(zigzag(static_cast<Index>(vertex - last_)));
        last_ = vertex;
        return true;
    }

 private:
    struct Choice {
        int bits;  // about as many as it takes
        unsigned code;
        std::array<unsigned, 3> vertices;
    };

    unsigned third_of(unsigned p, unsigned y, unsigned z) const {
        const unsigned next = triangles_.next();
        if (z == std::max({next, p + (p >= next), y + (y >= next)})) return 0;
        if (p >= next || y >= next || z > next) return kThirdNumber;
        unsigned third = 0;
        if (triangles_.place(p).to == z) third |= kClosesPivot;
        if (triangles_.place(y).from() == z) third |= kClosesSecond;
        return third != 0 ? third : unsigned{kThirdNumber};
    }

    void consider(Choice& best, unsigned p, unsigned y, unsigned z) const {
        constexpr int kNumberBits = 12;
        const unsigned third = third_of(p, y, z);
        const int third_bits = third == kThirdNumber ? kNumberBits : 0;
        const auto take = [&](unsigned start, int bits) {
            if (bits + third_bits < best.bits)
                best = {bits + third_bits, start * kTriangleStart + third, {p, y, z}};
        };
        take(kTwoNumbers, 2 * kNumberBits);
        if (p == triangles_.next() && y == p + 1) take(kNextTwo, 7);
        if (p >= triangles_.next()) return;
        if (!codes_.empty() && p == triangles_.pivot() && y == triangles_.third()) take(kGoesOn, 1);
        if (triangles_.place(p).from() != y) return;
        take(kPivotNumber, 7 + kNumberBits);
        for (unsigned back = 1; back < kPivotNumber; ++back) {
            if (triangles_.seen(back) != p) continue;
            take(back, 2 + static_cast<int>(std::bit_width(back)));
            break;
        }
    }

    Scratch scratch_;
    Triangles triangles_;
    Choice choice_{};
    std::vector<std::byte> codes_;
    std::vector<Index> numbers_;
    unsigned last_ = 0;
};

/// The numbers of a stream.
class Numbers {
 public:
    Numbers(std::span<const std::byte> planes, std::size_t vertex_count)
        : low_(planes.first(planes.size() / 2)),
          high_(planes.subspan(low_.size())),
          vertex_count_(vertex_count) {}

    bool get(Corner, unsigned& vertex) {
        if (used_ == low_.size()) return false;
        const auto number = static_cast<Index>(std::to_integer<unsigned>(low_[used_]) |
                                               std::to_integer<unsigned>(high_[used_]) << 8);
        ++used_;
        vertex = last_ = static_cast<Index>(last_ + unzigzag(number));
        return vertex < vertex_count_;
    }
    bool all_used() const { return used_ == low_.size(); }

 private:
    std::span<const std::byte> low_;
    std::span<const std::byte> high_;
    std::size_t used_ = 0;
    std::size_t vertex_count_;
    unsigned last_ = 0;
};

}  // namespace

std::vector<std::byte> encode_indices(std::span<std::uint16_t> indices,
                                      std::span<Neighbours> neighbours) {
    Encoder encoder(neighbours);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        encoder.add(indices[i], indices[i + 1], indices[i + 2]);
        encoder.triangles().put(&indices[i]);
    }
    return encoder.finish();
}

bool decode_indices(std::span<const std::byte> stream, std::span<std::uint16_t> indices,
                    std::span<Neighbours> neighbours, Scratch& scratch) {
    const std::size_t count = indices.size() / 3;
    if (stream.size() < count || (stream.size() - count) % 2 != 0) return false;
    Triangles triangles(neighbours, scratch);
    Numbers numbers(stream.subspan(count), neighbours.size());
    Index* out = indices.data();
    for (const std::byte code : stream.first(count)) {
        if (!triangles.add(std::to_integer<unsigned>(code), numbers)) return false;
        triangles.put(out);
        out += 3;
    }
    triangles.finish();
    return numbers.all_used();
}

}  // namespace mesh_format
