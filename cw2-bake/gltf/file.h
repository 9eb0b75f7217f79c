// A glTF file with its buffers and images, as far as they can be had without decoding anything.
#pragma once

#include <tiny_gltf.h>

#include <cstddef>
#include <filesystem>
#include <list>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/io.h"
#include "cw2-bake/base/diagnostics.h"

namespace bake {

/// An image file: on disk, or in memory with a name that no other image of the glTF has.
struct GltfImage {
    std::filesystem::path file;
    std::shared_ptr<const std::vector<std::byte>> embedded;
    std::string note;     ///< as TextureMap has it
    std::string problem;  ///< why it cannot be used; empty if it can
};

/// tinygltf gives the model alone; the bytes are found here. Its own loader reads up to eight bytes
/// past the end of a .glb, follows indices unchecked, ends the program on a buffer of no bytes,
/// asks that a buffer's file be no longer than the buffer, searches the working directory, reads a
/// plus sign in a file's name as a blank, and holds every byte twice. So it is given JSON that has
/// been checked, without buffers, images and animations.
struct GltfFile {
    std::filesystem::path path;
    tinygltf::Model model;
    std::vector<std::span<const std::byte>> buffers;
    std::vector<GltfImage> images;
    std::vector<std::filesystem::path> buffer_files;  ///< that were read
    std::vector<std::string> unread;                  ///< what find_unread() says
    std::size_t size = 0;  ///< bytes of it and of its buffers: what it claims is held against these

    /// The bytes of a view as they lie in its buffer. Throws BakeError where it reaches past it.
    std::span<const std::byte> view_bytes(int view) const;

    /// What the spans point into.
    std::list<common::MappedFile> mapped;
    std::list<std::vector<std::byte>> decoded;
};

/// Throws BakeError "PATH: /json/pointer: what is wrong" for whatever is malformed and for a buffer
/// that is missing; what is wrong with an image is for those who use it. Warns of a buffer that is
/// another file than the one that is named. Files are looked for as FileFinder does with `root`.
GltfFile load_gltf(const std::filesystem::path& path, const Warn& warn,
                   const std::filesystem::path& root);

}  // namespace bake
