#include "formats/gltf/accessor.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>

#include <fmt/format.h>

namespace pertev::gltf {
namespace {

std::string_view name_of(ElementType type) {
    switch (type) {
    case ElementType::Scalar:
        return "SCALAR";
    case ElementType::Vec2:
        return "VEC2";
    case ElementType::Vec3:
        return "VEC3";
    case ElementType::Vec4:
        return "VEC4";
    case ElementType::Mat4:
        return "MAT4";
    }
    return "";
}

uint64_t components_of(ElementType type) { return static_cast<uint64_t>(type); }

ComponentType component_type_of(const JsonValue& value) {
    const uint64_t number = value.to_unsigned();
    for (const ComponentType type : {ComponentType::Int8, ComponentType::UInt8, ComponentType::Int16,
                                     ComponentType::UInt16, ComponentType::UInt32, ComponentType::Float}) {
        if (number == static_cast<uint64_t>(type)) return type;
    }
    throw value.error(fmt::format("component type {}; expected 5120, 5121, 5122, 5123, 5125 or 5126", number));
}

// Throws unless `count` elements of `size` bytes, `stride` apart, from `offset` on lie within `available` bytes.
void check_range(const JsonValue& json, uint64_t offset, uint64_t count, uint64_t size, uint64_t stride,
                 uint64_t available) {
    if (stride < size) throw json.error(fmt::format("elements of {} bytes lie {} bytes apart", size, stride));
    if (count == 0) return;
    const bool first_fits = offset <= available && size <= available - offset;
    if (!first_fits || count - 1 > (available - offset - size) / stride) {
        throw json.error(
            fmt::format("{} elements of {} bytes, {} apart, from byte {} exceed the buffer view of {} bytes", count,
                        size, stride, offset, available));
    }
}

// Section 3.11: -128 and -127 are both -1, so that 0 is exact.
template <class In>
float to_float(In value, bool is_normalized) {
    if constexpr (std::is_floating_point_v<In>) return value;
    const float number = static_cast<float>(value);
    if (!is_normalized) return number;
    constexpr float largest = static_cast<float>(std::numeric_limits<In>::max());
    return std::max(number / largest, -1.0f);
}

template <class In, class Out>
void copy_element(const std::byte* from, uint64_t components, bool is_normalized, Out* out) {
    for (uint64_t c = 0; c < components; ++c) {
        In value;
        std::memcpy(&value, from + c * sizeof(In), sizeof(In)); // files promise no alignment worth relying on
        if constexpr (std::is_same_v<Out, float>)
            out[c] = to_float(value, is_normalized);
        else
            out[c] = static_cast<Out>(value);
    }
}

// Calls visit with a value of the C++ type that holds a component.
template <class Visit>
void with_type(ComponentType type, const Visit& visit) {
    switch (type) {
    case ComponentType::Int8:
        return visit(int8_t());
    case ComponentType::UInt8:
        return visit(uint8_t());
    case ComponentType::Int16:
        return visit(int16_t());
    case ComponentType::UInt16:
        return visit(uint16_t());
    case ComponentType::UInt32:
        return visit(uint32_t());
    case ComponentType::Float:
        return visit(float());
    }
}

uint64_t bytes_of(ComponentType type) {
    uint64_t bytes = 0;
    with_type(type, [&](auto component) { bytes = sizeof component; });
    return bytes;
}

} // namespace

Accessor::Accessor(const Document& document, Buffers& buffers, const JsonValue& reference,
                   std::initializer_list<ElementType> expected)
    : buffers_(buffers), reference_(reference) {
    const JsonValue& accessor = document.item("accessors", reference);
    set_types(accessor, expected);
    count_ = accessor.at("count").to_unsigned();
    if (const auto bytes = buffers.put_bytes(document.index_into("accessors", reference))) {
        dense_ = *bytes;
        stride_ = element_bytes();
        check_range(accessor, 0, count_, stride_, stride_, bytes->size());
    } else {
        set_dense(accessor, buffers);
    }
    if (const std::optional<JsonValue> sparse = accessor.find("sparse")) set_sparse(*sparse, buffers);
}

void Accessor::set_types(const JsonValue& accessor, std::initializer_list<ElementType> expected) {
    const std::string_view type = accessor.at("type").to_string();
    std::string wanted;
    bool found = false;
    for (const ElementType candidate : expected) {
        if (type == name_of(candidate)) {
            element_type_ = candidate;
            found = true;
        }
        wanted += fmt::format("{}{}", wanted.empty() ? "" : " or ", name_of(candidate));
    }
    if (!found) throw reference_.error(fmt::format("the accessor's type is {}; expected {}", type, wanted));
    component_type_ = component_type_of(accessor.at("componentType"));
    is_normalized_ = accessor.bool_or("normalized", false) && component_type_ != ComponentType::Float;
}

uint64_t Accessor::element_bytes() const { return components_of(element_type_) * bytes_of(component_type_); }

void Accessor::set_dense(const JsonValue& accessor, Buffers& buffers) {
    const std::optional<JsonValue> reference = accessor.find("bufferView");
    if (!reference) { // zeros: no data that would bound the count
        if (count_ <= buffers.file_bytes()) return;
        throw accessor.error(fmt::format("{} elements without a buffer view, in files of {} bytes; expected no more "
                                         "elements than bytes",
                                         count_, buffers.file_bytes()));
    }
    const BufferView view = buffers.view(*reference);
    const uint64_t offset = accessor.unsigned_or("byteOffset", 0);
    stride_ = view.stride == 0 ? element_bytes() : view.stride;
    check_range(accessor, offset, count_, element_bytes(), stride_, view.bytes.size());
    if (count_ > 0) dense_ = view.bytes.subspan(offset);
}

void Accessor::set_sparse(const JsonValue& sparse, Buffers& buffers) {
    const uint64_t count = sparse.at("count").to_unsigned();
    const JsonValue indices = sparse.at("indices"), values = sparse.at("values");
    const ComponentType type = component_type_of(indices.at("componentType"));
    if (type != ComponentType::UInt8 && type != ComponentType::UInt16 && type != ComponentType::UInt32) {
        throw indices.error("componentType must be 5121, 5123 or 5125");
    }
    const auto part = [&](const JsonValue& json, uint64_t size) {
        const BufferView view = buffers.view(json.at("bufferView"));
        const uint64_t offset = json.unsigned_or("byteOffset", 0);
        check_range(json, offset, count, size, size, view.bytes.size());
        return count > 0 ? view.bytes.subspan(offset, count * size) : std::span<const std::byte>();
    };
    const std::span<const std::byte> index_bytes = part(indices, bytes_of(type));
    buffers.charge(count * sizeof(uint64_t), sparse);
    Sparse list;
    list.values = part(values, element_bytes());
    list.indices.resize(count);
    for (uint64_t i = 0; i < count; ++i) {
        with_type(type, [&](auto sample) {
            using In = decltype(sample);
            copy_element<In>(index_bytes.data() + i * sizeof(In), 1, false, &list.indices[i]);
        });
        if (list.indices[i] >= count_) {
            throw indices.error(
                fmt::format("entry {} is {}; expected less than the accessor's count, {}", i, list.indices[i], count_));
        }
    }
    sparse_ = std::move(list);
}

template <class Out>
void Accessor::read(Out* out) const {
    const uint64_t components = components_of(element_type_);
    with_type(component_type_, [&](auto sample) {
        using In = decltype(sample);
        if (!dense_.empty()) {
            for (uint64_t i = 0; i < count_; ++i) {
                copy_element<In>(dense_.data() + i * stride_, components, is_normalized_, out + i * components);
            }
        }
        if (!sparse_) return;
        for (uint64_t i = 0; i < sparse_->indices.size(); ++i) {
            copy_element<In>(sparse_->values.data() + i * components * sizeof(In), components, is_normalized_,
                             out + sparse_->indices[i] * components);
        }
    });
}

std::vector<float> Accessor::read_floats() const {
    const uint64_t numbers = count_ * components_of(element_type_);
    buffers_.charge(numbers * sizeof(float), reference_);
    std::vector<float> out(numbers);
    read(out.data());
    return out;
}

std::vector<uint32_t> Accessor::read_integers() const {
    if (component_type_ == ComponentType::Float || component_type_ == ComponentType::Int8 ||
        component_type_ == ComponentType::Int16) {
        throw reference_.error("the accessor's component type is signed or a float; expected 5121, 5123 or 5125");
    }
    const uint64_t numbers = count_ * components_of(element_type_);
    buffers_.charge(numbers * sizeof(uint32_t), reference_);
    std::vector<uint32_t> out(numbers);
    read(out.data());
    return out;
}

template <class Vector>
std::vector<Vector> Accessor::read_vectors() const {
    constexpr uint64_t numbers = sizeof(Vector) / sizeof(float);
    static_assert(std::is_standard_layout_v<Vector> && numbers * sizeof(float) == sizeof(Vector));
    PERTEV_CHECK(numbers == components_of(element_type_));
    buffers_.charge(count_ * sizeof(Vector), reference_);
    std::vector<Vector> out(count_);
    if (count_ > 0) read(&out[0].x);
    return out;
}

std::vector<Vec2> Accessor::read_vec2() const { return read_vectors<Vec2>(); }
std::vector<Vec3> Accessor::read_vec3() const { return read_vectors<Vec3>(); }
std::vector<Vec4> Accessor::read_vec4() const { return read_vectors<Vec4>(); }

} // namespace pertev::gltf
