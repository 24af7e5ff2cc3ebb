#include "settings/check_settings.h"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "scene/suggested_setting.h"
#include "settings/value_names.h"

namespace pertev {

std::vector<std::string> integrators_with(const Setting& setting) {
    return integrator_names(setting.integrators != 0 ? setting.integrators : ~0u);
}

namespace {

const Setting* setting_of(const std::string& condition) {
    return find_setting(condition.substr(0, condition.find_first_of("!=")));
}

bool holds(const PictureOptions& options, const std::string& condition) {
    const Setting& setting = *setting_of(condition);
    const std::vector<std::string> texts = texts_of(options, setting);
    if (const std::size_t equals = condition.find('='); equals != std::string::npos) {
        if (texts.empty()) return false; // it has no value, thus no other one either
        const bool is_there = std::ranges::find(texts, condition.substr(equals + 1)) != texts.end();
        return is_there != (condition[equals - 1] == '!');
    }
    return options.is_given(setting.name) && !texts.empty() && !(is_switch(setting) && texts.front() == "false");
}

/// Returns the value with which NAME!=VALUE holds, as NAME=VALUE; other conditions as they are.
std::string with_value(const PictureOptions& options, const std::string& condition) {
    if (condition.find('!') == std::string::npos) return condition;
    const Setting& setting = *setting_of(condition);
    return fmt::format("{}={}", setting.name, texts_of(options, setting).front());
}

/// Returns whether the setting has one of the values A,B, or another one than those of !A,B; true for no values.
bool is_among(const PictureOptions& options, const Setting& setting, std::string_view values) {
    if (values.empty()) return true;
    const bool is_other = values.starts_with('!');
    std::string words(values.substr(is_other ? 1 : 0));
    std::ranges::replace(words, ',', ' ');
    const std::vector<std::string> named = words_of(words), texts = texts_of(options, setting);
    return is_other != (std::ranges::find_first_of(texts, named) != texts.end());
}

std::optional<SettingConflict> conflict_of(const PictureOptions& options, const Setting& setting, uint32_t verbs) {
    using Kind = SettingConflict::Kind;
    const auto value_in = [&](std::string_view rule) {
        return rule.empty() ? std::string() : texts_of(options, setting).front();
    };
    if (!has_setting(options.render.integrator, setting) && is_among(options, setting, setting.integrators_of)) {
        return SettingConflict{&setting, Kind::Integrator, integrators_with(setting), value_in(setting.integrators_of)};
    }
    std::vector<std::string> needs = words_of(setting.needs);
    // All frames of verbs without the setting are in real time.
    if (setting.needs.starts_with("real_time") && (find_setting("real_time")->verbs & verbs) == 0) needs.clear();
    std::erase_if(needs, [&](const std::string& other) { return (setting_of(other)->verbs & verbs) == 0; });
    const auto is_so = [&](const std::string& other) { return holds(options, other); };
    if (!needs.empty() && std::ranges::none_of(needs, is_so)) return SettingConflict{&setting, Kind::Needs, needs};
    for (std::string& other : words_of(setting.excludes)) {
        const std::size_t colon = other.find(':');
        const std::string rule = other.substr(0, colon == std::string::npos ? 0 : colon);
        other.erase(0, colon + 1); // npos + 1: 0
        if (!is_among(options, setting, rule) || !is_so(other)) continue;
        return SettingConflict{&setting, Kind::Excludes, {with_value(options, other)}, value_in(rule)};
    }
    return std::nullopt;
}

} // namespace

std::optional<SettingConflict> find_conflict(const PictureOptions& options, uint32_t verbs) {
    for (const Setting& setting : all_settings()) {
        if (!options.is_given(setting.name) || !holds(options, setting.name)) continue;
        if (auto conflict = conflict_of(options, setting, verbs)) return conflict;
    }
    return std::nullopt;
}

Remark remark_of(const SettingConflict& conflict, const PictureOptions& options) {
    const std::vector<std::string>& others = conflict.others;
    std::string why;
    switch (conflict.kind) {
    case SettingConflict::Kind::Integrator:
        why = fmt::format("applies to {}, not to {}", list_of(others), integrator_name(options.render));
        break;
    case SettingConflict::Kind::Needs:
        why = fmt::format("needs `{}`", fmt::join(others, "` or `"));
        break;
    case SettingConflict::Kind::Excludes:
        why = fmt::format("cannot be combined with `{}`; leave out one of them", others.front());
        break;
    }
    return {conflict.setting->name, conflict.value, why};
}

void check_settings(const PictureOptions& options, uint32_t verbs) {
    if (const auto conflict = find_conflict(options, verbs))
        throw Error(ErrorCode::BadInput, remark_of(*conflict, options));
}

std::string overruled_setting(const SettingConflict& conflict, const PictureOptions& options) {
    const PictureOptions defaults;
    const auto is_of = [&](const std::string& name, SettingOrigin origin) {
        const auto given = options.given.find(name);
        return given != options.given.end() && given->second == origin;
    };
    const auto yields_to = [&](const std::string& name, const std::string& other) {
        const Setting& setting = *find_setting(name);
        return is_of(name, SettingOrigin::File) &&
               (is_of(other, SettingOrigin::Caller) || texts_of(options, setting) == texts_of(defaults, setting));
    };
    const std::string own = conflict.setting->name;
    if (conflict.kind == SettingConflict::Kind::Integrator) return yields_to(own, "integrator") ? own : "";
    for (const std::string& condition : conflict.others) {
        const std::string other = setting_of(condition)->name;
        if (yields_to(own, other)) return own;
        if (conflict.kind == SettingConflict::Kind::Excludes && yields_to(other, own)) return other;
    }
    return "";
}

void apply_suggestions(const Scene& scene, const Camera* own, uint32_t verbs, PictureOptions& options, Sink& sink) {
    const auto apply = [&](const SuggestedSetting& suggested, std::string_view name) {
        if (options.is_given(name)) return;
        if (options.real_time && name == "spp") return; // real-time frames have one sample
        const Setting* const setting = find_setting(name);
        try {
            if (setting == nullptr || !setting->is_kept || setting->opens_scene) {
                throw Error(ErrorCode::BadInput, std::string(name), suggested.text,
                            "not a setting that a scene file can suggest");
            }
            if ((setting->verbs & verbs) == 0) return;
            PictureOptions with = options;
            set_value(with, *setting, std::span(&suggested.text, 1), SettingOrigin::Scene);
            if (!find_conflict(with, verbs)) options = with;
        } catch (const Error& error) {
            Remark why = error.remark();
            why.location = FileLocation{options.scene.scene};
            sink.leave_out(std::move(why));
        }
    };
    // A camera has its own suggestions first, then those for all.
    for (const bool of_camera : {true, false}) {
        for (const SuggestedSetting& suggested : scene.suggested) {
            const SuggestedFor is_for = parts_of_suggested(suggested.name);
            const bool is_of_own = own != nullptr && !own->name.empty() && is_for.camera == own->name;
            if (of_camera ? is_of_own : is_for.camera.empty()) apply(suggested, is_for.setting);
        }
    }
}

} // namespace pertev
