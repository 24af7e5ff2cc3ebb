#include "formats/pbrt/media.h"

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/described_medium.h"
#include "formats/files/closest_name.h"
#include "formats/pbrt/colors.h"
#include "scene/scatter_albedo.h"

namespace pertev::pbrt {
namespace {

// pbrt's defaults, per unit of the scene
constexpr Rgb kUsualSigmaA = {0.0011f, 0.0024f, 0.014f}, kUsualSigmaS = {2.55f, 3.21f, 3.77f};

MediumParameters scaled(const MediumParameters& medium, float scale) {
    return {scale * medium.sigma_a, scale * medium.sigma_s, medium.g};
}

/// Returns the coefficients sigma_a and sigma_s.
MediumParameters plain_coefficients(Parameters& parameters, const Context& context) {
    return {.sigma_a = plain_color(parameters, "sigma_a", context).value_or(kUsualSigmaA),
            .sigma_s = plain_color(parameters, "sigma_s", context).value_or(kUsualSigmaS)};
}

/// Returns the coefficients of the substance that the parameter `name` names; nothing if there is none.
std::optional<MediumParameters> named_coefficients(Parameters& parameters, std::string_view name, Sink& sink) {
    const std::string text = parameters.text(name, "", sink);
    if (text.empty()) return std::nullopt;
    const auto substance = described::find_substance(text);
    if (!substance) {
        sink.leave_out({parameters.location(),
                        fmt::format("there are no coefficients of {}{}; the others are used", shortened(text),
                                    did_you_mean(text, described::names_of_substances()))});
    }
    return substance;
}

/// Returns the medium that shows the colour, by the mean free path in units of the scene.
MediumParameters coefficients_of_color(const MaterialSource& source, const char* color_name, float scale) {
    Parameters& parameters = source.parameters;
    const TextureValue shown = source.textures.color(parameters, color_name, grey(0.5f));
    if (shown.has_image())
        parameters.leave_out({color_name}, "a medium has one colour; the image's factor is used", source.context.sink);
    const Rgb free = scale * plain_color(parameters, "mfp", source.context).value_or(grey(1)), c = shown.factor;
    const Rgb albedo = {single_scatter_albedo(c.r), single_scatter_albedo(c.g), single_scatter_albedo(c.b)};
    const Rgb sigma_t = Rgb{1, 1, 1} / free;
    return {.sigma_a = sigma_t - albedo * sigma_t, .sigma_s = albedo * sigma_t};
}

} // namespace

MediumParameters read_medium(Parameters& parameters, const Context& context) {
    const auto named = named_coefficients(parameters, "preset", context.sink);
    MediumParameters medium = named ? *named : plain_coefficients(parameters, context);
    medium = scaled(medium, static_cast<float>(parameters.number("scale", 1, context.sink)));
    medium.g = static_cast<float>(parameters.number("g", 0, context.sink));
    parameters.leave_out({"Le", "Lescale"}, "media do not emit light", context.sink);
    return described::usable_medium(medium, parameters.location(), context.sink);
}

MediumParameters read_subsurface_medium(const MaterialSource& source) {
    Parameters& parameters = source.parameters;
    Sink& sink = source.context.sink;
    const auto scale = static_cast<float>(parameters.number("scale", 1, sink));
    const auto g = static_cast<float>(parameters.number("g", 0, sink));
    const bool has_coefficients = parameters.contains("sigma_a") || parameters.contains("sigma_s");
    MediumParameters medium;
    if (source.type == "kdsubsurface") {
        medium = coefficients_of_color(source, "Kd", scale);
        medium.g = g;
    } else if (const auto named = named_coefficients(parameters, "name", sink)) {
        medium = scaled(*named, scale); // its scattering is the reduced one
        if (g != 0) sink.leave_out({parameters.location(), "g is left out, because a named substance is isotropic"});
    } else {
        medium = !has_coefficients && parameters.contains("reflectance")
                     ? coefficients_of_color(source, "reflectance", scale)
                     : scaled(plain_coefficients(parameters, source.context), scale);
        medium.g = g;
    }
    for (const char* const name : {"Kr", "Kt"}) { // pbrt-v3's
        if (plain_color(parameters, name, source.context).value_or(grey(1)) != grey(1))
            parameters.leave_out({name}, "it is 1", sink);
    }
    return described::usable_medium(medium, parameters.location(), sink);
}

} // namespace pertev::pbrt
