#include "formats/pbrt/media.h"

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/described_medium.h"
#include "formats/pbrt/colors.h"
#include "scene/scatter_albedo.h"

namespace pertev::pbrt {
namespace {

// pbrt's defaults, per unit of the scene
constexpr Rgb kUsualSigmaA = {0.0011f, 0.0024f, 0.014f}, kUsualSigmaS = {2.55f, 3.21f, 3.77f};

MediumParameters scaled(const MediumParameters& medium, float scale) {
    return {scale * medium.sigma_a, scale * medium.sigma_s, medium.g};
}

/// Returns the coefficients of the substance that the parameter `name` names, or of sigma_a and sigma_s.
MediumParameters coefficients_of(Parameters& parameters, std::string_view name, const Context& context) {
    if (const std::string text = parameters.text(name, "", context.sink); !text.empty()) {
        if (const auto substance = described::find_substance(text)) return *substance;
        context.sink.leave_out({parameters.location(), fmt::format("there are no coefficients of {}; those of whole "
                                                                   "milk are used",
                                                                   shortened(text))});
    }
    return {.sigma_a = plain_color(parameters, "sigma_a", context).value_or(kUsualSigmaA),
            .sigma_s = plain_color(parameters, "sigma_s", context).value_or(kUsualSigmaS)};
}

} // namespace

MediumParameters read_medium(Parameters& parameters, const Context& context) {
    MediumParameters medium = coefficients_of(parameters, "preset", context);
    medium = scaled(medium, static_cast<float>(parameters.number("scale", 1, context.sink)));
    medium.g = static_cast<float>(parameters.number("g", 0, context.sink));
    parameters.leave_out({"Le", "Lescale"}, "media do not emit light", context.sink);
    return described::usable_medium(medium, parameters.location(), context.sink);
}

MediumParameters read_subsurface_medium(const MaterialSource& source) {
    Parameters& parameters = source.parameters;
    Sink& sink = source.context.sink;
    const auto scale = static_cast<float>(parameters.number("scale", 1, sink));
    const char* const color_name = source.type == "kdsubsurface" ? "Kd" : "reflectance";
    MediumParameters medium;
    if (parameters.has(color_name) || parameters.has("mfp") || source.type == "kdsubsurface") {
        const TextureValue shown = source.textures.color(parameters, color_name, grey(0.5f));
        if (shown.has_image())
            parameters.leave_out({color_name}, "a medium has one colour; the image's factor is used", sink);
        const Rgb free = plain_color(parameters, "mfp", source.context).value_or(grey(1)), c = shown.factor;
        const Rgb albedo = {single_scatter_albedo(c.r), single_scatter_albedo(c.g), single_scatter_albedo(c.b)};
        const Rgb sigma_t = Rgb{1, 1, 1} / free;
        medium.sigma_s = albedo * sigma_t;
        medium.sigma_a = sigma_t - medium.sigma_s;
    } else {
        medium = scaled(coefficients_of(parameters, "name", source.context), scale);
    }
    medium.g = static_cast<float>(parameters.number("g", 0, sink));
    parameters.ignore({"Kr", "Kt"}); // pbrt-v3's; 1 by default
    return described::usable_medium(medium, parameters.location(), sink);
}

} // namespace pertev::pbrt
