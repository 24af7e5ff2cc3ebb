#pragma once

// An accessor: `count` elements of one to sixteen numbers in a buffer view, some replaced by a sparse list. This is
// the reader's only access to binary numbers. Its constructor checks every offset, stride, count and length in 64
// bits against the actual bytes before anything is allocated.
//
// Source: glTF 2.0 sections 3.6.2 (accessors, sparse ones, data alignment) and 3.11 (normalised integers).

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include "formats/gltf/buffers.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "math/vec4.h"

namespace pertev::gltf {

enum class ComponentType : uint16_t {
    Int8 = 5120,
    UInt8 = 5121,
    Int16 = 5122,
    UInt16 = 5123,
    UInt32 = 5125,
    Float = 5126
};

/// Number of components of an element of accessor.type.
enum class ElementType : uint8_t { Scalar = 1, Vec2 = 2, Vec3 = 3, Vec4 = 4, Mat4 = 16 };

class Accessor {
public:
    /// The accessor with the index `reference`. Throws Error(BadInput) if its element type is not one of `expected`
    /// or any part of it exceeds its data.
    Accessor(const Document& document, Buffers& buffers, const JsonValue& reference,
             std::initializer_list<ElementType> expected);

    uint64_t count() const { return count_; }
    ElementType element_type() const { return element_type_; }
    ComponentType component_type() const { return component_type_; }
    bool is_normalized() const { return is_normalized_; }

    /// Components of all elements, one element after the other; integers are unscaled, or scaled to [-1, 1] or [0, 1]
    /// if the accessor is normalised.
    std::vector<float> read_floats() const;
    /// Components of integer types, never scaled; Error(BadInput) for other types.
    std::vector<uint32_t> read_integers() const;
    // Elements as vectors; the element type must match.
    std::vector<Vec2> read_vec2() const;
    std::vector<Vec3> read_vec3() const;
    std::vector<Vec4> read_vec4() const;

private:
    struct Sparse {
        std::vector<uint64_t> indices; // each < count_
        std::span<const std::byte> values;
    };
    void set_types(const JsonValue& accessor, std::initializer_list<ElementType> expected);
    void set_dense(const JsonValue& accessor, Buffers& buffers);
    void set_sparse(const JsonValue& sparse, Buffers& buffers);
    uint64_t element_bytes() const;
    template <class Out>
    void read(Out* out) const;
    template <class Vector>
    std::vector<Vector> read_vectors() const;

    Buffers& buffers_;
    JsonValue reference_; // the reference to the accessor, for messages
    ElementType element_type_ = ElementType::Scalar;
    ComponentType component_type_ = ComponentType::Float;
    bool is_normalized_ = false;
    uint64_t count_ = 0;
    std::span<const std::byte> dense_; // empty: zeros
    uint64_t stride_ = 0;
    std::optional<Sparse> sparse_;
};

} // namespace pertev::gltf
