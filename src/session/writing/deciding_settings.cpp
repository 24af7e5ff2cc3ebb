#include "session/writing/deciding_settings.h"

#include <algorithm>
#include <span>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/hash.h"
#include "settings/setting_table.h"

namespace pertev {
namespace {

/// The hash of the contents of a file of cameras, which does not depend on its path.
std::string hash_of_cameras(const std::vector<CameraOfFile>& cameras) {
    std::string text;
    for (const CameraOfFile& camera : cameras) {
        text += camera.name + '\n';
        for (const auto& [name, value] : camera.settings) text += fmt::format("{}={}\n", name, value);
    }
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(text)));
    return hasher.result().hex();
}

auto find_name(auto& settings, const std::string& name) {
    return std::ranges::find(settings, name, [](const auto& setting) -> const std::string& { return setting.first; });
}

constexpr std::string_view kSceneFile = "hash of the scene's file";
constexpr std::string_view kFile = "file "; // begins the names of entries that are hashes of files

/// Returns a weight of a difference. Another version may have other settings, and another content of a file explains
/// other settings and further files; a metered exposure follows any other difference.
int rank_of(const SettingDifference& difference) {
    const std::string& name = difference.name;
    if (name == "version") return 4;
    const bool is_file = name == kSceneFile || name.starts_with(kFile);
    if (is_file && !difference.before.empty() && !difference.after.empty()) return 3;
    return name == "exposure" ? 1 : 2;
}

/// Returns the settings `before` with the names that files have in `after` if only these differ.
DecidingSettings with_names_of(const DecidingSettings& after, DecidingSettings before) {
    const auto is_new = [&, known = before](const auto& entry) {
        return entry.first.starts_with(kFile) && find_name(known, entry.first) == known.end();
    };
    for (const auto& [name, hash] : after) {
        if (!is_new(std::pair(name, hash))) continue;
        const auto same = std::ranges::find_if(before, [&](const auto& entry) {
            return entry.second == hash && entry.first.starts_with(kFile) &&
                   find_name(after, entry.first) == after.end();
        });
        if (same != before.end()) same->first = name;
    }
    return before;
}

/// Names of metadata that are no settings hold no file.
HoldsFile holds_file(std::string_view name) {
    const Setting* const setting = find_setting(name);
    return setting != nullptr ? setting->holds_file : HoldsFile::No;
}

/// Returns the text of a setting without the folder of its file, which another machine has elsewhere.
std::string without_folder(std::string_view setting, std::string text) {
    const HoldsFile holds = holds_file(setting);
    if (holds == HoldsFile::No) return text;
    const std::size_t begin = holds == HoldsFile::Named ? text.find('=') + 1 : 0; // 0 without one
    const std::size_t slash = text.rfind('/');
    return slash == std::string::npos || slash < begin ? text : text.erase(begin, slash + 1 - begin);
}

std::string value_of(const DecidingSettings& settings, const std::string& name) {
    const auto found = find_name(settings, name);
    return found != settings.end() ? found->second : "";
}

} // namespace

DecidingSettings deciding_settings(const PictureOptions& options, const PictureRecord& record) {
    DecidingSettings settings;
    const auto put = [&](const std::string& name, const std::string& value) {
        const auto known = find_name(settings, name);
        known != settings.end() ? void(known->second = value) : void(settings.emplace_back(name, value));
    };
    put(std::string(kSceneFile), record.scene.hash);
    for (const Setting& setting : all_settings()) {
        if (!setting.is_kept || (setting.verbs & kRender) == 0) continue;
        std::vector<std::string> texts = texts_of(options, setting);
        for (std::string& text : texts) text = without_folder(setting.name, std::move(text));
        put(setting.name, fmt::format("{}", fmt::join(texts, " ")));
    }
    put("animation", record.scene.animation); // even if the file has only one
    put("file_scene", record.scene.file_scene);
    put("variant", record.scene.variant);
    constexpr std::string_view kPrefix = "pertev.";
    for (const auto& [key, value] : settings_metadata(record)) {
        const std::string name = key.substr(kPrefix.size());
        if (holds_file(name) == HoldsFile::Named) continue; // the options have their texts
        put(name, without_folder(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value)));
    }
    put("size", fmt::format("{}x{}", record.settings.width, record.settings.height));
    if (options.camera_list) put("cameras", hash_of_cameras(*options.camera_list));
    for (const FileOfPicture& file : record.scene.files) put(std::string(kFile) + file.name, file.hash);
    return settings;
}

std::optional<SettingDifference> first_difference(const DecidingSettings& there, const DecidingSettings& after) {
    if (there == after) return std::nullopt;
    const DecidingSettings before = with_names_of(after, there);
    std::optional<SettingDifference> first;
    int weight = 0;
    for (const DecidingSettings* const names : {&after, &before}) {
        for (const auto& [name, value] : *names) {
            SettingDifference difference = {name, value_of(before, name), value_of(after, name)};
            const int rank = rank_of(difference);
            if (difference.before == difference.after || rank <= weight) continue;
            first = std::move(difference);
            weight = rank;
        }
    }
    return first;
}

std::string text_of(const SettingDifference& difference) {
    const auto& [name, before, after] = difference;
    if (name.starts_with(kFile)) {
        const std::string file = name.substr(kFile.size());
        if (before.empty()) return fmt::format("{} is read here and not there", file);
        if (after.empty()) return fmt::format("{} is read there and not here", file);
        return fmt::format("{} is another file there", file);
    }
    const std::string shown = find_setting(name) != nullptr ? '`' + name + '`' : name;
    return fmt::format("{} is \"{}\" there, not \"{}\"", shown, before, after);
}

} // namespace pertev
