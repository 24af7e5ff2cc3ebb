#pragma once

// A setting: a row of the table of settings, and the operations on any row: list its values, check, set and read a
// value. Flags, help, JSON, metadata and documents are made only from these.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/value_names.h"
#include "settings/picture_options.h"

namespace pertev {

/// A switch whose field has the opposite meaning.
struct InverseSwitch {
    bool* field;
};

/// A field with one of several named values. `get` returns "" if it has none of them.
struct NamedField {
    void* field;
    std::string_view (*get)(const void*);
    bool (*set)(void*, std::string_view); // returns false for an unknown name
    std::vector<std::string> (*names)();
};

/// Location of a setting's value.
using SettingField =
    std::variant<bool*, InverseSwitch, uint32_t*, std::optional<uint32_t>*, float*, std::optional<float>*, double*,
                 std::optional<double>*, std::string*, std::vector<std::string>*, std::vector<std::filesystem::path>*,
                 std::vector<double>*, std::optional<Vec3>*, std::optional<DoubleVec3>*, std::optional<Rgb>*,
                 std::optional<PictureSize>*, NamedField>;

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

/// Groups of settings, whose names are headings of help and documents, in their order.
enum class SettingGroup : uint8_t {
    File,
    Camera,
    Environment,
    Lamps,
    Faces,
    Motion,
    Picture,
    Quality,
    Parts,
    Tracing,
    Machine,
    Raster,
    Reyes,
    Photons,
    Records,
    Radiosity,
    Frames,
};
inline constexpr ValueName<SettingGroup> kSettingGroups[] = {{SettingGroup::File, "File"},
                                                             {SettingGroup::Camera, "Camera"},
                                                             {SettingGroup::Environment, "Environment"},
                                                             {SettingGroup::Lamps, "Lamps"},
                                                             {SettingGroup::Faces, "Faces"},
                                                             {SettingGroup::Motion, "Motion"},
                                                             {SettingGroup::Picture, "Picture"},
                                                             {SettingGroup::Quality, "Quality"},
                                                             {SettingGroup::Parts, "Parts"},
                                                             {SettingGroup::Tracing, "Tracing"},
                                                             {SettingGroup::Machine, "Machine"},
                                                             {SettingGroup::Raster, "Raster"},
                                                             {SettingGroup::Reyes, "Reyes"},
                                                             {SettingGroup::Photons, "Photons"},
                                                             {SettingGroup::Records, "Records"},
                                                             {SettingGroup::Radiosity, "Radiosity"},
                                                             {SettingGroup::Frames, "Frames"}};
constexpr const auto& names_of_all(SettingGroup) { return kSettingGroups; }

/// The verbs that have settings, as bits.
enum SettingVerbs : uint32_t {
    kRender = 1,
    kView = 2,
    kMeasure = 4,
    kSolve = 8,
    kLab = 16,
    kInfo = 32,
    kBench = 64,
    kBenchRender = 128,
    kBenchRays = 256,
    kBenchBuild = 512,
    kBenchNoise = 1024,
    kBenchFrames = 2048,
    kBenchSequence = 4096,
    kBenchCameras = 8192,
    kBenchDevices = 16384,
    kMerge = 32768,
    kCheck = 65536,
    kConvert = 131072,
};
/// Names of verbs in the order of documents.
inline constexpr ValueName<SettingVerbs> kVerbNames[] = {{kRender, "render"},
                                                         {kView, "view"},
                                                         {kMeasure, "measure"},
                                                         {kSolve, "solve"},
                                                         {kLab, "lab"},
                                                         {kInfo, "info"},
                                                         {kBench, "bench"},
                                                         {kBenchRender, "bench render"},
                                                         {kBenchRays, "bench rays"},
                                                         {kBenchBuild, "bench build"},
                                                         {kBenchNoise, "bench noise"},
                                                         {kBenchFrames, "bench frames"},
                                                         {kBenchSequence, "bench sequence"},
                                                         {kBenchCameras, "bench cameras"},
                                                         {kBenchDevices, "bench devices"},
                                                         {kMerge, "merge"},
                                                         {kCheck, "check"},
                                                         {kConvert, "convert"}};

/// Form in which a picture's file records a setting under its name.
enum class Recorded : uint8_t {
    No,        // not recorded
    Always,    // the setting's value
    AsUsed,    // the value that the picture has, whether it was given or not; nothing if that is empty
    WhereUsed, // the setting's value, if the integrator has it and it is not empty
    Changed,   // the setting's value, if it is not the default
};

/// The part of a prepared render that another value of a setting changes. A part that is larger than needed costs time
/// and changes no picture. Display: only how PNG and JPEG show it.
enum class Changes : uint8_t { Scene, Camera, Picture, Display };

/// Position of a file's path in the text of a setting. Such a file is identified by its contents, not its location.
enum class HoldsFile : uint8_t {
    No,    // no path, or pictures do not depend on the setting
    Whole, // the text is a path, unless it is another value
    Named, // NAME=FILE
};

/// Group of the viewer's panel, in the panel's order.
enum class PanelGroup : uint8_t { Picture, Light, Frames, Camera, Rays };

/// A setting's row in the viewer's panel.
struct Panel {
    const char* label = ""; // empty: it has none
    PanelGroup group = PanelGroup::Picture;
    double step = 1; // between two numbers
};

struct Setting {
    const char* name; // name in C++, JSON and metadata, from which the flag is made
    SettingGroup group;
    const char* form = ""; // format of a value, such as N or X,Y,Z; empty: a switch
    /// Returns a pointer to the value, which these options no longer share with copies (SharedValue::edit).
    SettingField (*field)(PictureOptions&);
    const char* sentence;       // describes the setting
    const char* more = "";      // further sentences for longer help
    const char* letter = "";    // letter of a short flag
    const char* old_name = "";  // name in earlier versions, which files may have; the flag takes it, hidden
    double low = 0, high = 0;   // range of numbers; high 0: the maximum of the field
    bool above = false;         // whether `low` itself is excluded
    const char* unit = "";      // unit of numbers
    const char* otherwise = ""; // text of the default if the setting is not given and its field is empty or 0
    std::vector<std::string> choices = {}; // all values of a text; for named fields their names
    std::vector<uint32_t> counts = {};     // how many numbers a value that is a vector of doubles may have
    bool is_name = false;                  // a text that must not be empty
    bool is_by_ray = false;                // whether KIND=, a kind of ray, may stand before a value
    uint32_t verbs = kRender;
    uint32_t integrators = 0; // bits by IntegratorKind of those that have it; 0: all. all_settings() adds those
                              // whose IntegratorDescriptor::settings names it
    std::string_view integrators_of = ""; // values for which `integrators` holds, as in `excludes`; empty: all
    std::string_view needs = "";          // names of settings, or NAME=VALUE, at least one of which must be satisfied
    std::string_view excludes = ""; // names of settings, NAME=VALUE or NAME!=VALUE, that must not be satisfied; A: or
                                    // A,B: before it restricts the rule to these values of this setting, !A: to others
    uint32_t formats = 0;           // bits by ImageFormat of files that show it; 0: all
    Recorded recorded = Recorded::No;
    Changes changes = Changes::Scene; // Scene: also its trees and the machine
    HoldsFile holds_file = HoldsFile::No;
    bool may_be_numbers = false;   // JSON shows a text that is a list of numbers as an array
    bool is_after_records = false; // irradiance records do not depend on it, nor on what changes the display alone
    bool is_kept = true;           // settings files contain it, because the picture depends on it
    bool opens_scene = false;      // takes effect before the scene's file is read, which thus cannot suggest it
    bool is_common = false;        // used by most people
    Panel panel = {};              // only if the viewer can change it between frames
};

/// Returns what `visit` returns for the field of a copy of the options, so that these stay as they are.
template <class Visit>
auto read_field(PictureOptions options, const Setting& setting, Visit visit) {
    return std::visit(visit, setting.field(options));
}

/// Returns the words of a list such as `needs`.
std::vector<std::string> words_of(std::string_view list);

bool is_switch(const Setting& setting);
/// Returns whether the setting accepts any number of values.
bool is_list(const Setting& setting);
/// Returns whether a value is one vector or colour.
bool is_vector(const Setting& setting);
/// Returns all possible values; empty if they are not listed.
std::vector<std::string> choices_of(const Setting& setting);
/// Returns whether the integrator has the setting.
bool has_setting(IntegratorKind integrator, const Setting& setting);

/// Returns why the text is not a value, according to its range, its choices and its kind; empty if it is one.
std::string why_no_value(const Setting& setting, const std::string& text);

/// Sets the field, a list to all texts, and records the source in `options.given`. Throws Error(BadInput), or
/// Error(OverLimit) for a value that is too large for every scene, with the setting and the wrong text.
void set_value(PictureOptions& options, const Setting& setting, std::span<const std::string> texts,
               SettingOrigin origin = SettingOrigin::Caller);

/// Returns the value in the syntax of set_value: no text for an empty optional or list, "" for an empty text, "true"
/// or "false" for a switch.
std::vector<std::string> texts_of(const PictureOptions& options, const Setting& setting);
/// Returns the value as JSON: a number, true or false, a string, or an array of these.
std::string json_of(const PictureOptions& options, const Setting& setting);

} // namespace pertev
