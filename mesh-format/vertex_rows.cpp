#include "mesh-format/vertex_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "mesh-format/vertex_prediction.h"

namespace mesh_format {

namespace {

/// The numbers of a vertex: position, UV, digits. Registers of all processors hold as many.
using Row = std::uint16_t __attribute__((vector_size(16)));
using SignedRow = std::int16_t __attribute__((vector_size(16)));
using Plane = std::uint8_t __attribute__((vector_size(16)));

constexpr std::size_t kNumbers = 8;
constexpr std::size_t kFirstDigit = 5;
constexpr std::size_t kBlock = 16;  // vertices

/// 0, 1, 2, 3 to 0, -1, 1, -2.
Row unzigzag(Row row) {
    return row >> 1 ^ -(row & 1);
}

/// Rows of the numbers of eight vertices, of which each is given the first number of all, the
/// second, ...
void transpose(std::array<Row, kNumbers>& rows) {
    std::array<Row, kNumbers> half;
    // Thrice each row is put between those of the one four further.
    for (int round = 0; round < 3; ++round) {
        for (std::size_t i = 0; i < 4; ++i) {
            half[2 * i] = __builtin_shufflevector(rows[i], rows[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
            half[2 * i + 1] =
                __builtin_shufflevector(rows[i], rows[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
        }
        rows = half;
    }
}

template <FrameForm kForm, bool kHasPartner>
class Rows {
 public:
    Rows(std::size_t count, std::span<const Neighbours> neighbours, Scratch& scratch)
        : count_(count),
          neighbours_(neighbours),
          rows_(scratch.take<Row>(count)),
          tops_(scratch.take<std::uint8_t>(count)),
          partners_(kHasPartner ? scratch.take<std::uint16_t>(count) : nullptr) {}

    void decode(const std::byte* planes, std::byte* out) {
        const std::byte* const tops = planes + kTopPlane * count_;
        for (std::size_t first = 0; first < count_; first += kBlock) {
            const std::size_t size = std::min(kBlock, count_ - first);
            std::array<Row, kBlock> differences;
            read(planes, first, size, differences);
            for (std::size_t i = 0; i < size; ++i) {
                const auto change = std::to_integer<std::uint8_t>(tops[first + i]);
                add(first + i, differences[i], change, out + (first + i) * kStride);
            }
        }
    }

 private:
    using Code = FrameCode<kForm>;
    static constexpr std::size_t kDigits = kHasPartner ? 2 : 3;  // in a row
    static constexpr std::size_t kStride =
        vertex_layout({PositionForm::quantised, kForm, UvForm::quantised, ColorForm::none}).stride;
    static constexpr std::size_t kTopPlane = 10;
    // Of each number, its low and its high byte.
    static constexpr std::array<std::array<std::size_t, 2>, kNumbers> kPlanes{
        {{0, 3}, {1, 4}, {2, 5}, {6, 8}, {7, 9}, {11, 14}, {12, 15}, {13, 16}}};

    /// The differences of `size` vertices.
    void read(const std::byte* planes, std::size_t first, std::size_t size,
              std::array<Row, kBlock>& out) const {
        std::array<Row, kNumbers> low;
        std::array<Row, kNumbers> high;
        for (std::size_t k = 0; k < kNumbers; ++k) {
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
        std::ranges::copy(high, out.begin() + kNumbers);
    }

    void add(std::size_t i, Row difference, std::uint8_t change, std::byte* out) {
        const std::uint16_t partner_difference = difference[7];
        if (kHasPartner) difference[7] = 0;
        Row row = difference;
        std::uint8_t top = change;
        unsigned differs = 1;
        if (i > 0) [[likely]] {
            const Neighbours& at = neighbours_[i];
            // In this order: mostly b is the vertex before, for which the others need not wait.
            row = row + rows_[at.a] - rows_[at.c] + rows_[at.b];
            const std::uint8_t before = tops_[at.a];
            top ^= before;
            differs = change | (tops_[at.b] ^ before) | (tops_[at.c] ^ before);
        }
        const std::uint32_t largest = top & 3u;
        if ((differs & 3u) != 0 || !reduce(row)) [[unlikely]] {
            Digits expected;
            expect(i, largest, (differs & 3u) != 0, expected);
            set_digits(row, expected, largest, difference);
        }
        rows_[i] = row;
        tops_[i] = top;
        if constexpr (kHasPartner) {
            row[7] = digit(Code::of_x_tangent(row[5], row[6]), partner_difference);
            partners_[i] = row[7];
        }
        put(row, top, out);
    }

    /// Each digit of a sum modulo the number of levels; false where that is too far.
    static bool reduce(Row& row) {
        if constexpr (Code::kWide) {
            row &= Row{0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 0x7FFF, 0x7FFF, 0x7FFF};
            return true;
        } else {
            constexpr std::int16_t kLevels = Code::kLevels;
            const SignedRow levels{0, 0, 0, 0, 0, kLevels, kLevels, kLevels};
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
                           const Row& difference) {
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
            const std::uint16_t value = k < kDigits ? rows_[i][kFirstDigit + k] : partners_[i];
            result.others[place(largest, k)] = static_cast<std::int16_t>(value);
        }
        return result;
    }

    /// Where among the others the digit is that is coded as number k.
    static std::size_t place(std::uint32_t largest, std::size_t k) {
        if (!kHasPartner || partner(largest) != 0) return k;
        return k == 2 ? 0 : k + 1;
    }

    static void put(const Row& row, std::uint8_t top, std::byte* out) {
        const bool turned = kHasPartner && partner(top & 3u) == 0;
        if constexpr (Code::kWide) {
            Row digits = turned ? __builtin_shufflevector(row, row, 0, 1, 2, 7, 5, 6, 3, 4)
                                : __builtin_shufflevector(row, row, 0, 1, 2, 5, 6, 7, 3, 4);
            digits |= kTopBits[top & 7u];
            std::memcpy(out, &digits, sizeof digits);
        } else {
            const std::uint32_t code =
                turned ? ((top * 811u + row[6]) * 811u + row[5]) * 811u + row[7]
                       : ((top * 811u + row[7]) * 811u + row[6]) * 811u + row[5];
            std::memcpy(out, &row, 6);
            std::memcpy(out + 6, &code, sizeof code);
            const Row uv = __builtin_shufflevector(row, row, 3, 4, 0, 0, 0, 0, 0, 0);
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
    std::span<const Neighbours> neighbours_;
    Row* rows_;
    std::uint8_t* tops_;
    std::uint16_t* partners_;  // the digits that the others of a vertex give
};

}  // namespace

void decode_rows(const MeshRecord& mesh, FrameModel model, std::span<const Neighbours> neighbours,
                 const std::byte* planes, std::byte* vertices, Scratch& scratch) {
    const auto decode = [&]<FrameForm kForm>() {
        if (model == FrameModel::neighbours)
            Rows<kForm, false>(mesh.vertex_count, neighbours, scratch).decode(planes, vertices);
        else
            Rows<kForm, true>(mesh.vertex_count, neighbours, scratch).decode(planes, vertices);
    };
    if (mesh.forms.frame == FrameForm::quat48)
        decode.operator()<FrameForm::quat48>();
    else
        decode.operator()<FrameForm::quat32>();
}

}  // namespace mesh_format
