#include "scene/gltf_accessor.h"

#include "base/check.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace gnomon::scene {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF's bytes are copied as they are");

// Elements in their bytes, with bounds already checked.
struct ElementView {
    const std::uint8_t* bytes = nullptr;  // nullptr: all elements are zero
    std::size_t stride = 0;
};

std::size_t component_bytes(int accessor, int component_type) {
    switch (component_type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            fail_input("accessors[{}]: has components of the unknown type {}", accessor,
                       component_type);
    }
}

template <typename T>
T load(const std::uint8_t* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

// glTF 2.0, 3.6.2.2 and the table of KHR_mesh_quantization.
float component_as_float(const std::uint8_t* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const auto value = static_cast<float>(load<std::int8_t>(bytes));
            return normalized ? std::max(value / 127.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const auto value = static_cast<float>(*bytes);
            return normalized ? value / 255.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const auto value = static_cast<float>(load<std::int16_t>(bytes));
            return normalized ? std::max(value / 32767.0f, -1.0f) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const auto value = static_cast<float>(load<std::uint16_t>(bytes));
            return normalized ? value / 65535.0f : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return static_cast<float>(load<std::uint32_t>(bytes));
        default:
            return load<float>(bytes);
    }
}

std::uint32_t component_as_integer(const std::uint8_t* bytes, std::size_t size) {
    switch (size) {
        case 1:
            return *bytes;
        case 2:
            return load<std::uint16_t>(bytes);
        default:
            return load<std::uint32_t>(bytes);
    }
}

// `count` elements of `element_bytes` from `offset` in a buffer view.
ElementView checked_view(GltfDocument& document, int accessor, int buffer_view, std::size_t offset,
                         std::size_t count, std::size_t element_bytes) {
    const std::span<const std::uint8_t> bytes = document.buffer_view(buffer_view);
    const std::size_t given =
        document.model().bufferViews[static_cast<std::size_t>(buffer_view)].byteStride;
    const std::size_t stride = given == 0 ? element_bytes : given;
    if (stride < element_bytes) {
        fail_input("accessors[{}]: its elements have {} bytes, but bufferViews[{}] a stride of {}",
                   accessor, element_bytes, buffer_view, stride);
    }
    // count and stride are below 2^31 and 2^8: no overflow.
    const std::size_t needed = count == 0 ? 0 : (count - 1) * stride + element_bytes;
    if (offset > bytes.size() || needed > bytes.size() - offset) {
        fail_input("accessors[{}]: needs {} bytes from {} on of bufferViews[{}], which has {}",
                   accessor, needed, offset, buffer_view, bytes.size());
    }
    return {bytes.data() + offset, stride};
}

struct Layout {
    const tinygltf::Accessor* accessor = nullptr;
    std::size_t components = 0, component_bytes = 0;
    std::size_t element_bytes() const { return components * component_bytes; }
};

Layout layout_of(const GltfDocument& document, int index) {
    const tinygltf::Accessor& accessor =
        document.model().accessors[static_cast<std::size_t>(index)];
    return {&accessor, static_cast<std::size_t>(accessor_components(document, index)),
            component_bytes(index, accessor.componentType)};
}

// Calls store(element, bytes) for every element that has bytes, sparse replacements last.
template <typename Store>
void for_each_element(GltfDocument& document, int index, const Layout& layout, const Store& store) {
    const tinygltf::Accessor& accessor = *layout.accessor;
    const std::size_t size = layout.element_bytes();
    if (accessor.bufferView >= 0) {
        const ElementView view = checked_view(document, index, accessor.bufferView,
                                              accessor.byteOffset, accessor.count, size);
        for (std::size_t i = 0; i < accessor.count; ++i)
            store(i, view.bytes + i * view.stride);
    }
    if (!accessor.sparse.isSparse) return;
    const auto& sparse = accessor.sparse;
    const auto count = static_cast<std::size_t>(sparse.count);
    const std::size_t index_bytes = component_bytes(index, sparse.indices.componentType);
    const ElementView indices =
        checked_view(document, index, sparse.indices.bufferView,
                     static_cast<std::size_t>(sparse.indices.byteOffset), count, index_bytes);
    const ElementView values =
        checked_view(document, index, sparse.values.bufferView,
                     static_cast<std::size_t>(sparse.values.byteOffset), count, size);
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t element =
            component_as_integer(indices.bytes + i * indices.stride, index_bytes);
        if (element >= accessor.count) {
            fail_input("accessors[{}]: its sparse index {} is {}, but it has {} elements", index, i,
                       element, accessor.count);
        }
        store(element, values.bytes + i * values.stride);
    }
}

void require_components(int index, int has, int wanted) {
    if (wanted != 0 && has != wanted) {
        fail_input("accessors[{}]: has {} numbers an element where {} are needed", index, has,
                   wanted);
    }
}

}  // namespace

std::size_t accessor_count(const GltfDocument& document, int accessor) {
    return document.model().accessors[static_cast<std::size_t>(accessor)].count;
}

int accessor_components(const GltfDocument& document, int accessor) {
    return tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(
        document.model().accessors[static_cast<std::size_t>(accessor)].type));
}

std::vector<float> read_floats(GltfDocument& document, int accessor, int components) {
    const Layout layout = layout_of(document, accessor);
    require_components(accessor, static_cast<int>(layout.components), components);
    // Columns of small matrices are padded to four bytes; nothing that is read has such.
    if (layout.components >= 4 && layout.component_bytes < 4 &&
        layout.accessor->type >= TINYGLTF_TYPE_MAT2 &&
        layout.accessor->type <= TINYGLTF_TYPE_MAT4) {
        fail_input("accessors[{}]: is a matrix of small integers", accessor);
    }
    const std::size_t size = layout.accessor->count * layout.components;
    document.spend(size * sizeof(float));
    std::vector<float> values(size, 0.0f);
    const int type = layout.accessor->componentType;
    const bool normalized = layout.accessor->normalized;
    for_each_element(document, accessor, layout, [&](std::size_t i, const std::uint8_t* bytes) {
        float* target = values.data() + i * layout.components;
        for (std::size_t c = 0; c < layout.components; ++c) {
            target[c] = component_as_float(bytes + c * layout.component_bytes, type, normalized);
        }
    });
    return values;
}

std::vector<std::uint32_t> read_integers(GltfDocument& document, int accessor, int components) {
    const Layout layout = layout_of(document, accessor);
    require_components(accessor, static_cast<int>(layout.components), components);
    const int type = layout.accessor->componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        fail_input("accessors[{}]: must hold unsigned integers", accessor);
    }
    const std::size_t size = layout.accessor->count * layout.components;
    document.spend(size * sizeof(std::uint32_t));
    std::vector<std::uint32_t> values(size, 0);
    for_each_element(document, accessor, layout, [&](std::size_t i, const std::uint8_t* bytes) {
        std::uint32_t* target = values.data() + i * layout.components;
        for (std::size_t c = 0; c < layout.components; ++c) {
            target[c] =
                component_as_integer(bytes + c * layout.component_bytes, layout.component_bytes);
        }
    });
    return values;
}

}  // namespace gnomon::scene
