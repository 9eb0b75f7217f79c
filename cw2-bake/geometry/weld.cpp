#include "cw2-bake/geometry/weld.h"

#include <algorithm>
#include <bit>

namespace bake {
namespace {

constexpr std::size_t kTrianglesPerBlock = 4096;

/// Numbers the vertices in the order of the corners that have them first.
class VertexMaker {
 public:
    /// A corner without a UV gets the scene's last.
    VertexMaker(const SourceScene& scene, const FirstEqual& positions,
                RawVector<FramedVertex>& vertices)
        : scene_(scene),
          positions_(positions),
          absent_uv_(static_cast<std::uint32_t>(scene.uvs.size()) - 1),
          vertices_(vertices),
          head_(scene.positions.size(), kNone),
          overflow_(0) {
        // At most; what is left over is never touched.
        vertices_.resize(scene.corners.size());
    }

    /// The vertices of corners of one material.
    void number(std::span<const Corner> corners, std::uint32_t material, std::uint32_t* out) {
        FramedVertex* const vertices = vertices_.data();
        std::uint32_t* const head = head_.data();
        for (Corner corner : corners) {
            corner.position = positions_[corner.position];
            corner.uv = corner.uv != kAbsent ? corner.uv : absent_uv_;
            int length = 0;
            std::uint32_t i = head[corner.position];
            for (; i != kNone; i = link_of(vertices[i]).next) {
                if ((link_of(vertices[i]).material == material &&
                     is_alike(vertices[i].corner, corner)) ||
                    ++length == kMaxChain)
                    break;
            }
            if (i == kNone) {
                i = count_++;
                vertices[i] = linked(corner, {head[corner.position], material});
                head[corner.position] = i;
            } else if (length == kMaxChain) {
                i = overflowing_vertex(corner, material);
            }
            *out++ = i;
        }
    }

    void finish() { vertices_.resize(count_); }

 private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr int kMaxChain = 24;

    /// Whether corners at one position are equal in value. Nearly always their indices tell.
    bool is_alike(const Corner& a, const Corner& b) const {
        return (a.normal == b.normal || scene_.normals[a.normal] == scene_.normals[b.normal]) &&
               (a.uv == b.uv || scene_.uvs[a.uv] == scene_.uvs[b.uv]);
    }

    std::uint32_t overflowing_vertex(const Corner& corner, std::uint32_t material) {
        const auto is_equal = [&](std::uint32_t i) {
            const Corner& other = vertices_[i].corner;
            return other.position == corner.position &&
                   link_of(vertices_[i]).material == material && is_alike(other, corner);
        };
        const glm::vec3& normal = scene_.normals[corner.normal];
        const glm::vec2& uv = scene_.uvs[corner.uv];
        const std::uint32_t found = overflow_.find_or_insert(
            hash_of(corner.position, normal.x, normal.y, normal.z, uv.x, uv.y, material), count_,
            is_equal);
        if (found != count_) return found;
        vertices_[count_] = linked(corner, {kNone, material});
        return count_++;
    }

    struct Link {
        std::uint32_t next;  ///< vertex at the same position
        std::uint32_t material;
    };
    /// Lies in the place of the tangent, which is made later.
    static Link link_of(const FramedVertex& vertex) {
        return std::bit_cast<Link>(glm::vec2(vertex.tangent));
    }
    static FramedVertex linked(const Corner& corner, Link link) {
        return {corner, glm::vec4(std::bit_cast<glm::vec2>(link), 0.0f, 0.0f)};
    }

    const SourceScene& scene_;
    const FirstEqual& positions_;
    std::uint32_t absent_uv_;
    RawVector<FramedVertex>& vertices_;
    std::vector<std::uint32_t> head_;  // by position
    std::uint32_t count_ = 0;
    /// What exceeds kMaxChain at one position; nearly all have few.
    IndexSet overflow_;
};

}  // namespace

FramedTriangles weld(SourceScene& scene, const FirstEqual& positions, const Advance& advance) {
    scene.uvs.emplace_back(0.0f);
    FramedTriangles result;
    result.indices.resize(scene.corners.size());
    VertexMaker maker(scene, positions, result.vertices);
    const std::size_t triangle_count = scene.corners.size() / 3;
    PageReleaser used(std::as_writable_bytes(std::span(scene.corners)));
    std::size_t begin = 0;
    for (const RunVector::Run& run : scene.triangle_material.runs()) {
        while (begin < run.end) {
            const std::size_t end = std::min(begin + kTrianglesPerBlock, run.end);
            maker.number(std::span(scene.corners).subspan(3 * begin, 3 * (end - begin)), run.number,
                         &result.indices[3 * begin]);
            used.release(3 * end * sizeof(Corner));
            advance(static_cast<double>(end - begin) / static_cast<double>(triangle_count));
            begin = end;
        }
    }
    maker.finish();
    std::vector<Corner>().swap(scene.corners);
    return result;
}

}  // namespace bake
