#include "formats/json/json_value.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pertev::gltf {
namespace {

constexpr double kMaxWholeNumber = 0x1p53; // the largest up to which a double holds every whole number

std::string_view type_name(simdjson::dom::element element) {
    using simdjson::dom::element_type;
    switch (element.type()) {
    case element_type::ARRAY:
        return "an array";
    case element_type::OBJECT:
        return "an object";
    case element_type::INT64:
    case element_type::UINT64:
    case element_type::DOUBLE:
        return "a number";
    case element_type::STRING:
        return "a string";
    case element_type::BOOL:
        return "true or false";
    case element_type::NULL_VALUE:
        return "null";
    }
    return "unknown";
}

// RFC 6901: what stands for itself in a pointer must not look like its separator.
std::string escape(std::string_view key) {
    std::string escaped;
    for (const char c : key) {
        if (c == '~')
            escaped += "~0";
        else if (c == '/')
            escaped += "~1";
        else
            escaped += c;
    }
    return escaped;
}

} // namespace

Error JsonValue::error(const std::string& what) const { return Error(ErrorCode::BadInput, location(), what); }

Error JsonValue::error(const Error& cause) const {
    Remark remark = cause.location() && cause.location() != location() ? Remark(cause.what()) : cause.remark();
    remark.location = location();
    return {cause.code(), std::move(remark)};
}

JsonValue JsonValue::child(std::string_view key, simdjson::dom::element element) const {
    return {*file_, fmt::format("{}/{}", pointer_, escape(key)), element};
}

std::optional<JsonValue> JsonValue::find(std::string_view key) const {
    if (element_.is_null()) return std::nullopt;
    simdjson::dom::object object;
    if (element_.get(object)) throw error(fmt::format("{}; expected an object", type_name(element_)));
    simdjson::dom::element element;
    if (object.at_key(key).get(element) || element.is_null()) return std::nullopt;
    return child(key, element);
}

JsonValue JsonValue::at(std::string_view key) const {
    std::optional<JsonValue> member = find(key);
    if (!member) throw error(fmt::format("\"{}\" is missing; it is required here", key));
    return *std::move(member);
}

std::optional<JsonValue> JsonValue::extension(std::string_view name) const {
    const std::optional<JsonValue> extensions = find("extensions");
    return extensions ? extensions->find(name) : std::nullopt;
}

std::vector<std::pair<std::string, JsonValue>>
JsonValue::extensions_within(const std::function<bool(std::string_view)>& is_wanted) const {
    std::vector<std::pair<std::string, JsonValue>> found;
    std::vector<std::pair<std::string_view, std::size_t>> path; // keys, or without one indices
    const auto pointer = [&] {
        std::string text = pointer_;
        for (const auto& [key, index] : path) text += "/" + (key.empty() ? std::to_string(index) : escape(key));
        return text;
    };
    // The parser has refused what is nested so deeply that this recursion could not follow.
    const auto visit = [&](const auto& self, simdjson::dom::element element, bool is_extensions) -> void {
        std::size_t i = 0;
        if (element.is_object()) {
            for (const auto& [key, value] : simdjson::dom::object(element)) {
                const bool may_hold = value.is_object() || value.is_array();
                if (!(may_hold || is_extensions) || key == "extras") continue;
                path.emplace_back(key, 0);
                if (is_extensions && !value.is_null() && is_wanted(key)) {
                    found.emplace_back(std::string(key), JsonValue(*file_, pointer(), value));
                }
                self(self, value, key == "extensions");
                path.pop_back();
            }
        } else if (element.is_array()) {
            for (const simdjson::dom::element value : simdjson::dom::array(element)) {
                if (value.is_object()) {
                    path.emplace_back(std::string_view(), i);
                    self(self, value, false);
                    path.pop_back();
                } else if (value.is_number() || value.is_string()) {
                    break; // all elements of this array are of this kind
                }
                ++i;
            }
        }
    };
    visit(visit, element_, false);
    return found;
}

std::vector<JsonValue> JsonValue::elements() const {
    simdjson::dom::array array;
    if (element_.get(array)) throw error(fmt::format("{}; expected an array", type_name(element_)));
    std::vector<JsonValue> values;
    for (const simdjson::dom::element element : array) {
        values.emplace_back(*file_, fmt::format("{}/{}", pointer_, values.size()), element);
    }
    return values;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
    simdjson::dom::object object;
    if (element_.get(object)) throw error(fmt::format("{}; expected an object", type_name(element_)));
    std::vector<std::pair<std::string, JsonValue>> values;
    for (const auto& [key, element] : object) values.emplace_back(std::string(key), child(key, element));
    return values;
}

std::vector<JsonValue> JsonValue::elements_of(std::string_view key) const {
    const std::optional<JsonValue> member = find(key);
    return member ? member->elements() : std::vector<JsonValue>();
}

uint64_t JsonValue::to_unsigned() const {
    uint64_t whole = 0;
    double number = 0;
    if (!element_.get(whole) && whole <= static_cast<uint64_t>(kMaxWholeNumber)) return whole;
    if (!element_.get(number)) {
        if (number >= 0 && number <= kMaxWholeNumber && std::trunc(number) == number) {
            return static_cast<uint64_t>(number);
        }
        throw error(fmt::format("{}; expected a whole number from 0 to 2^53", number));
    }
    throw error(fmt::format("{}; expected a whole number", type_name(element_)));
}

double JsonValue::to_double() const {
    double number = 0;
    if (element_.get(number)) throw error(fmt::format("{}; expected a number", type_name(element_)));
    constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
    return std::clamp(number, -largest, largest);
}

float JsonValue::to_float() const { return static_cast<float>(to_double()); }

bool JsonValue::to_bool() const {
    bool value = false;
    if (element_.get(value)) throw error(fmt::format("{}; expected true or false", type_name(element_)));
    return value;
}

std::string_view JsonValue::to_string() const {
    std::string_view text;
    if (element_.get(text)) throw error(fmt::format("{}; expected a string", type_name(element_)));
    return text;
}

std::string JsonValue::to_json() const { return simdjson::minify(element_); }

uint64_t JsonValue::unsigned_or(std::string_view key, uint64_t fallback) const {
    const std::optional<JsonValue> member = find(key);
    return member ? member->to_unsigned() : fallback;
}

float JsonValue::float_or(std::string_view key, float fallback) const {
    const std::optional<JsonValue> member = find(key);
    return member ? member->to_float() : fallback;
}

bool JsonValue::bool_or(std::string_view key, bool fallback) const {
    const std::optional<JsonValue> member = find(key);
    return member ? member->to_bool() : fallback;
}

std::string JsonValue::string_or(std::string_view key, std::string_view fallback) const {
    const std::optional<JsonValue> member = find(key);
    return std::string(member ? member->to_string() : fallback);
}

void JsonValue::read_floats(float* numbers, std::size_t count) const {
    const std::vector<JsonValue> values = elements();
    if (values.size() != count) throw error(fmt::format("{} values; expected {}", values.size(), count));
    for (std::size_t i = 0; i < count; ++i) numbers[i] = values[i].to_float();
}

void JsonValue::read_doubles(double* numbers, std::size_t count) const {
    const std::vector<JsonValue> values = elements();
    if (values.size() != count) throw error(fmt::format("{} values; expected {}", values.size(), count));
    for (std::size_t i = 0; i < count; ++i) numbers[i] = values[i].to_double();
}

std::string setting_text(const JsonValue& value) {
    const std::string json = value.to_json();
    if (json.starts_with('"')) return std::string(value.to_string());
    if (!json.starts_with('[')) return json;
    std::string text;
    for (const JsonValue& element : value.elements()) text += (text.empty() ? "" : ",") + setting_text(element);
    return text;
}

} // namespace pertev::gltf
