#include "session/writing/deciding_settings.h"

#include <algorithm>
#include <span>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/hash.h"
#include "base/read_file.h"
#include "session/height_maps.h"
#include "settings/setting_table.h"

namespace pertev {
namespace {

/// The hash of what a file of cameras says, wherever it lies.
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
    put("hash of the scene's file", record.scene.hash);
    put("hash of the files that the scene's refers to", record.scene.hash_of_files);
    for (const Setting& setting : all_settings()) {
        if (setting.is_kept && (setting.verbs & kRender) != 0)
            put(setting.name, fmt::format("{}", fmt::join(texts_of(options, setting), " ")));
    }
    put("animation", record.scene.animation); // even if the file has only one
    put("file_scene", record.scene.file_scene);
    put("variant", record.scene.variant);
    constexpr std::string_view kPrefix = "pertev.";
    for (const auto& [name, value] : settings_metadata(record))
        put(name.substr(kPrefix.size()), std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    put("size", fmt::format("{}x{}", record.settings.width, record.settings.height));
    put("hash of camera_path", hash_of_file(options.camera_path));
    put("hash of camera_from", hash_of_file(options.scene.camera.camera_from));
    if (options.camera_list) put("cameras", hash_of_cameras(*options.camera_list));
    put("hash of lut", hash_of_file(options.lut));
    std::vector<std::string> height_maps;
    for (const std::string& text : options.displacement)
        height_maps.push_back(hash_of_file(parse_height_map(text).file));
    put("hash of displacement", fmt::format("{}", fmt::join(height_maps, " ")));
    put("hash of environment", hash_of_file(options.scene.environment));
    return settings;
}

std::optional<SettingDifference> first_difference(const DecidingSettings& before, const DecidingSettings& after) {
    std::optional<SettingDifference> first;
    int weight = 0;
    for (const DecidingSettings* const names : {&after, &before}) {
        for (const auto& [name, value] : *names) {
            SettingDifference difference = {name, value_of(before, name), value_of(after, name)};
            // Another version may have other settings, and a metered exposure follows any other difference.
            const int rank = name == "version" ? 3 : name == "exposure" ? 1 : 2;
            if (difference.before == difference.after || rank <= weight) continue;
            if (find_setting(name) != nullptr) difference.name = '`' + name + '`';
            first = std::move(difference);
            weight = rank;
        }
    }
    return first;
}

} // namespace pertev
