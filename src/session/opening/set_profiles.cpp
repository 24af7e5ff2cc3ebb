#include "session/opening/set_profiles.h"

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/ies/read_ies.h"
#include "scene/names.h"
#include "scene/orient_light.h"
#include "session/photometry.h"

namespace pertev {
namespace {

[[noreturn]] void refuse_profile(const std::string& text, const std::string& why) {
    throw Error(ErrorCode::BadInput, "ies", text, why);
}

/// Splits NAME=FILE at its first equals sign.
std::pair<std::string, std::string> parts_of_profile(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        refuse_profile(text, "expected NAME=FILE, such as lamp=downlight.ies");
    return {text.substr(0, equals), text.substr(equals + 1)};
}

void set_profile(const std::shared_ptr<const IntensityTable>& table, float watts_per_steradian, Light& light) {
    if (!parts_of(light.kind).direction && light.node == kNoNode) light.direction = {0, -1, 0}, light.up = {0, 0, -1};
    light.kind = LightKind::Goniometric;
    light.table = table;
    orient_light(light);
    const Rgb color = color_of_emitter(light.intensity);
    light.intensity = (watts_per_steradian / luminance(color)) * color;
}

} // namespace

std::string file_of_profile(const std::string& text) { return parts_of_profile(text).second; }

void set_profiles(Scene& scene, std::span<const std::string> texts, double lumens_per_watt, Sink& sink) {
    std::map<const Light*, std::string> known; // the texts that have set lights
    for (const std::string& text : texts) {
        const auto [name, file] = parts_of_profile(text);
        float candelas = 0;
        const auto table = make_intensity_table(read_ies(file, sink), candelas);
        std::vector<Names> all;
        bool is_found = false;
        for (Light& light : scene.lights) {
            if (!parts_of(light.kind).position) continue;
            all.push_back(names_of(scene, light));
            if (!has_name(all.back(), name)) continue;
            const auto [other, is_first] = known.try_emplace(&light, text);
            if (!is_first) refuse_profile(text, fmt::format("{} sets the same light", other->second));
            set_profile(table, static_cast<float>(static_cast<double>(candelas) / lumens_per_watt), light);
            is_found = true;
        }
        if (!is_found) refuse_profile(text, "the scene has no point or spot light with this name; " + some_names(all));
    }
}

} // namespace pertev
