#include "cw2-bake/geometry/coarse_split.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <compare>
#include <functional>
#include <mutex>

#include "cw2-bake/geometry/box.h"

namespace bake {
namespace {

constexpr std::size_t kBlock = 1 << 15;
constexpr std::size_t kBins = 256;

/// Those of one material, in the order of the source.
struct MaterialTriangles {
    struct Run {
        std::size_t first, size;
    };
    std::vector<Run> runs;
    std::size_t size = 0;

    template <typename Visit>
    void for_each(const Visit& visit) const {
        std::size_t k = 0;
        for (const Run& run : runs)
            for (std::size_t t = run.first; t < run.first + run.size; ++t) visit(k++, t);
    }
};

std::vector<MaterialTriangles> by_material(const SourceScene& scene) {
    std::vector<MaterialTriangles> result(scene.materials.size());
    std::size_t begin = 0;
    for (const RunVector::Run& run : scene.triangle_material.runs()) {
        result[run.number].runs.push_back({begin, run.end - begin});
        result[run.number].size += run.end - begin;
        begin = run.end;
    }
    return result;
}

struct Key {
    float coordinate;
    std::uint32_t index;
    auto operator<=>(const Key&) const = default;
};

/// Some triangles that are halved.
struct Node {
    std::size_t size;
    Box<glm::vec3> box{};  ///< of the centroids
    int axis = 0;          ///< of the longest side
    float scale = 0.0f;    ///< from coordinates above the least one to bins
    std::size_t bin = 0;   ///< where the cut is
    std::size_t rank = 0;  ///< of the cut, in its bin
    Key cut{};             ///< the first of the upper half

    void choose_axis() {
        const glm::vec3 extent = box.high - box.low;
        axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        scale = extent[axis] > 0.0f ? (kBins - 1) / extent[axis] : 0.0f;
    }
    std::size_t bin_of(float coordinate) const {
        const float place = (coordinate - box.low[axis]) * scale;
        return static_cast<std::size_t>(std::min(place, float{kBins - 1}));
    }
};

/// Halves the triangles of one material, all nodes of a level at once.
class LevelSplit {
 public:
    LevelSplit(const FramedScene& scene, const MaterialTriangles& triangles)
        : centroids_(triangles.size), node_of_(triangles.size), nodes_{{triangles.size}} {
        std::size_t first = 0;
        for (const auto& run : triangles.runs) {
            for_each_block(run.size, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i)
                    centroids_[first + i] = scene.centroid(run.first + i);
            });
            first += run.size;
        }
        bound([&](std::size_t k, std::span<Box<glm::vec3>> boxes) {
            node_of_[k] = 0;
            boxes[0].add(centroids_[k]);
        });
    }

    void halve() {
        for (Node& node : nodes_) node.choose_axis();
        find_bins();
        find_cuts();
        const std::vector<Node> halved = std::move(nodes_);
        nodes_.clear();
        for (const Node& node : halved) {
            nodes_.push_back({node.size / 2});
            nodes_.push_back({node.size - node.size / 2});
        }
        bound([&](std::size_t k, std::span<Box<glm::vec3>> boxes) {
            const Node& node = halved[node_of_[k]];
            const Key key{centroids_[k][node.axis], static_cast<std::uint32_t>(k)};
            const auto child = static_cast<std::uint16_t>(2 * node_of_[k] + (key >= node.cut));
            node_of_[k] = child;
            boxes[child].add(centroids_[k]);
        });
    }

    std::span<const Node> nodes() const { return nodes_; }
    std::uint16_t node_of(std::size_t k) const { return node_of_[k]; }
    void forget_centroids() { RawVector<glm::vec3>().swap(centroids_); }

 private:
    template <typename Visit>
    static void for_each_block(std::size_t size, const Visit& visit) {
        tbb::parallel_for(std::size_t{0}, (size + kBlock - 1) / kBlock, [&](std::size_t block) {
            visit(block * kBlock, std::min((block + 1) * kBlock, size));
        });
    }

    /// visit(triangle, boxes) puts each triangle into its node, and its centroid into that one's
    /// box.
    template <typename Visit>
    void bound(const Visit& visit) {
        std::mutex mutex;
        for_each_block(node_of_.size(), [&](std::size_t begin, std::size_t end) {
            std::vector<Box<glm::vec3>> boxes(nodes_.size());
            for (std::size_t k = begin; k < end; ++k) visit(k, std::span(boxes));
            const std::lock_guard lock(mutex);
            for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].box.add(boxes[i]);
        });
    }

    std::size_t bin_of(std::size_t k) const {
        const Node& node = nodes_[node_of_[k]];
        return node.bin_of(centroids_[k][node.axis]);
    }

    /// The bin that the cut of each node is in.
    void find_bins() {
        using Counts = std::array<std::uint32_t, kBins>;
        std::mutex mutex;
        std::vector<Counts> all(nodes_.size());
        for_each_block(node_of_.size(), [&](std::size_t begin, std::size_t end) {
            std::vector<Counts> counts(nodes_.size());
            for (std::size_t k = begin; k < end; ++k) ++counts[node_of_[k]][bin_of(k)];
            const std::lock_guard lock(mutex);
            for (std::size_t i = 0; i < counts.size(); ++i)
                std::ranges::transform(counts[i], all[i], all[i].begin(), std::plus());
        });
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            Node& node = nodes_[i];
            node.rank = node.size / 2;
            for (node.bin = 0; node.rank >= all[i][node.bin]; ++node.bin)
                node.rank -= all[i][node.bin];
        }
    }

    void find_cuts() {
        std::mutex mutex;
        std::vector<std::vector<Key>> keys(nodes_.size());
        for_each_block(node_of_.size(), [&](std::size_t begin, std::size_t end) {
            std::vector<std::pair<std::uint16_t, Key>> found;
            for (std::size_t k = begin; k < end; ++k) {
                const std::uint16_t i = node_of_[k];
                const float coordinate = centroids_[k][nodes_[i].axis];
                if (nodes_[i].bin_of(coordinate) == nodes_[i].bin)
                    found.push_back({i, {coordinate, static_cast<std::uint32_t>(k)}});
            }
            const std::lock_guard lock(mutex);
            for (const auto& [node, key] : found) keys[node].push_back(key);
        });
        tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t i) {
            const auto nth = keys[i].begin() + static_cast<std::ptrdiff_t>(nodes_[i].rank);
            std::nth_element(keys[i].begin(), nth, keys[i].end());
            nodes_[i].cut = *nth;
        });
    }

    // By triangle, in their order:
    RawVector<glm::vec3> centroids_;
    RawVector<std::uint16_t> node_of_;
    std::vector<Node> nodes_;
};

}  // namespace

CoarseParts split_coarsely(const FramedScene& scene) {
    const std::vector<MaterialTriangles> materials = by_material(scene.source);
    CoarseParts result;
    result.triangles.resize(scene.source.triangle_material.size());
    std::size_t first = 0;
    for (std::uint32_t m = 0; m < materials.size(); ++m) {
        const MaterialTriangles& triangles = materials[m];
        std::uint32_t* const out = result.triangles.data() + first;
        if (triangles.size <= CoarseParts::kMostTriangles) {
            if (triangles.size > 0) result.parts.push_back({m, first, triangles.size});
            triangles.for_each(
                [&](std::size_t k, std::size_t t) { out[k] = static_cast<std::uint32_t>(t); });
            first += triangles.size;
            continue;
        }
        LevelSplit levels(scene, triangles);
        while (levels.nodes().back().size > CoarseParts::kMostTriangles) levels.halve();
        levels.forget_centroids();
        std::vector<std::size_t> next;
        for (const Node& node : levels.nodes()) {
            next.push_back(first);
            result.parts.push_back({m, first, node.size});
            first += node.size;
        }
        triangles.for_each([&](std::size_t k, std::size_t t) {
            result.triangles[next[levels.node_of(k)]++] = static_cast<std::uint32_t>(t);
        });
    }
    return result;
}

}  // namespace bake
