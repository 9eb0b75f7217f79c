// What a mesh's vertices are predicted from when they are coded, in integers only: so every
// processor predicts the same.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "mesh-format/layout.h"
#include "mesh-format/surface.h"

namespace mesh_format {

/// Whether the last digit of a frame is what the other two give.
constexpr bool has_partner(FrameModel model) {
    return model == FrameModel::x_tangent || model == FrameModel::x_tangent_by_area ||
           model == FrameModel::x_tangent_by_angle;
}

/// Whether frames are predicted from surfaces; else from neighbours.
constexpr bool has_surface(FrameModel model) {
    return model >= FrameModel::surface_by_area;
}

constexpr SurfaceModel surface_of(FrameModel model, int area_shift) {
    return {model == FrameModel::surface_by_angle || model == FrameModel::x_tangent_by_angle,
            !has_partner(model), area_shift};
}

/// One for each component of a quaternion but the largest.
using Digits = std::array<std::int16_t, 3>;

/// A tangent frame of quat48 or quat32, taken apart; tangent_frame.h says how.
struct FrameDigits {
    Digits others;
    std::uint16_t top;  ///< the largest component's number, in quat32 up to 8; + 4 left-handed
};

/// The digits of one of the two forms. Positive and negative ones are equally many; they stand for
/// angles of a ratio, and ratios are in units of 1 / 32768.
template <FrameForm kForm>
struct FrameCode {
    static_assert(kForm == FrameForm::quat48 || kForm == FrameForm::quat32);
    static constexpr bool kWide = kForm == FrameForm::quat48;
    static constexpr int kZero = kWide ? 16'383 : 405;    ///< the digit of ratio 0
    static constexpr int kLevels = kWide ? 32'768 : 811;  ///< digits are below; 32,767 is spare

    /// Modulo kLevels. Short for 32,768 levels: the next vertex waits for it.
    static int reduced(int sum) {
        const int rest = kWide ? sum & (kLevels - 1) : sum % kLevels;
        return rest < 0 ? rest + kLevels : rest;
    }

    static FrameDigits take_apart(const std::byte* in);
    static void put_together(const FrameDigits& frame, std::byte* out);

    /// Sets `others` to the digits of the same rotation if component `largest` is taken for the
    /// largest one. Here and below there is no result: it would be put together from words and
    /// read as something longer, for which processors wait.
    static void rebased(const FrameDigits& frame, std::uint32_t largest, Digits& others);

    /// What digit others[partner(largest)] is where the tangent is the x axis, made orthogonal to
    /// the normal: then the bitangent's x, 2 (xy - zw) of the quaternion, is 0.
    /// `first` and `second` are the other two digits, in their order.
    static int of_x_tangent(int first, int second);

    /// Sets `others` to the digits of rotation `k` if component `largest` is taken for the largest
    /// one.
    static void of_rotation(const Rotations& rotations, std::size_t k, std::uint32_t largest,
                            Digits& others);
};

/// Calls use<form, has_partner(model), has_surface(model)>(), for a form in digits.
template <typename Use>
void with_model(FrameForm form, FrameModel model, const Use& use) {
    const auto with_form = [&]<FrameForm kForm>() {
        if (has_partner(model) && has_surface(model))
            use.template operator()<kForm, true, true>();
        else if (has_partner(model))
            use.template operator()<kForm, true, false>();
        else if (has_surface(model))
            use.template operator()<kForm, false, true>();
        else
            use.template operator()<kForm, false, false>();
    };
    if (form == FrameForm::quat48)
        with_form.template operator()<FrameForm::quat48>();
    else
        with_form.template operator()<FrameForm::quat32>();
}

/// The place among the others of that component whose product with the largest is xy or zw.
constexpr std::uint32_t partner(std::uint32_t largest) {
    return (largest ^ 1) - ((largest ^ 1) > largest);
}

template <FrameForm kForm>
inline FrameDigits FrameCode<kForm>::take_apart(const std::byte* in) {
    FrameDigits frame{};
    if constexpr (kWide) {
        std::array<std::uint16_t, 3> words;
        std::memcpy(&words, in, sizeof words);
        for (std::size_t k = 0; k < 3; ++k)
            frame.others[k] = static_cast<std::int16_t>(words[k] & 0x7FFF);
        frame.top =
            static_cast<std::uint16_t>(words[1] >> 15 | words[2] >> 15 << 1 | words[0] >> 15 << 2);
    } else {
        std::uint32_t code = 0;
        std::memcpy(&code, in, sizeof code);
        for (std::int16_t& digit : frame.others) {
            digit = static_cast<std::int16_t>(code % kLevels);
            code /= kLevels;
        }
        frame.top = static_cast<std::uint16_t>(code);
    }
    return frame;
}

template <FrameForm kForm>
inline void FrameCode<kForm>::put_together(const FrameDigits& frame, std::byte* out) {
    if constexpr (kWide) {
        // In one register: processors wait where words are written and read as something longer.
        const std::uint64_t high[] = {frame.top >> 2u & 1u, frame.top & 1u, frame.top >> 1u & 1u};
        std::uint64_t code = 0;
        for (std::size_t k = 0; k < 3; ++k)
            code |= (static_cast<std::uint64_t>(frame.others[k]) | high[k] << 15) << (16 * k);
        std::memcpy(out, &code, 6);
    } else {
        std::uint32_t code = frame.top;
        for (std::size_t k = 3; k-- > 0;)
            code = code * kLevels + static_cast<std::uint32_t>(frame.others[k]);
        std::memcpy(out, &code, sizeof code);
    }
}

}  // namespace mesh_format
