#pragma once

// One setting: a row of the table of settings, and what can be done with any row: say what its values are, check and
// set a value, read it. Flags, help, JSON, metadata and documents are made of these alone.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/value_names.h"
#include "settings/picture_options.h"

namespace pertev {

/// A switch whose field says the opposite.
struct InverseSwitch {
    bool* field;
};

/// A field that holds one of a few values which have names. `get` returns "" where it holds none.
struct NamedField {
    void* field;
    std::string_view (*get)(const void*);
    bool (*set)(void*, std::string_view); // false: there is no such name
    std::vector<std::string> (*names)();
};

/// Where a setting's value lies.
using SettingField =
    std::variant<bool*, InverseSwitch, uint32_t*, std::optional<uint32_t>*, float*, std::optional<float>*, double*,
                 std::optional<double>*, std::string*, std::vector<std::string>*, std::vector<std::filesystem::path>*,
                 std::optional<Vec3>*, std::optional<DoubleVec3>*, std::optional<Rgb>*, std::optional<PictureSize>*,
                 NamedField>;

template <NamedValue Value>
SettingField field_of(Value& field) {
    return NamedField{&field, [](const void* f) { return name_of(*static_cast<const Value*>(f)); },
                      [](void* f, std::string_view name) {
                          const auto value = value_named<Value>(name);
                          if (value) *static_cast<Value*>(f) = *value;
                          return value.has_value();
                      },
                      names_of<Value>};
}
template <NamedValue Value>
SettingField field_of(std::optional<Value>& field) {
    using Field = std::optional<Value>;
    return NamedField{&field,
                      [](const void* f) {
                          const Field& value = *static_cast<const Field*>(f);
                          return value ? name_of(*value) : std::string_view();
                      },
                      [](void* f, std::string_view name) {
                          const Field value = value_named<Value>(name);
                          if (value) *static_cast<Field*>(f) = value;
                          return value.has_value();
                      },
                      names_of<Value>};
}
template <class Value>
SettingField field_of(Value& field) {
    return &field;
}

/// The verbs that have settings, as bits.
enum SettingVerbs : uint32_t {
    kRender = 1,
    kView = 2,
    kMeasure = 4,
    kSolve = 8,
    kBenchNoise = 16,
    kBenchFrames = 32,
    kBenchSequence = 64,
    kLab = 128,
    kInfo = 256,
    kBench = 512, // and bench render
    kBenchBuild = 1024,
    kBenchRays = 2048,
};

/// What a picture's file says of a setting under its name.
enum class Recorded : uint8_t {
    No,        // nothing, or something else (session/writing/picture_metadata.h)
    Always,    // its value
    WhereUsed, // its value, where the integrator has it and it is not empty
    Changed,   // its value, where it is not the default
};

struct Setting {
    const char* name;      // as in C++, JSON and metadata; a flag is made of it
    const char* group;     // a heading, one word
    const char* form = ""; // how a value is written, as N or X,Y,Z; empty: a switch
    SettingField (*field)(PictureOptions&);
    const char* sentence;       // says what it is
    const char* more = "";      // further sentences, for those who have the room
    double low = 0, high = 0;   // of numbers: the range; high 0: up to what the field holds
    bool above = false;         // `low` itself is no value
    const char* unit = "";      // of numbers
    const char* otherwise = ""; // in words, what holds where the setting is not given and its field is empty or 0
    std::vector<std::string> choices = {}; // of texts: all values; of named fields these are the names
    bool is_name = false;                  // a text that is not empty
    uint32_t verbs = kRender;
    uint32_t integrators = 0;       // bits by IntegratorKind, which alone have it; 0: all
    std::string_view needs = "";    // names of settings, or NAME=VALUE, of which at least one must hold
    std::string_view excludes = ""; // those that must not hold
    Recorded recorded = Recorded::No;
    bool is_kept = true;      // files of settings hold it: the picture depends on it
    bool opens_scene = false; // it counts before the scene's file is read, which cannot suggest it
    bool is_common = false;   // most people use it
};

bool is_switch(const Setting& setting);
/// Whether it takes any number of values.
bool is_list(const Setting& setting);
/// Returns all values that there are; empty where they are not listed.
std::vector<std::string> choices_of(const Setting& setting);
/// Whether that integrator has it.
bool has_setting(IntegratorKind integrator, const Setting& setting);

/// Says why the text is no value; empty where it is one, as far as can be told by its range, its choices and its kind.
std::string why_no_value(const Setting& setting, const std::string& text);

/// Sets the field; a list gets all texts. Throws Error(BadInput), or Error(OverLimit) for a value that is too large for
/// every scene; the message begins with the text.
void set_value(PictureOptions& options, const Setting& setting, std::span<const std::string> texts);

/// Returns the value in words, as set_value takes it: no text where an optional or a list is empty, "" likewise, "true"
/// or "false" of a switch.
std::vector<std::string> texts_of(const PictureOptions& options, const Setting& setting);
/// Returns the value as JSON: a number, true or false, a string, or an array of these.
std::string json_of(const PictureOptions& options, const Setting& setting);

} // namespace pertev
