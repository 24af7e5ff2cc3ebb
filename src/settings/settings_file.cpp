#include "settings/settings_file.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/json_text.h"
#include "base/read_file.h"
#include "formats/builtin_scenes.h"
#include "formats/json/json_file.h"
#include "settings/check_settings.h"

namespace pertev {
namespace {

constexpr uint64_t kVersion = 1;

using gltf::JsonValue;

std::vector<std::string> texts_of(const Setting& setting, const JsonValue& value) {
    std::vector<std::string> texts;
    if (!is_list(setting)) return {setting_text(value)};
    for (const JsonValue& element : value.elements()) texts.push_back(setting_text(element));
    return texts;
}

void compare_scene(const JsonValue& root, const std::filesystem::path& file, const std::string& scene, Sink& sink) {
    const std::optional<JsonValue> source = root.find("scene");
    if (!source) return;
    for (const auto& [key, value] : source->members()) {
        if (key != "name" && key != "hash") {
            sink.leave_out(fmt::format("{}: unknown name in a settings file", text_of(value.location())));
        }
    }
    const std::string name = source->string_or("name", ""), hash = source->string_or("hash", "");
    const std::string here = hash.empty() ? "" : scene_hash(scene);
    if (here.empty() || here == hash) return;
    sink.warn(fmt::format("{}: the settings are for {} with hash {}; {} is a different scene (hash {})", file.string(),
                          name, hash, scene, here));
}

} // namespace

std::string scene_hash(const std::string& scene) {
    const auto text = builtin_scene(scene);
    if (!text) return hash_of_file(scene);
    Hasher hasher;
    hasher.add(*text);
    return hasher.result().hex();
}

bool is_written(const PictureOptions& options, const Setting& setting) {
    const bool is_recorded = setting.recorded != Recorded::No && setting.recorded != Recorded::AsUsed &&
                             has_setting(options.render.integrator, setting);
    if (!setting.is_kept || !(is_recorded || options.is_given(setting.name))) return false;
    const std::vector<std::string> texts = texts_of(options, setting);
    return !texts.empty() && // empty: a value that means "not given"
           std::ranges::all_of(texts, [&](const std::string& text) { return why_no_value(setting, text).empty(); });
}

std::string settings_json(const PictureOptions& options, const std::string& hash_of_scene,
                          std::span<const Setting> table) {
    std::string members;
    for (const Setting& setting : table) {
        if (!is_written(options, setting)) continue;
        members +=
            fmt::format("{}{}:{}", members.empty() ? "" : ",", json_string(setting.name), json_of(options, setting));
    }
    return fmt::format(R"({{"version":{},"scene":{{"name":{},"hash":{}}},"settings":{{{}}}}})", kVersion,
                       json_string(options.scene.scene), json_string(hash_of_scene), members);
}

std::string with_samples(const std::string& json, std::string_view samples) {
    const std::string key = R"("spp":)";
    const std::size_t found = json.find(key);
    if (found == std::string::npos) return json;
    const std::size_t begin = found + key.size();
    return fmt::format("{}{}{}", json.substr(0, begin), samples,
                       json.substr(std::min(json.find_first_of(",}", begin), json.size())));
}

std::string with_setting(const std::string& json, const PictureOptions& options, std::string_view name) {
    const Setting* const setting = find_setting(name);
    const std::string open = R"("settings":{)";
    const std::size_t found = json.find(open);
    if (found == std::string::npos || setting == nullptr) return json;
    const std::string key = json_string(name) + ":", value = json_of(options, *setting);
    const std::size_t first = found + open.size(), known = json.find(key, first);
    if (known == std::string::npos) {
        return fmt::format("{}{}{}{}{}", json.substr(0, first), key, value, json[first] == '}' ? "" : ",",
                           json.substr(first));
    }
    const std::size_t begin = known + key.size(); // a number follows, or a text without quotes in it
    const std::size_t end = json[begin] == '"' ? json.find('"', begin + 1) + 1 : json.find_first_of(",}", begin);
    return fmt::format("{}{}{}", json.substr(0, begin), value, json.substr(std::min(end, json.size())));
}

std::string reconstruction_json(const ReconstructionOptions& options, std::optional<uint32_t> frame_depth) {
    PictureOptions used;
    used.reconstruction = {.settings = options.used(), .sharing = options.sharing};
    used.render.frame_depth = frame_depth;
    std::string members;
    for (const Setting& setting : all_settings()) {
        if (!setting.needs.starts_with("real_time") || setting.group != SettingGroup::Frames) continue;
        if (texts_of(used, setting).empty()) continue;
        members += fmt::format("{}\"{}\":{}", members.empty() ? "" : ",", setting.name, json_of(used, setting));
    }
    return '{' + members + '}';
}

void read_settings(const std::filesystem::path& file, uint32_t verbs, std::span<const std::string> overruled,
                   PictureOptions& options, Sink& sink) {
    const JsonFile json(file);
    const JsonValue& root = json.root();
    if (const JsonValue version = root.at("version"); version.to_unsigned() != kVersion) {
        throw version.error(fmt::format("{}; expected {}", version.to_unsigned(), kVersion));
    }
    compare_scene(root, file, options.scene.scene, sink);
    const JsonValue settings = root.at("settings");
    for (const auto& [name, value] : settings.members()) {
        const Setting* const setting = find_setting(name);
        if (setting != nullptr && std::ranges::find(overruled, setting->name) != overruled.end()) continue;
        if (setting == nullptr || !setting->is_kept || (setting->verbs & verbs) == 0) {
            sink.leave_out(fmt::format("{}: {}", text_of(value.location()),
                                       setting == nullptr ? "unknown setting" : "not a setting of this verb"));
            continue;
        }
        try {
            set_value(options, *setting, texts_of(*setting, value), SettingOrigin::File);
        } catch (const Error& error) {
            throw value.error(error);
        }
    }
    for (const auto& [name, value] : root.members()) {
        if (name != "version" && name != "scene" && name != "settings") {
            sink.leave_out(fmt::format("{}: unknown name in a settings file", text_of(value.location())));
        }
    }
}

void combine_settings(const std::filesystem::path& file, uint32_t verbs, const SetOthers& set_others,
                      PictureOptions& options, Sink& sink) {
    const PictureOptions start = options;
    std::vector<std::string> overruled; // settings of the file that do not go with the others
    while (true) {
        if (!file.empty()) read_settings(file, verbs, overruled, options, overruled.empty() ? sink : nobody());
        set_others(options);
        const auto conflict = find_conflict(options, verbs);
        if (!conflict) return;
        overruled.push_back(overruled_setting(*conflict, options));
        if (overruled.back().empty()) throw Error(ErrorCode::BadInput, remark_of(*conflict, options));
        options = start;
    }
}

} // namespace pertev
