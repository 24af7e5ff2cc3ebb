#include "session/opening/set_medium.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "base/error.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

constexpr float kMostCoefficient = 0x1p40f; // 1/m

[[noreturn]] void refuse_medium(const std::string& text, const std::string& why) {
    throw Error(ErrorCode::BadInput, "medium", text,
                why + "; expected sigma_s=R,G,B, sigma_a=R,G,B (1/m) and g=G between spaces, or none");
}

Rgb parse_coefficients(const std::string& text, const std::string& value) {
    Rgb read;
    if (const auto one = number_in(value)) {
        read = grey(*one);
    } else if (!parse_rgb(value, read)) {
        refuse_medium(text, fmt::format("{} is neither a number nor R,G,B", value));
    }
    const auto is_usable = [](float x) { return x >= 0 && x <= kMostCoefficient; };
    if (is_usable(read.r) && is_usable(read.g) && is_usable(read.b)) return read;
    refuse_medium(text, fmt::format("{} is not from 0 to {}", value, kMostCoefficient));
}

} // namespace

MediumParameters parse_medium(const std::string& text) {
    MediumParameters medium;
    if (text == "none") return medium;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        const std::string key = word.substr(0, equals);
        const std::string value = equals == std::string::npos ? "" : word.substr(equals + 1);
        if (key == "sigma_s") {
            medium.sigma_s = parse_coefficients(text, value);
        } else if (key == "sigma_a") {
            medium.sigma_a = parse_coefficients(text, value);
        } else if (key == "g") {
            const auto g = number_in(value);
            if (!g || !(*g >= -kMaxScatterAnisotropy && *g <= kMaxScatterAnisotropy)) {
                refuse_medium(text,
                              fmt::format("g is not from {} to {}", -kMaxScatterAnisotropy, kMaxScatterAnisotropy));
            }
            medium.g = *g;
        } else {
            refuse_medium(text, fmt::format("there is no {}", key));
        }
    }
    if (!medium.is_there()) refuse_medium(text, "it neither scatters nor absorbs");
    return medium;
}

void set_medium(const std::string& text, Scene& scene, Sink& sink) {
    if (!text.empty()) scene.medium = parse_medium(text);
    const Rgb rates = scene.medium.sigma_t();
    if (!(min(rates.r, min(rates.g, rates.b)) > 0)) return;
    const bool has_sky = scene.environment && max_component(scene.environment->scale) > 0;
    const bool has_far_light =
        std::ranges::any_of(scene.lights, [](const Light& light) { return !parts_of(light.kind).position; });
    if (!has_sky && !has_far_light) return;
    sink.warn({"medium", text,
               "it has no end, so that no light from infinitely far away arrives, neither the environment's nor that "
               "of directional lights"});
}

} // namespace pertev
