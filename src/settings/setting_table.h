#pragma once

// The table of settings: one row each, in the order of help and documents. A setting that is added here gets a flag,
// help, an entry in JSON and metadata, a line in docs/settings.md and, with a Panel, a row in the viewer's panel.

#include <utility>

#include "settings/setting.h"

namespace pertev {

const std::vector<Setting>& all_settings();
/// Returns the setting with this name, now or in an earlier version; null if there is none.
const Setting* find_setting(std::string_view name);

// The parts of the table.
std::vector<Setting> scene_settings();      // the file, the camera, light, motion
std::vector<Setting> picture_settings();    // content, method and display of a picture
std::vector<Setting> integrator_settings(); // settings of one or a few integrators
std::vector<Setting> frame_settings();      // settings of real-time frames

inline constexpr uint32_t kLooking = kRender | kView | kBenchNoise | kBenchFrames | kBenchSequence | kBenchCameras;
inline constexpr uint32_t kScenes = kLooking | kMeasure | kSolve;
inline constexpr uint32_t kDescribes = kInfo | kCheck | kConvert; // verbs that read a scene and render nothing
inline constexpr uint32_t kBenchPictures = kBench | kBenchRender | kBenchDevices;

/// The field at a path in PictureOptions.
#define PERTEV_SETTING_FIELD(member) [](PictureOptions& all) { return field_of(all.member); }

// Optional parts of a row.
struct Range {
    double low, high;
};
struct Above {
    double low, high = 0;
};
struct Unit {
    const char* text;
};
struct Otherwise {
    const char* text;
};
struct OldName {
    const char* text;
};
struct More {
    const char* text;
};
struct Choices {
    std::vector<std::string> names;
};
struct Counts {
    std::vector<uint32_t> numbers;
};
struct On {
    uint32_t verbs;
};
struct Of {
    uint32_t integrators;
    const char* values = ""; // Setting::integrators_of
};
struct Letter { // a short flag, as another program has it
    const char* text;
};
struct Needs {
    const char* text;
};
struct Excludes {
    const char* text;
};
struct In {
    uint32_t formats;
};
enum class Mark { Name, NotKept, Common, OpensScene, ByRay, Numbers, AfterRecords };

/// A group by its heading, which the compiler finds.
struct GroupName {
    SettingGroup value;
    consteval GroupName(const char* heading) : value(*value_named<SettingGroup>(heading)) {}
};

inline void put(Setting& s, Range range) { s.low = range.low, s.high = range.high; }
inline void put(Setting& s, Above range) { s.low = range.low, s.high = range.high, s.above = true; }
inline void put(Setting& s, Unit unit) { s.unit = unit.text; }
inline void put(Setting& s, Otherwise otherwise) { s.otherwise = otherwise.text; }
inline void put(Setting& s, OldName old) { s.old_name = old.text; }
inline void put(Setting& s, Letter letter) { s.letter = letter.text; }
inline void put(Setting& s, More more) { s.more = more.text; }
inline void put(Setting& s, Choices choices) { s.choices = std::move(choices.names); }
inline void put(Setting& s, Counts counts) { s.counts = std::move(counts.numbers); }
inline void put(Setting& s, On on) { s.verbs = on.verbs; }
inline void put(Setting& s, Of of) { s.integrators = of.integrators, s.integrators_of = of.values; }
inline void put(Setting& s, Needs needs) { s.needs = needs.text; }
inline void put(Setting& s, Excludes excludes) { s.excludes = excludes.text; }
inline void put(Setting& s, In in) { s.formats = in.formats; }
inline void put(Setting& s, Panel panel) { s.panel = panel; }
inline void put(Setting& s, Recorded recorded) { s.recorded = recorded; }
inline void put(Setting& s, Changes changes) { s.changes = changes; }
inline void put(Setting& s, HoldsFile holds) { s.holds_file = holds; }
inline void put(Setting& s, Mark mark) {
    if (mark == Mark::Name) s.is_name = true;
    if (mark == Mark::NotKept) s.is_kept = false;
    if (mark == Mark::Common) s.is_common = true;
    if (mark == Mark::OpensScene) s.opens_scene = true;
    if (mark == Mark::ByRay) s.is_by_ray = true;
    if (mark == Mark::Numbers) s.may_be_numbers = true;
    if (mark == Mark::AfterRecords) s.is_after_records = true;
}

/// Makes a row; the parts may be in any order.
template <class... Parts>
Setting row(const char* name, GroupName group, const char* form, SettingField (*field)(PictureOptions&),
            const char* sentence, Parts... parts) {
    Setting setting = {.name = name, .group = group.value, .form = form, .field = field, .sentence = sentence};
    (put(setting, std::move(parts)), ...);
    return setting;
}

} // namespace pertev
