#pragma once

// A value of a JSON document with its location, so that every error can name its file and JSON pointer. All
// conversions are checked: a value of another type or out of range throws Error(BadInput). A null member counts as
// absent, and a null where an object is expected as an empty object.
//
// A JsonValue is a view; its document must outlive it.

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

    /// Location in the document, RFC 6901; "" is the whole document.
    const std::string& pointer() const { return pointer_; }
    FileLocation location() const { return {.file = *file_, .pointer = pointer_}; }
    /// Makes an Error(BadInput) with this location.
    Error error(const std::string& what) const;
    /// Makes an error with `cause`, of a file that this value names, and this location.
    Error error(const Error& cause) const;

    /// Member of an object; nothing if it is absent or null.
    std::optional<JsonValue> find(std::string_view key) const;
    JsonValue at(std::string_view key) const;
    /// Member /extensions/NAME of an object; nothing if it is absent.
    std::optional<JsonValue> extension(std::string_view name) const;
    /// Returns the members of all objects "extensions" in this value, except those in "extras", whose names satisfy
    /// `is_wanted`, with their names.
    std::vector<std::pair<std::string, JsonValue>>
    extensions_within(const std::function<bool(std::string_view)>& is_wanted) const;
    /// All values of an array, in order.
    std::vector<JsonValue> elements() const;
    /// The values of member `key`, an array; none if it is missing.
    std::vector<JsonValue> elements_of(std::string_view key) const;

    /// Returns all members of an object with their names, in order.
    std::vector<std::pair<std::string, JsonValue>> members() const;

    /// A whole number in [0, 2^53], also if written as 3.0.
    uint64_t to_unsigned() const;
    /// A number; one beyond the largest float, as some exporters write for "no limit", becomes the largest float.
    float to_float() const;
    /// A number without rounding to float.
    double to_double() const;
    bool to_bool() const;
    std::string_view to_string() const;
    /// An array of exactly `count` numbers.
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
    /// The value as JSON text without spaces; equal values have equal texts.
    std::string to_json() const;

    // Member `key`, or a default if it is missing.
    uint64_t unsigned_or(std::string_view key, uint64_t fallback) const;
    float float_or(std::string_view key, float fallback) const;
    bool bool_or(std::string_view key, bool fallback) const;
    std::string string_or(std::string_view key, std::string_view fallback) const;
    template <std::size_t count>
    std::array<float, count> floats_or(std::string_view key, std::array<float, count> fallback) const {
        const std::optional<JsonValue> member = find(key);
        return member ? member->to_floats<count>() : fallback;
    }

private:
    void read_floats(float* numbers, std::size_t count) const;
    void read_doubles(double* numbers, std::size_t count) const;
    JsonValue child(std::string_view key, simdjson::dom::element element) const;

    const std::string* file_;
    std::string pointer_;
    simdjson::dom::element element_;
};

/// Returns the value in the syntax of settings: a text as it is, a number as it is written, an array of numbers as
/// "1,2,3", one of rows likewise.
std::string setting_text(const JsonValue& value);

} // namespace pertev::gltf
