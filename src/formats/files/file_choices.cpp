#include "formats/files/file_choices.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/message_text.h"
#include "formats/files/parse_number.h"

namespace pertev {
namespace {

constexpr std::string_view kAll = "all"; // selects all clips

/// The kind of item that is chosen.
struct Kind {
    const char* name;
    const char* setting; // that chooses one
    bool has_all;        // "all" is no name of one of them
};
constexpr Kind kClip = {"animation", "animation", true}, kFileScene = {"scene", "file_scene", false},
               kVariant = {"variant", "variant", false};

bool is_name(const Kind& kind, const std::string& text) { return !text.empty() && !(kind.has_all && text == kAll); }

/// Returns for each item whether only its number identifies it: it has no name, a name that others have too, or the
/// number of another such item as its name.
std::vector<bool> are_numbered(const Kind& kind, std::span<const std::string> names) {
    std::map<std::string_view, std::size_t> counts;
    for (const std::string& name : names) ++counts[name];
    std::vector<bool> numbered;
    for (const std::string& name : names) numbered.push_back(!is_name(kind, name) || counts[name] > 1);
    for (bool is_new = true; is_new;) {
        is_new = false;
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto number = numbered[i] ? std::nullopt : parse_whole_number<std::size_t>(names[i]);
            if (!number || *number == i || *number >= names.size() || !numbered[*number]) continue;
            numbered[i] = is_new = true;
        }
    }
    return numbered;
}

/// Returns the choice that selects each item: its name, or its number if the name is ambiguous.
std::vector<std::string> choices_of(const Kind& kind, std::span<const std::string> names) {
    const std::vector<bool> numbered = are_numbered(kind, names);
    std::vector<std::string> choices;
    for (std::size_t i = 0; i < names.size(); ++i) choices.push_back(numbered[i] ? fmt::format("{}", i) : names[i]);
    return choices;
}

std::vector<std::string> list_of(const Kind& kind, std::span<const std::string> names) {
    std::vector<std::string> list = choices_of(kind, names);
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (list[i] != names[i] && !names[i].empty()) list[i] = fmt::format("{} ({})", list[i], names[i]);
    }
    return list;
}

/// Returns a list of the items for messages, one per line.
std::string text_of(const Kind& kind, std::span<const std::string> names) {
    constexpr std::size_t kMaxShown = 20;
    std::string text;
    const std::vector<std::string> list = list_of(kind, names);
    for (std::size_t i = 0; i < std::min(list.size(), kMaxShown); ++i) text += "\n  " + shortened(list[i]);
    if (names.size() > kMaxShown) text += fmt::format("\n  and {} more", names.size() - kMaxShown);
    return text;
}

std::size_t choose(const Kind& kind, const std::string& file, std::span<const std::string> names,
                   const std::string& choice) {
    const std::vector<std::string> choices = choices_of(kind, names);
    const auto chosen = std::ranges::find(choices, choice);
    if (chosen != choices.end()) return static_cast<std::size_t>(chosen - choices.begin());
    const auto same = is_name(kind, choice) ? std::ranges::count(names, choice) : 0;
    const auto number = parse_whole_number<std::size_t>(choice);
    if (number && *number < names.size()) return *number;
    Remark why(kind.setting, choice, fmt::format("no such {}; the file has no {}s", kind.name, kind.name));
    if (same > 1) {
        why.reason =
            fmt::format("{} {}s have this name; choose one by its number:{}", same, kind.name, text_of(kind, names));
    } else if (!names.empty()) {
        why.reason = fmt::format("no such {}; the file has:{}", kind.name, text_of(kind, names));
    }
    why.location = FileLocation{file};
    throw Error(ErrorCode::BadInput, std::move(why));
}

std::vector<std::string> names_of(std::span<const Clip> clips) {
    std::vector<std::string> names;
    for (const Clip& clip : clips) names.push_back(clip.name);
    return names;
}

} // namespace

std::vector<bool> choose_clips(const std::string& file, std::span<const std::string> names, const std::string& choice) {
    std::vector<bool> plays(names.size(), choice == kAll);
    if (choice == kAll && !names.empty()) return plays;
    if (choice.empty() && names.empty()) return plays;
    plays[choice.empty() ? 0 : choose(kClip, file, names, choice)] = true;
    return plays;
}

uint32_t choose_file_scene(const std::string& file, std::span<const std::string> names, const std::string& choice) {
    return static_cast<uint32_t>(choose(kFileScene, file, names, choice));
}

uint32_t choose_material_variant(const std::string& file, std::span<const std::string> names,
                                 const std::string& choice) {
    return static_cast<uint32_t>(choose(kVariant, file, names, choice));
}

std::string clip_choice(std::span<const Clip> clips) {
    if (clips.size() < 2) return {};
    if (std::ranges::count(clips, true, &Clip::plays) > 1) return std::string(kAll);
    const auto playing = std::ranges::find(clips, true, &Clip::plays);
    if (playing == clips.end()) return {};
    return choices_of(kClip, names_of(clips))[static_cast<std::size_t>(playing - clips.begin())];
}

std::string file_scene_choice(const Scene& scene) {
    return scene.file_scenes.size() < 2 ? "" : choices_of(kFileScene, scene.file_scenes)[scene.file_scene];
}

std::string material_variant_choice(const Scene& scene) {
    return scene.variant ? choices_of(kVariant, scene.variants)[*scene.variant] : "";
}

std::vector<std::string> list_clips(std::span<const Clip> clips) { return list_of(kClip, names_of(clips)); }

std::vector<std::string> list_file_scenes(const Scene& scene) { return list_of(kFileScene, scene.file_scenes); }

std::vector<std::string> list_material_variants(const Scene& scene) { return list_of(kVariant, scene.variants); }

} // namespace pertev
