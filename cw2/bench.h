// What --bench measures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cw2/options/options.h"
#include "cw2/render/renderer.h"

namespace cw2 {

/// What pictures took, one after the other, each from its commands to the bytes on the host.
struct Bench {
    std::vector<double> wall;    ///< milliseconds
    std::vector<double> cpu;     ///< the same, of all threads of the process
    std::vector<double> device;  ///< the same, of the frames; 0 where the device has no timestamps
    FrameCounts counts;          ///< of one frame of the last picture
    std::optional<std::uint64_t> fragments;  ///< see Renderer::fragments()
    std::size_t pipelines = 0;
};

/// The value that a share of `values`, in [0, 1], do not exceed; 0 for none.
double quantile(std::vector<double> values, double share);

/// The most memory that the process has held so far, MiB.
double peak_memory();

/// A few lines for people.
std::string text_of(const Bench& bench, const PictureSize& size, std::uint32_t samples);
/// Members of a JSON object, each behind a comma.
std::string json_of(const Bench& bench, const PictureSize& size);

}  // namespace cw2
