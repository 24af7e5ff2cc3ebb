#pragma once

// An array that Python gives: of NumPy or of anything with DLPack or the buffer protocol, also on a GPU, and lists of
// numbers. It is copied; its dtype, shape and device are checked, and errors name the argument. All functions need the
// interpreter's lock.

#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace pertev {

class ArrayArgument {
public:
    /// Throws Error(BadInput) with the argument's name as the setting, as all functions here do.
    ArrayArgument(nanobind::handle value, std::string name);

    static constexpr std::size_t kAny = SIZE_MAX;
    /// Checks the shape, in which kAny stands for any length.
    const ArrayArgument& of_shape(std::initializer_list<std::size_t> shape) const;
    bool has_shape(std::initializer_list<std::size_t> shape) const;
    /// Checks that no number is infinite or NaN.
    const ArrayArgument& of_finite_numbers() const;
    std::size_t length(std::size_t axis) const { return array_.shape(axis); }
    std::size_t axes() const { return array_.ndim(); }
    bool is_uint8() const;
    bool is_whole() const; // integers of any size

    /// Returns the values in the order of C. Floats are float16, float32, float64 or integers.
    std::vector<float> floats() const;
    std::vector<double> doubles() const;
    std::vector<uint8_t> bytes() const;
    /// Returns whole numbers, each below `end`.
    std::vector<uint32_t> indices(std::size_t end) const;

    [[noreturn]] void fail(const std::string& why) const;

private:
    template <class To>
    std::vector<To> values() const;
    template <class From, class To>
    std::vector<To> values_of() const;

    nanobind::ndarray<nanobind::ro> array_;
    std::string name_;
};

} // namespace pertev
