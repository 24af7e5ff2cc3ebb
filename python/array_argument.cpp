#include "python/array_argument.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/string.h>

#include "base/error.h"
#include "python/unlocked.h"

namespace nb = nanobind;

namespace pertev {
namespace {

using Code = nb::dlpack::dtype_code;

std::string text_of_shape(std::span<const std::size_t> shape) {
    std::vector<std::string> lengths;
    for (const std::size_t length : shape) {
        lengths.push_back(length == ArrayArgument::kAny ? "N" : fmt::format("{}", length));
    }
    return fmt::format("({}{})", fmt::join(lengths, ", "), lengths.size() == 1 ? "," : "");
}

/// Calls `visit` for the offset of each element, in the order of C.
template <class Visit>
void for_each_offset(const nb::ndarray<nb::ro>& array, std::size_t axis, int64_t offset, const Visit& visit) {
    if (axis == array.ndim()) return visit(offset);
    for (std::size_t i = 0; i < array.shape(axis); ++i) {
        for_each_offset(array, axis + 1, offset + static_cast<int64_t>(i) * array.stride(axis), visit);
    }
}

/// IEEE half precision.
struct Half {
    uint16_t bits;
    explicit operator double() const {
        const int exponent = bits >> 10 & 31, fraction = bits & 1023;
        const double size = exponent == 0    ? std::ldexp(fraction, -24)
                            : exponent == 31 ? (fraction == 0 ? std::numeric_limits<double>::infinity()
                                                              : std::numeric_limits<double>::quiet_NaN())
                                             : std::ldexp(1024 + fraction, exponent - 25);
        return (bits & 0x8000) != 0 ? -size : size;
    }
};

/// Returns an array of NumPy with numbers in the byte order of the machine, and long doubles as float64, as DLPack has
/// them.
nb::object in_native_type(const nb::object& array) {
    const nb::object dtype = array.attr("dtype");
    const auto kind = nb::cast<std::string>(dtype.attr("kind"));
    if (kind != "f" && kind != "i" && kind != "u") return array;
    const bool is_long = nb::cast<std::size_t>(dtype.attr("itemsize")) > sizeof(double);
    const nb::object type = is_long ? nb::str("f8") : nb::object(dtype.attr("newbyteorder")("="));
    return array.attr("astype")(type, nb::arg("copy") = false);
}

} // namespace

ArrayArgument::ArrayArgument(nb::handle value, std::string name) : name_(std::move(name)) {
    if (!nb::try_cast(value, array_)) {
        try {
            const nb::object made = in_native_type(nb::module_::import_("numpy").attr("asarray")(value));
            if (!nb::try_cast(made, array_)) {
                const nb::str dtype(nb::object(made.attr("dtype")));
                fail(fmt::format("{} of {} is not an array of numbers", nb::type_name(value.type()).c_str(),
                                 dtype.c_str()));
            }
        } catch (nb::python_error& error) {
            fail(fmt::format("not an array of numbers: {}", error.what()));
        }
    }
    if (array_.device_type() == nb::device::cpu::value) return;
    const nb::object on_host = nb::module_::import_("pertev._arrays").attr("on_host")(value);
    if (!nb::try_cast(on_host, array_) || array_.device_type() != nb::device::cpu::value)
        fail("the array is not in the CPU's memory; copy it there");
}

void ArrayArgument::fail(const std::string& why) const { throw Error(ErrorCode::BadInput, name_, "", why); }

bool ArrayArgument::has_shape(std::initializer_list<std::size_t> shape) const {
    if (axes() != shape.size()) return false;
    std::size_t axis = 0;
    for (const std::size_t length : shape) {
        if (length != kAny && length != array_.shape(axis)) return false;
        ++axis;
    }
    return true;
}

const ArrayArgument& ArrayArgument::of_shape(std::initializer_list<std::size_t> shape) const {
    if (has_shape(shape)) return *this;
    std::vector<std::size_t> own;
    for (std::size_t axis = 0; axis < axes(); ++axis) own.push_back(array_.shape(axis));
    fail(fmt::format("the array's shape is {}; expected {}", text_of_shape(own),
                     text_of_shape({shape.begin(), shape.size()})));
}

bool ArrayArgument::is_uint8() const { return array_.dtype() == nb::dtype<uint8_t>(); }

bool ArrayArgument::is_whole() const {
    const auto code = static_cast<Code>(array_.dtype().code);
    return code == Code::Int || code == Code::UInt;
}

template <class From, class To>
std::vector<To> ArrayArgument::values_of() const {
    std::vector<To> values;
    // A short copy keeps the interpreter's lock, because another thread may hold it for milliseconds.
    std::optional<Unlocked> unlocked;
    if (array_.size() >= 1 << 16) unlocked.emplace();
    values.reserve(array_.size());
    const From* const from = static_cast<const From*>(array_.data());
    for_each_offset(array_, 0, 0, [&](int64_t offset) {
        if constexpr (std::is_same_v<From, Half>) {
            values.push_back(static_cast<To>(static_cast<double>(from[offset])));
        } else {
            values.push_back(static_cast<To>(from[offset]));
        }
    });
    return values;
}

template <class To>
std::vector<To> ArrayArgument::values() const {
    const nb::dlpack::dtype type = array_.dtype();
    const bool is_float = static_cast<Code>(type.code) == Code::Float,
               is_signed = static_cast<Code>(type.code) == Code::Int;
    if (type.lanes == 1 && is_float) {
        if (type.bits == 16) return values_of<Half, To>();
        if (type.bits == 32) return values_of<float, To>();
        if (type.bits == 64) return values_of<double, To>();
    }
    if (type.lanes == 1 && is_whole()) {
        if (type.bits == 8) return is_signed ? values_of<int8_t, To>() : values_of<uint8_t, To>();
        if (type.bits == 16) return is_signed ? values_of<int16_t, To>() : values_of<uint16_t, To>();
        if (type.bits == 32) return is_signed ? values_of<int32_t, To>() : values_of<uint32_t, To>();
        if (type.bits == 64) return is_signed ? values_of<int64_t, To>() : values_of<uint64_t, To>();
    }
    fail("the array's dtype is not numeric; expected floats or integers");
}

std::vector<float> ArrayArgument::floats() const { return values<float>(); }
std::vector<double> ArrayArgument::doubles() const { return values<double>(); }
std::vector<uint8_t> ArrayArgument::bytes() const { return values<uint8_t>(); }

std::vector<uint32_t> ArrayArgument::indices(std::size_t end) const {
    if (!is_whole()) fail("the array's dtype is not an integer type");
    std::vector<uint32_t> found;
    found.reserve(array_.size());
    const auto take = [&](auto index) {
        if (std::cmp_less(index, 0) || std::cmp_greater_equal(index, end)) {
            fail(fmt::format("{} is out of range; expected whole numbers from 0 to {}", index,
                             static_cast<int64_t>(end) - 1));
        }
        found.push_back(static_cast<uint32_t>(index));
    };
    if (static_cast<Code>(array_.dtype().code) == Code::UInt) {
        for (const uint64_t index : values<uint64_t>()) take(index);
    } else {
        for (const int64_t index : values<int64_t>()) take(index);
    }
    return found;
}

const ArrayArgument& ArrayArgument::of_finite_numbers() const {
    const std::vector<double> all = doubles();
    const auto bad = std::ranges::find_if(all, [](double number) { return !std::isfinite(number); });
    if (bad == all.end()) return *this;
    std::string indices; // such as "1, 0, 3"
    auto rest = static_cast<std::size_t>(bad - all.begin());
    for (std::size_t axis = axes(); axis-- > 0; rest /= length(axis))
        indices = fmt::format("{}{}{}", rest % length(axis), indices.empty() ? "" : ", ", indices);
    fail(axes() == 0 ? fmt::format("expected a finite number, not {}", *bad)
                     : fmt::format("expected finite numbers; [{}] is {}", indices, *bad));
}

} // namespace pertev
