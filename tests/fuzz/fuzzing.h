// What the fuzz targets share. A target aborts where a program would lose something: a sanitizer
// finds a fault, an exception is none of ours, or what was written is not read again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace fuzzing {

/// A folder of its own that lasts as long as the process, with an image a.png of 4 x 4 texels.
const std::filesystem::path& folder();

/// Writes a file in the folder.
void write(const std::string& name, std::span<const std::uint8_t> bytes);

/// A number that nearby inputs have others of (FNV-1a).
std::uint64_t draw_from(std::span<const std::uint8_t> bytes);

/// Bakes a file of the folder, in forms that are drawn from `bytes`; half of the time to a GLB,
/// which is baked once more. Errors on the input are well.
void bake_any(const std::string& name, std::span<const std::uint8_t> bytes);

/// Reads the bytes of a .cw2mesh in all ways there are.
void read_mesh(std::span<const std::byte> bytes);

}  // namespace fuzzing
