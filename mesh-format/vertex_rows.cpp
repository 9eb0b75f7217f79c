#include "mesh-format/vertex_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "mesh-format/rows.h"
#include "mesh-format/surface.h"
#include "mesh-format/vertex_prediction.h"

namespace mesh_format {

namespace {

using SignedRow = std::int16_t __attribute__((vector_size(16)));
using Plane = std::uint8_t __attribute__((vector_size(16)));

constexpr std::size_t kPartner = 5;
constexpr std::size_t kBlock = 16;  // vertices

/// 0, 1, 2, 3 to 0, -1, 1, -2.
Row unzigzag(Row row) {
    return row >> 1 ^ -(row & 1);
}

template <FrameForm kForm, bool kHasPartner, bool kHasSurface>
class Rows {
 public:
    Rows(std::size_t count, std::span<const Neighbours> neighbours, Scratch& scratch)
        : count_(count),
          neighbours_(neighbours),
          rows_(scratch.take<Row>(count)),
          tops_(scratch.take<std::uint8_t>(count)),
          partners_(kHasPartner ? scratch.take<std::uint16_t>(count) : nullptr),
          surfaces_(kHasSurface ? scratch.take<Surface>(count + kBlock) : nullptr) {}

    void decode(const std::byte* planes, std::span<const std::uint16_t> indices,
                const SurfaceModel& model, std::byte* out) {
        const std::byte* const tops = planes + kTopPlane * count_;
        // Step by step for a block: so processors work on many vertices at once.
        for (std::size_t first = 0; first < count_; first += kBlock) {
            const std::size_t size = std::min(kBlock, count_ - first);
            std::array<Row, kBlock> differences;
            read(planes, first, size, differences);
            for (std::size_t k = 0; k < size; ++k) {
                if constexpr (kHasSurface)
                    add_place(first + k, differences[k]);
                else
                    add(first + k, differences[k], to_top(tops[first + k]));
            }
            if constexpr (!kHasSurface) finish(first, size, out);
        }
        if constexpr (!kHasSurface) return;
        sum_surfaces(indices, rows_, model, {surfaces_, count_ + kBlock});
        for (std::size_t first = 0; first < count_; first += kBlock) {
            const std::size_t size = std::min(kBlock, count_ - first);
            std::array<Rotations, kBlock / Rotations::kCount> rotations;
            for (std::size_t k = 0; k < rotations.size(); ++k)
                rotations_of(surfaces_ + first + k * Rotations::kCount, rotations[k]);
            for (std::size_t k = 0; k < size; ++k) {
                add_frame(first + k, rotations[k / Rotations::kCount], k % Rotations::kCount,
                          to_top(tops[first + k]));
            }
            finish(first, size, out);
        }
    }

 private:
    using Code = FrameCode<kForm>;
    static constexpr std::size_t kDigits = kHasPartner ? 2 : 3;  // of a row that are predicted
    static constexpr std::size_t kStride =
        vertex_layout({PositionForm::quantised, kForm, UvForm::quantised, ColorForm::none}).stride;
    static constexpr std::size_t kTopPlane = 10;
    // Of each number, its low and its high byte.
    static constexpr std::array<std::array<std::size_t, 2>, kRowNumbers> kPlanes{
        {{0, 3}, {1, 4}, {2, 5}, {11, 14}, {12, 15}, {13, 16}, {6, 8}, {7, 9}}};

    /// The differences of `size` vertices.
    void read(const std::byte* planes, std::size_t first, std::size_t size,
              std::array<Row, kBlock>& out) const {
        std::array<Row, kRowNumbers> low;
        std::array<Row, kRowNumbers> high;
        for (std::size_t k = 0; k < kRowNumbers; ++k) {
            Plane bytes[2] = {};
            for (std::size_t byte = 0; byte < 2; ++byte) {
                const std::byte* const in = planes + kPlanes[k][byte] * count_ + first;
                if (size == kBlock)
                    std::memcpy(&bytes[byte], in, kBlock);
                else
                    std::memcpy(&bytes[byte], in, size);
            }
            const Plane first_half = __builtin_shufflevector(bytes[0], bytes[1], 0, 16, 1, 17, 2,
                                                             18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
            const Plane second_half = __builtin_shufflevector(
                bytes[0], bytes[1], 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
            low[k] = unzigzag(reinterpret_cast<Row>(first_half));
            high[k] = unzigzag(reinterpret_cast<Row>(second_half));
        }
        transpose(low);
        transpose(high);
        std::ranges::copy(low, out.begin());
        std::ranges::copy(high, out.begin() + kRowNumbers);
    }

    static std::uint8_t to_top(std::byte byte) { return std::to_integer<std::uint8_t>(byte); }

    Row sum(std::size_t i, const Row& difference) const {
        if (i == 0) [[unlikely]]
            return difference;
        // In this order: mostly b is the vertex before, for which the others need not wait.
        const Neighbours& at = neighbours_[i];
        return difference + rows_[at.a] - rows_[at.c] + rows_[at.b];
    }

    /// Whether a, b, and c have other largest components than vertex i.
    bool set_top(std::size_t i, std::uint8_t change) {
        if (i == 0) [[unlikely]] {
            tops_[0] = change;
            return true;
        }
        const Neighbours& at = neighbours_[i];
        const std::uint8_t before = tops_[at.a];
        tops_[i] = before ^ change;
        return ((change | (tops_[at.b] ^ before) | (tops_[at.c] ^ before)) & 3u) != 0;
    }

    void add(std::size_t i, Row difference, std::uint8_t change) {
        if constexpr (kHasPartner) {
            partners_[i] = difference[kPartner];
            difference[kPartner] = 0;
        }
        Row row = sum(i, difference);
        const bool differs = set_top(i, change);
        const std::uint32_t largest = tops_[i] & 3u;
        if (differs || !reduce(row)) [[unlikely]] {
            Digits expected;
            expect(i, largest, differs, expected);
            set_digits(row, expected, largest, difference);
        }
        rows_[i] = row;
    }

    /// Position and UV; leaves the digits' differences in the row.
    void add_place(std::size_t i, Row difference) {
        constexpr Row kDigitsOnly{0, 0, 0, 0xFFFF, 0xFFFF, 0xFFFF, 0, 0};
        if constexpr (kHasPartner) partners_[i] = difference[kPartner];
        rows_[i] = (sum(i, difference) & ~kDigitsOnly) | (difference & kDigitsOnly);
    }

    /// The frame, once what the surface tells of it is known: rotation k of some.
    void add_frame(std::size_t i, const Rotations& rotations, std::size_t k, std::uint8_t change) {
        tops_[i] = static_cast<std::uint8_t>(rotations.tops[k] ^ change);
        const std::uint32_t largest = tops_[i] & 3u;
        Digits expected;
        Code::of_rotation(rotations, k, largest, expected);
        Row row = rows_[i];
        set_digits(row, expected, largest, row);
        rows_[i] = row;
    }

    /// What does not wait for other vertices.
    void finish(std::size_t first, std::size_t size, std::byte* out) {
        const std::size_t end = first + size;
        if constexpr (kHasPartner) {
            for (std::size_t i = first; i < end; ++i) partners_[i] = partner_digit(i);
            finished_ = end;
        }
        for (std::size_t i = first; i < end; ++i) {
            Row row = rows_[i];
            if constexpr (kHasPartner) row[kPartner] = partners_[i];
            put(row, tops_[i], out + i * kStride);
        }
    }

    /// The digit that the other two give; before finish() partners_ has its difference.
    std::uint16_t partner_digit(std::size_t i) const {
        if (i < finished_) return partners_[i];
        const Row& row = rows_[i];
        return digit(Code::of_x_tangent(row[kFirstDigit], row[kFirstDigit + 1]), partners_[i]);
    }

    /// Each digit of a sum modulo the number of levels; false where that is too far.
    static bool reduce(Row& row) {
        if constexpr (Code::kWide) {
            row &= Row{0xFFFF, 0xFFFF, 0xFFFF, 0x7FFF, 0x7FFF, 0x7FFF, 0xFFFF, 0xFFFF};
            return true;
        } else {
            constexpr std::int16_t kLevels = Code::kLevels;
            const SignedRow levels{0, 0, 0, kLevels, kLevels, kLevels, 0, 0};
            SignedRow sum = reinterpret_cast<SignedRow>(row);
            // Of three digits and a difference.
            for (int round = 0; round < 2; ++round) {
                sum += levels & (sum < 0);
                sum -= levels & (sum >= levels);
            }
            row = reinterpret_cast<Row>(sum);
            const SignedRow outside = ((sum < 0) | (sum >= levels)) & levels;
            std::array<std::uint64_t, 2> words;
            std::memcpy(&words, &outside, sizeof words);
            return (words[0] | words[1]) == 0;
        }
    }

    /// As FrameModel::neighbours says.
    void expect(std::size_t i, std::uint32_t largest, bool differs, Digits& expected) const {
        if (i == 0) return expected.fill(Code::kZero);
        const Neighbours& at = neighbours_[i];
        const FrameDigits a = frame(at.a);
        if (differs) return Code::rebased(a, largest, expected);
        const FrameDigits b = frame(at.b);
        const FrameDigits c = frame(at.c);
        for (std::size_t k = 0; k < 3; ++k)
            expected[k] = static_cast<std::int16_t>(a.others[k] + b.others[k] - c.others[k]);
    }

    static void set_digits(Row& row, const Digits& expected, std::uint32_t largest,
                           Row difference) {
        for (std::size_t k = 0; k < kDigits; ++k) {
            const std::size_t lane = kFirstDigit + k;
            row[lane] = digit(expected[place(largest, k)], difference[lane]);
        }
    }

    static std::uint16_t digit(int expected, std::uint16_t difference) {
        return static_cast<std::uint16_t>(
            Code::reduced(expected + static_cast<std::int16_t>(difference)));
    }

    FrameDigits frame(std::size_t i) const {
        FrameDigits result{};
        result.top = tops_[i];
        const std::uint32_t largest = result.top & 3u;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint16_t value = k < kDigits ? rows_[i][kFirstDigit + k] : partner_digit(i);
            result.others[place(largest, k)] = static_cast<std::int16_t>(value);
        }
        return result;
    }

    /// Whether the digits are those of the second, third and first component but the largest.
    static bool are_turned(std::uint32_t largest) { return kHasPartner && partner(largest) == 0; }

    /// Where among the others the digit is that is coded as number k.
    static std::size_t place(std::uint32_t largest, std::size_t k) {
        return (k + are_turned(largest)) % 3;
    }

    static void put(const Row& row, std::uint8_t top, std::byte* out) {
        if constexpr (Code::kWide && !kHasPartner) {
            const Row vertex = row | kTopBits[top & 7u];
            std::memcpy(out, &vertex, sizeof vertex);
            return;
        }
        std::array<std::uint64_t, 2> words;
        std::memcpy(&words, &row, sizeof words);
        const std::uint64_t digits[] = {words[0] >> 48, words[1] & 0xFFFF, words[1] >> 16 & 0xFFFF};
        // No branch on what no one can predict.
        const bool turned = are_turned(top & 3u);
        const std::uint64_t first = turned ? digits[2] : digits[0];
        const std::uint64_t second = turned ? digits[0] : digits[1];
        const std::uint64_t third = turned ? digits[1] : digits[2];
        const std::uint64_t position = words[0] & 0xFFFF'FFFF'FFFF;
        const std::uint64_t uv = words[1] >> 32;
        if constexpr (Code::kWide) {
            const std::uint64_t bits[] = {top >> 2u & 1u, top & 1u, top >> 1u & 1u};
            words[0] = position | (first | bits[0] << 15) << 48;
            words[1] = second | bits[1] << 15 | (third | bits[2] << 15) << 16 | uv << 32;
            std::memcpy(out, &words, sizeof words);
        } else {
            constexpr std::uint64_t kLevels = Code::kLevels;
            const auto code = static_cast<std::uint32_t>(
                ((top * kLevels + third) * kLevels + second) * kLevels + first);
            std::memcpy(out, &position, 8);  // two bytes more than it has
            std::memcpy(out + 6, &code, 4);
            std::memcpy(out + 10, &uv, 4);
        }
    }

    /// The bits above the digits of quat48, see tangent_frame.h.
    static constexpr Row top_bits(unsigned top) {
        const auto bit = [&](unsigned k) {
            return static_cast<std::uint16_t>((top >> k & 1u) << 15);
        };
        return Row{0, 0, 0, bit(2), bit(0), bit(1), 0, 0};
    }
    static constexpr std::array<Row, 8> kTopBits{top_bits(0), top_bits(1), top_bits(2),
                                                 top_bits(3), top_bits(4), top_bits(5),
                                                 top_bits(6), top_bits(7)};

    std::size_t count_;
    std::size_t finished_ = 0;  // vertices
    std::span<const Neighbours> neighbours_;
    Row* rows_;
    std::uint8_t* tops_;
    std::uint16_t* partners_;  // the digits that the others of a vertex give
    Surface* surfaces_;        // if frames are predicted from them
};

}  // namespace

void decode_rows(const MeshRecord& mesh, FrameModel model, int area_shift,
                 std::span<const std::uint16_t> indices, std::span<const Neighbours> neighbours,
                 const std::byte* planes, std::byte* vertices, Scratch& scratch) {
    with_model(mesh.forms.frame, model, [&]<FrameForm kForm, bool kHasPartner, bool kHasSurface>() {
        Rows<kForm, kHasPartner, kHasSurface>(mesh.vertex_count, neighbours, scratch)
            .decode(planes, indices, surface_of(model, area_shift), vertices);
    });
}

}  // namespace mesh_format
