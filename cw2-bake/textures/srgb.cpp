#include "cw2-bake/textures/srgb.h"

#include "common/srgb.h"

namespace bake {
namespace {

float decode(double encoded) {
    return static_cast<float>(common::linear_of_srgb(encoded));
}

}  // namespace

SrgbTables::SrgbTables() : linear16_(65'536) {
    for (std::size_t i = 0; i < 256; ++i) {
        linear8_[i] = decode(static_cast<double>(i) / 255.0);
        upper_[i] = i < 255 ? decode((static_cast<double>(i) + 0.5) / 255.0) : 2.0f;
    }
    for (std::size_t i = 0; i < linear16_.size(); ++i) {
        linear16_[i] = decode(static_cast<double>(i) / 65'535.0);
    }
    std::size_t byte = 0;
    for (std::size_t i = 0; i <= kGuesses; ++i) {
        while (static_cast<float>(i) / kGuesses >= upper_[byte]) {
            ++byte;
        }
        guess_[i] = static_cast<std::uint8_t>(byte);
    }
}

const SrgbTables& srgb() {
    static const SrgbTables tables;
    return tables;
}

}  // namespace bake
