// Texts, counts and offsets beyond 2^32, in files that are mostly holes.
#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <vector>

#include "common/io.h"
#include "obj_text.h"
#include "small_scene.h"

namespace {

constexpr std::uint64_t k4GiB = std::uint64_t{1} << 32;

// The address sanitizer keeps a byte for eight that are read, the thread sanitizer two for one.
#ifndef __has_feature
#define __has_feature(feature) 0
#endif
#if __has_feature(thread_sanitizer)
constexpr long kMostKibibytes = 10'240 << 10;
#elif __has_feature(address_sanitizer) || defined(__SANITIZE_ADDRESS__)
constexpr long kMostKibibytes = 1280 << 10;
#else
constexpr long kMostKibibytes = 256 << 10;
#endif

/// A file whose parts are written wherever they belong; nothing lies between them.
class SparseFile {
 public:
    explicit SparseFile(const std::filesystem::path& path)
        : descriptor_(::open(path.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600)) {}
    ~SparseFile() { ::close(descriptor_); }
    SparseFile(const SparseFile&) = delete;
    SparseFile& operator=(const SparseFile&) = delete;

    void skip(std::uint64_t bytes) { end_ += bytes; }
    void write(std::span<const std::byte> bytes) {
        const auto size = static_cast<ssize_t>(bytes.size());
        if (::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(end_)) != size)
            throw std::runtime_error("cannot write a sparse file");
        end_ += bytes.size();
    }
    void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
    std::uint64_t end() const { return end_; }

 private:
    int descriptor_;
    std::uint64_t end_ = 0;
};

TEST(LargeFiles, AnObjGoesOnBeyond4GiBInLittleMemory) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "large.obj";
    std::size_t line = 3;  // of the comment that is written
    {
        SparseFile file(path);
        file.write("v 0 0 0\nv 2 0 0\n#" + std::string(10'000, '-'));
        // Lines of comments.
        for (; file.end() < k4GiB; ++line) {
            file.skip(1 << 20);
            file.write("\n#");
        }
        file.write("\nv 0 3 0\nf 1 2\nf 1 2 -1\n");
    }
    // Of the pages of the file none stays in memory once it is read; what is mapped counts, too.
    rusage before{}, after{};
    ::getrusage(RUSAGE_SELF, &before);
    std::vector<std::string> warnings;
    const bake::SourceScene scene =
        bake::read_obj(path, [&](const std::string& warning) { warnings.push_back(warning); });
    ::getrusage(RUSAGE_SELF, &after);
    ASSERT_EQ(scene.corners.size(), 3u);
    EXPECT_EQ(scene.positions[scene.corners[2].position], glm::vec3(0, 3, 0));
    EXPECT_EQ(warnings, std::vector<std::string>{fmt::format(
                            "{}:{}: a face of fewer than three corners is left out (1 in all)",
                            path.string(), line + 2)});
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, kMostKibibytes);
}

TEST(LargeFiles, OffsetsInABakedFileGoBeyond4GiB) {
    using namespace mesh_format;
    const small_scene::SmallScene small;
    Document document = small.document();
    const MeshRecord first = small.meshes.front();
    constexpr std::size_t kStride = 16;
    ASSERT_EQ(vertex_layout(first.forms).stride, kStride);
    const std::size_t mesh_count = k4GiB / (kMaxMeshVertices * kStride) + 2;
    std::vector<MeshRecord> meshes(mesh_count, first);
    std::vector<ChunkRecord> chunks(mesh_count, small.chunks.front());
    for (std::uint32_t i = 0; i < mesh_count; ++i) {
        meshes[i].vertex_count = kMaxMeshVertices;
        meshes[i].vertex_offset = std::uint64_t{i} * kMaxMeshVertices * kStride;
        meshes[i].first_index = 3 * i;
        meshes[i].index_count = 3;
        meshes[i].first_chunk = i;
        meshes[i].chunk_count = 1;
    }
    const std::vector<std::uint16_t> indices(3 * mesh_count, 0xFFFF);
    const std::size_t vertex_bytes = mesh_count * kMaxMeshVertices * kStride;
    void* const memory = ::mmap(nullptr, vertex_bytes, PROT_READ | PROT_WRITE,
                                MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    ASSERT_NE(memory, MAP_FAILED);
    const std::span vertices(static_cast<std::byte*>(memory), vertex_bytes);
    vertices.back() = std::byte{42};
    document.meshes = meshes;
    document.chunks = chunks;
    document.vertices = vertices;
    document.indices = indices;
    document.scene.vertex_bytes = vertex_bytes;
    document.scene.index_count = indices.size();

    const TemporaryFolder folder;
    const auto path = folder.path() / "large.cw2mesh";
    {
        SparseFile file(path);
        const std::uint64_t size =
            write(document, small.payloads(), "the file", [&](std::span<const std::byte> part) {
                const std::size_t hole = part.data() == memory ? part.size() - 1 : 0;
                file.skip(hole);
                file.write(part.subspan(hole));
            });
        EXPECT_EQ(size, file.end());
        EXPECT_GT(size, k4GiB);
    }
    ::munmap(memory, vertex_bytes);
    const common::MappedFile file(path);
    const Document read = parse(file.bytes(), "the file");
    EXPECT_EQ(read.meshes.size(), mesh_count);
    EXPECT_GT(read.meshes.back().vertex_offset, k4GiB);
    EXPECT_EQ(read.vertices.size(), vertex_bytes);
    EXPECT_EQ(read.vertices.back(), std::byte{42});
    EXPECT_EQ(read.indices.back(), 0xFFFF);
    EXPECT_EQ(read.payload(read.textures[1])[0], small.payloads()[1][0]);
}

}  // namespace
