#pragma once

// One value of a JSON document together with where it stands, so that every error can name its file and JSON pointer.
// All readings are checked: a value of another type or out of range is an Error(BadInput). A member that is null counts
// as one that is not there, and a null where an object is expected as one without members.
//
// A JsonValue is a view: the document that it comes from must outlive it.

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simdjson.h>

#include "base/error.h"

namespace pertev::gltf {

class JsonValue {
public:
    /// `file` names the source in messages and must outlive the value; the whole document has the pointer "".
    JsonValue(const std::string& file, std::string pointer, simdjson::dom::element element)
        : file_(&file), pointer_(std::move(pointer)), element_(element) {}

    /// RFC 6901: where in the document it stands; "" is all of it.
    const std::string& pointer() const { return pointer_; }
    Place place() const { return {.file = *file_, .pointer = pointer_}; }
    /// Error(BadInput) of this place.
    Error error(const std::string& what) const;
    /// `cause` of a file that this value names, at this place.
    Error error(const Error& cause) const;

    /// Member of an object; nothing when it has none of that name, or null.
    std::optional<JsonValue> find(std::string_view key) const;
    JsonValue at(std::string_view key) const;
    /// /extensions/NAME of an object.
    std::optional<JsonValue> extension(std::string_view name) const;
    /// Every member, with its name, of an object "extensions" anywhere in this value, "extras" left out, whose name
    /// `is_wanted`.
    std::vector<std::pair<std::string, JsonValue>>
    extensions_within(const std::function<bool(std::string_view)>& is_wanted) const;
    /// All values of an array, in order.
    std::vector<JsonValue> elements() const;
    /// The values of member `key`, an array; none when it is missing.
    std::vector<JsonValue> elements_of(std::string_view key) const;

    /// Returns all members of an object with their names, in order.
    std::vector<std::pair<std::string, JsonValue>> members() const;

    /// A whole number in [0, 2^53], also when written as 3.0.
    uint64_t to_unsigned() const;
    /// A number; one beyond the largest float, as some exporters write for "no limit", becomes the largest float.
    float to_float() const;
    /// The same number, not rounded to a float.
    double to_double() const;
    bool to_bool() const;
    std::string_view to_string() const;
    /// `count` numbers.
    template <std::size_t count>
    std::array<float, count> to_floats() const {
        std::array<float, count> numbers{};
        read_floats(numbers.data(), count);
        return numbers;
    }
    template <std::size_t count>
    std::array<double, count> to_doubles() const {
        std::array<double, count> numbers{};
        read_doubles(numbers.data(), count);
        return numbers;
    }
    /// The value as JSON text without spaces: equal texts are equal values.
    std::string to_json() const;

    // Member `key`, or a default where it is missing.
    uint64_t unsigned_or(std::string_view key, uint64_t fallback) const;
    float float_or(std::string_view key, float fallback) const;
    bool bool_or(std::string_view key, bool fallback) const;
    std::string string_or(std::string_view key, std::string_view fallback) const;
    template <std::size_t count>
    std::array<float, count> floats_or(std::string_view key, std::array<float, count> fallback) const {
        const std::optional<JsonValue> member = find(key);
        return member ? member->to_floats<count>() : fallback;
    }

    template <std::size_t count>
    std::array<double, count> doubles_or(std::string_view key, std::array<double, count> fallback) const {
        const std::optional<JsonValue> member = find(key);
        return member ? member->to_doubles<count>() : fallback;
    }

private:
    void read_floats(float* numbers, std::size_t count) const;
    void read_doubles(double* numbers, std::size_t count) const;
    JsonValue child(std::string_view key, simdjson::dom::element element) const;

    const std::string* file_;
    std::string pointer_;
    simdjson::dom::element element_;
};

} // namespace pertev::gltf
