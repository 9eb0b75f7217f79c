// Decimal digits of a text, many bytes in one go.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace bake {

/// How many bytes non_digits() looks at.
inline constexpr std::size_t kDigitWindow = 64;

/// The longest run of digits whose value is computed here.
inline constexpr std::size_t kMaxDigits = 7;

/// The `count` <= kMaxDigits digits before `end`, where eight bytes can be read. Of none the value
/// is 0.
struct Digits {
    const char* end;
    std::size_t count;
};

/// Four integers; what compares them says -1 for yes and 0 for no.
typedef std::int32_t Four __attribute__((vector_size(16)));

#if defined(__SSE2__)

/// Bit i tells whether p[i] is no digit.
inline std::uint64_t non_digits(const char* p) {
    const auto digits_of_sixteen = [p](int i) {
        const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p) + i);
        // Moved to where digits are the least of all signed bytes.
        const __m128i moved = _mm_add_epi8(bytes, _mm_set1_epi8(static_cast<char>(0x80 - '0')));
        const __m128i digits = _mm_cmplt_epi8(moved, _mm_set1_epi8(-0x80 + 10));
        return std::uint64_t{static_cast<std::uint32_t>(_mm_movemask_epi8(digits))};
    };
    return ~(digits_of_sixteen(0) | digits_of_sixteen(1) << 16 | digits_of_sixteen(2) << 32 |
             digits_of_sixteen(3) << 48);
}

namespace digits_detail {

inline __m128i eight_bytes(const void* p) {
    return _mm_loadl_epi64(static_cast<const __m128i*>(p));
}

/// What the bytes of eight digits are and'ed with, so that the values of the last n are left.
inline constexpr std::array<std::uint64_t, kMaxDigits + 1> kLast{
    0,
    0x0F00'0000'0000'0000,
    0x0F0F'0000'0000'0000,
    0x0F0F'0F00'0000'0000,
    0x0F0F'0F0F'0000'0000,
    0x0F0F'0F0F'0F00'0000,
    0x0F0F'0F0F'0F0F'0000,
    0x0F0F'0F0F'0F0F'0F00,
};

inline __m128i two_runs(Digits a, Digits b) {
    const __m128i text = _mm_unpacklo_epi64(eight_bytes(a.end - 8), eight_bytes(b.end - 8));
    return text & _mm_unpacklo_epi64(eight_bytes(&kLast[a.count]), eight_bytes(&kLast[b.count]));
}

/// Of two runs of eight digits the first and the last four, as numbers.
inline __m128i by_fours(__m128i digits) {
    // The first digit of a pair is in the lower byte.
    const __m128i pairs = _mm_srli_epi16(_mm_mullo_epi16(digits, _mm_set1_epi16(10 << 8 | 1)), 8);
    return _mm_madd_epi16(pairs, _mm_set1_epi32(1 << 16 | 100));
}

/// Of four runs of eight digits the values.
inline __m128i by_eights(__m128i fours, __m128i more_fours) {
    return _mm_madd_epi16(_mm_packs_epi32(fours, more_fours), _mm_set1_epi32(1 << 16 | 10'000));
}

}  // namespace digits_detail

/// The values of three runs, and 0.
inline Four values_of(Digits a, Digits b, Digits c) {
    using namespace digits_detail;
    const __m128i last = eight_bytes(c.end - 8) & eight_bytes(&kLast[c.count]);
    return Four(by_eights(by_fours(two_runs(a, b)), by_fours(last)));
}

/// The values of two runs.
inline std::array<double, 2> values_of(Digits a, Digits b) {
    using namespace digits_detail;
    const __m128i fours = by_fours(two_runs(a, b));
    const __m128d values = _mm_cvtepi32_pd(by_eights(fours, fours));
    return {values[0], values[1]};
}

inline bool any(Four yes) {
    return _mm_movemask_epi8(__m128i(yes)) != 0;
}

#else

inline std::uint64_t non_digits(const char* p) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < kDigitWindow; ++i) {
        bits |= std::uint64_t{p[i] < '0' || p[i] > '9'} << i;
    }
    return bits;
}

inline std::int32_t value_of(Digits digits) {
    std::int32_t value = 0;
    for (const char* p = digits.end - digits.count; p != digits.end; ++p) {
        value = value * 10 + (*p - '0');
    }
    return value;
}

inline Four values_of(Digits a, Digits b, Digits c) {
    return Four{value_of(a), value_of(b), value_of(c), 0};
}

inline std::array<double, 2> values_of(Digits a, Digits b) {
    return {double(value_of(a)), double(value_of(b))};
}

inline bool any(Four yes) {
    return (yes[0] | yes[1] | yes[2] | yes[3]) != 0;
}

#endif

}  // namespace bake
