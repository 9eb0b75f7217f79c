#include "cw2-bake/gltf/accessors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "cw2-bake/gltf/json.h"
#include "cw2-bake/gltf/meshopt.h"

namespace bake {
namespace {

/// Calls `use` with a zero of the component type.
template <typename Use>
auto with_component_type(int type, Use&& use) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return use(std::int8_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return use(std::uint8_t{});
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return use(std::int16_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return use(std::uint16_t{});
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return use(std::uint32_t{});
        default:
            return use(float{});
    }
}

std::size_t component_bytes(int type) {
    return with_component_type(type, [](auto zero) { return sizeof zero; });
}

/// The glTF specification's section 3.6.2.2 tells how a normalised integer becomes a float.
template <typename T>
float to_float(T value, bool normalized) {
    if constexpr (!std::is_floating_point_v<T>) {
        constexpr auto kLargest = static_cast<float>(std::numeric_limits<T>::max());
        if (normalized) return std::max(static_cast<float>(value) / kLargest, -1.0f);
    }
    return static_cast<float>(value);
}

std::vector<std::uint32_t> unsigned_numbers(std::span<const std::byte> bytes, int type) {
    return with_component_type(type, [&](auto zero) {
        std::vector<decltype(zero)> numbers(bytes.size() / sizeof zero);
        std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof zero);
        return std::vector<std::uint32_t>(numbers.begin(), numbers.end());
    });
}

bool is_unsigned(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

}  // namespace

void GltfAccessors::fail(int accessor, const std::string& what) const {
    fail_at(file_.path, fmt::format("/accessors/{}", accessor), what);
}

int GltfAccessors::components(int accessor) const {
    return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(at(accessor).type));
}

std::span<const std::byte> GltfAccessors::view_bytes(int index) {
    const auto& view = file_.model.bufferViews[static_cast<std::size_t>(index)];
    if (view.extensions.contains(kMeshoptExtension)) {
        const auto [entry, fresh] = decompressed_.try_emplace(index);
        if (fresh) {
            // Views that share compressed bytes would make any number of decoded ones of them.
            const auto& extension = view.extensions.at(kMeshoptExtension);
            compressed_bytes_ +=
                static_cast<std::size_t>(extension.Get("byteLength").GetNumberAsInt());
            if (compressed_bytes_ > file_.size)
                fail_at(file_.path, fmt::format("/bufferViews/{}", index),
                        "its compressed bytes belong to other views, too");
            entry->second = decode_meshopt(file_, static_cast<std::size_t>(index));
        }
        return entry->second;
    }
    return file_.view_bytes(index);
}

std::vector<std::byte> GltfAccessors::view_elements(int accessor, int view_index,
                                                    std::size_t offset, std::size_t count,
                                                    std::size_t element_bytes,
                                                    bool may_have_stride) {
    const auto& view = file_.model.bufferViews[static_cast<std::size_t>(view_index)];
    const std::span<const std::byte> bytes = view_bytes(view_index);
    const std::size_t stride =
        may_have_stride && view.byteStride > 0 ? view.byteStride : element_bytes;
    // No overflow: counts, offsets and strides have been checked to be far below 2^64.
    if (offset + stride * (count - 1) + element_bytes > bytes.size())
        fail(accessor, "reaches past its buffer view");
    const std::byte* from = bytes.data() + offset;
    std::vector<std::byte> elements(count * element_bytes);
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(elements.data() + i * element_bytes, from + i * stride, element_bytes);
    return elements;
}

void GltfAccessors::apply_sparse(int index, std::size_t element_bytes,
                                 std::vector<std::byte>& elements) {
    const auto& accessor = at(index);
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    const int type = sparse.indices.componentType;
    if (sparse.count < 1 || !is_unsigned(type))
        fail(index, "its sparse part has no count, or indices of a wrong type");
    const auto at_bytes = view_elements(index, sparse.indices.bufferView,
                                        static_cast<std::size_t>(sparse.indices.byteOffset), count,
                                        component_bytes(type), false);
    const auto values = view_elements(index, sparse.values.bufferView,
                                      static_cast<std::size_t>(sparse.values.byteOffset), count,
                                      element_bytes, false);
    const std::vector<std::uint32_t> places = unsigned_numbers(at_bytes, type);
    for (std::size_t i = 0; i < count; ++i) {
        if (places[i] >= accessor.count) fail(index, "a sparse index is out of range");
        std::memcpy(elements.data() + places[i] * element_bytes, values.data() + i * element_bytes,
                    element_bytes);
    }
}

std::vector<std::byte> GltfAccessors::packed_elements(int index) {
    const auto& accessor = at(index);
    const std::size_t element_bytes =
        static_cast<std::size_t>(components(index)) * component_bytes(accessor.componentType);
    std::vector<std::byte> elements;
    if (accessor.bufferView >= 0) {
        elements = view_elements(index, accessor.bufferView, accessor.byteOffset, accessor.count,
                                 element_bytes, true);
    } else {
        if (accessor.count > kMostZeros) fail(index, "claims too many elements without a view");
        elements.resize(accessor.count * element_bytes);
    }
    if (accessor.sparse.isSparse) apply_sparse(index, element_bytes, elements);
    return elements;
}

std::vector<float> GltfAccessors::read_floats(int index, int wanted_components, NotFinite rule) {
    if (components(index) != wanted_components)
        fail(index, fmt::format("has not {} components, as its use asks", wanted_components));
    const auto& accessor = at(index);
    const std::vector<std::byte> elements = packed_elements(index);
    std::vector<float> floats = with_component_type(accessor.componentType, [&](auto zero) {
        std::vector<float> result(elements.size() / sizeof zero);
        for (std::size_t i = 0; i < result.size(); ++i) {
            auto value = zero;
            std::memcpy(&value, elements.data() + i * sizeof zero, sizeof zero);
            result[i] = to_float(value, accessor.normalized);
        }
        return result;
    });
    const auto stride = static_cast<std::size_t>(wanted_components);
    std::size_t not_finite = 0;
    for (std::size_t i = 0; i < floats.size(); ++i) {
        if (std::isfinite(floats[i])) continue;
        const std::size_t element = i / stride;
        if (rule == NotFinite::is_error)
            fail(index, fmt::format("element {} is not finite", element));
        ++not_finite;
        std::fill_n(floats.begin() + static_cast<std::ptrdiff_t>(element * stride), stride, 0.0f);
    }
    if (not_finite > 0 && not_finite_.insert(index).second) {
        warn_(fmt::format("{}: /accessors/{}: {} of its elements are not finite, and left out",
                          file_.path.string(), index, not_finite));
    }
    return floats;
}

const std::vector<float>& GltfAccessors::cached(int index, int wanted_components, NotFinite rule) {
    const auto known = floats_.find(index);
    if (known != floats_.end() && components(index) == wanted_components) return known->second;
    return floats_.insert_or_assign(index, read_floats(index, wanted_components, rule))
        .first->second;
}

const std::vector<float>& GltfAccessors::floats(int index, int wanted_components) {
    return cached(index, wanted_components, NotFinite::is_error);
}

const std::vector<float>& GltfAccessors::optional_floats(int index, int wanted_components) {
    return cached(index, wanted_components, NotFinite::is_zero);
}

std::vector<float> GltfAccessors::take_floats(int index, int wanted_components) {
    return read_floats(index, wanted_components, NotFinite::is_error);
}

std::vector<std::uint32_t> GltfAccessors::indices(int index) {
    const auto& accessor = at(index);
    if (components(index) != 1 || !is_unsigned(accessor.componentType))
        fail(index, "holds no indices: scalars of an unsigned type");
    return unsigned_numbers(packed_elements(index), accessor.componentType);
}

void GltfAccessors::keep_only(std::span<const int> accessors) {
    std::erase_if(floats_, [&](const auto& entry) {
        return std::ranges::find(accessors, entry.first) == accessors.end();
    });
}

}  // namespace bake
