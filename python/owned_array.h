#pragma once

// A NumPy array that owns its values.

#include <initializer_list>
#include <vector>

#include <nanobind/ndarray.h>

namespace pertev {

/// Returns an array of this shape; `values` are in the order of C.
template <class Value>
nanobind::object owned_array(std::vector<Value> values, const std::vector<std::size_t>& shape) {
    auto* const kept = new std::vector<Value>(std::move(values));
    const nanobind::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Value>*>(p); });
    return nanobind::cast(nanobind::ndarray<nanobind::numpy, Value>(kept->data(), shape.size(), shape.data(), owner));
}

} // namespace pertev
