#pragma once

// The fields of an object that Python describes by a dictionary. Errors name the path of the field, such as
// "lights/lamp/position", as the setting. Needs the interpreter's lock.

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "math/double_vec3.h"
#include "math/rgb.h"
#include "python/array_argument.h"

namespace pertev {

[[noreturn]] inline void refuse_argument(const std::string& path, const std::string& why) {
    throw Error(ErrorCode::BadInput, path, "", why);
}

inline std::string text_argument(nanobind::handle value, const std::string& path) {
    if (!nanobind::isinstance<nanobind::str>(value))
        refuse_argument(path, fmt::format("expected a text, not {}", nanobind::type_name(value.type()).c_str()));
    Py_ssize_t size = 0;
    const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
    if (text == nullptr) {
        PyErr_Clear();
        refuse_argument(path, "expected a text of Unicode");
    }
    const std::string_view whole(text, static_cast<std::size_t>(size));
    if (whole.find('\0') != std::string_view::npos) refuse_argument(path, "the text has a null character");
    return std::string(whole);
}

/// The fields of one object. Each is taken once, and what is left over is an error.
class ArgumentFields {
public:
    ArgumentFields(nanobind::handle values, std::string path) : path_(std::move(path)) {
        if (!nanobind::isinstance<nanobind::dict>(values)) refuse_argument(path_, "expected a dictionary");
        values_ = nanobind::borrow<nanobind::dict>(values);
    }
    const std::string& path() const { return path_; }
    std::string path_of(const char* field) const { return path_ + "/" + field; }

    /// Returns a field that is there and not None.
    std::optional<nanobind::object> take(const char* field) {
        known_.push_back(field);
        if (!values_.contains(field) || values_[field].is_none()) return std::nullopt;
        return nanobind::borrow(values_[field]);
    }
    std::optional<ArrayArgument> array(const char* field) {
        const auto value = take(field);
        return value ? std::optional(ArrayArgument(*value, path_of(field))) : std::nullopt;
    }
    ArrayArgument needed(const char* field) {
        auto value = array(field);
        if (!value) refuse_argument(path_of(field), "the field is missing");
        return std::move(*value);
    }
    std::string text(const char* field, const std::string& otherwise) {
        const auto value = take(field);
        return value ? text_argument(*value, path_of(field)) : otherwise;
    }
    /// Returns the numbers of a field that is there, which numbers() then has.
    std::optional<std::vector<double>> finite(const char* field, std::initializer_list<std::size_t> shape) {
        const auto given = array(field);
        if (!given) return std::nullopt;
        return numbers_.emplace_back(field, given->of_shape(shape).of_finite_numbers().doubles()).second;
    }
    /// The numbers of all fields that are no arrays of a mesh or an image.
    const std::vector<std::pair<std::string, std::vector<double>>>& numbers() const { return numbers_; }
    void number(const char* field, float& value) {
        if (const auto given = finite(field, {})) value = static_cast<float>(given->front());
    }
    void flag(const char* field, bool& value) {
        const auto given = take(field);
        if (given && !nanobind::isinstance<nanobind::bool_>(*given))
            refuse_argument(path_of(field), "expected True or False");
        if (given) value = nanobind::cast<bool>(*given);
    }
    void vector(const char* field, Vec3& value) {
        const auto given = finite(field, {3});
        if (!given) return;
        value = {static_cast<float>((*given)[0]), static_cast<float>((*given)[1]), static_cast<float>((*given)[2])};
    }
    void color(const char* field, Rgb& value) {
        Vec3 v = {value.r, value.g, value.b};
        vector(field, v);
        value = {v.x, v.y, v.z};
    }
    std::optional<DoubleVec3> point(const char* field) {
        const auto given = finite(field, {3});
        return given ? std::optional(DoubleVec3{(*given)[0], (*given)[1], (*given)[2]}) : std::nullopt;
    }
    std::optional<std::vector<double>> transform(const char* field) {
        const auto values = finite(field, {4, 4});
        const double last[] = {0, 0, 0, 1};
        if (values && !std::equal(last, last + 4, values->begin() + 12))
            refuse_argument(path_of(field), "expected 0, 0, 0, 1 as the last row");
        return values;
    }
    /// Returns the index of a text among names.
    uint32_t one_of(const char* field, const std::string& otherwise, std::initializer_list<const char*> names) {
        const std::string value = text(field, otherwise);
        const auto found = std::ranges::find(names, value);
        if (found == names.end()) {
            throw Error(ErrorCode::BadInput, path_of(field), value,
                        fmt::format("expected one of {}", fmt::join(names, ", ")));
        }
        return static_cast<uint32_t>(found - names.begin());
    }
    void refuse_others() const {
        for (const auto& [key, value] : values_) {
            const std::string name = text_argument(key, path_);
            if (std::ranges::find(known_, name) != known_.end()) continue;
            refuse_argument(path_ + "/" + name,
                            fmt::format("unknown field; the fields are {}", fmt::join(known_, ", ")));
        }
    }

private:
    nanobind::dict values_;
    std::string path_;
    std::vector<std::string> known_;
    std::vector<std::pair<std::string, std::vector<double>>> numbers_;
};

} // namespace pertev
