#include "formats/pbrt/colors.h"

#include <cmath>
#include <filesystem>
#include <span>

#include <fmt/format.h>

#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/files/closest_name.h"
#include "formats/files/parse_number.h"
#include "formats/pbrt/tokens.h"
#include "formats/spectra/spectrum.h"
#include "math/scalar.h"

namespace pertev::pbrt {
namespace {

Rgb not_negative(Rgb color) { return {max(color.r, 0.0f), max(color.g, 0.0f), max(color.b, 0.0f)}; }
Rgb within_1(Rgb color) { return {min(color.r, 1.0f), min(color.g, 1.0f), min(color.b, 1.0f)}; }

Rgb rgb_of(std::span<const double> numbers) {
    return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2])};
}

void leave_out_color(const Parameters& parameters, const Parameter& parameter, std::string_view why,
                     const Context& context) {
    context.sink.leave_out({parameters.location_of(parameter), fmt::format("the parameter \"{}\" of {} is left out; {}",
                                                                           parameter.name, parameters.what(), why)});
}

/// Returns the colour of an rgb or xyz parameter, or of a number; nothing for another type.
std::optional<Rgb> stated_color(const Parameters& parameters, const Parameter& parameter) {
    const std::span<const double> numbers = parameter.numbers;
    switch (parameter.type) {
    case ParameterType::Rgb: {
        if (numbers.size() < 3) return std::nullopt;
        if (!parameters.color_space()) return rgb_of(numbers);
        const ColorMatrix& m = *parameters.color_space();
        double converted[3] = {};
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t k = 0; k < 3; ++k) converted[c] += m[c][k] * numbers[k];
        return rgb_of(converted);
    }
    case ParameterType::Xyz: {
        if (numbers.size() < 3) return std::nullopt;
        const double sum = numbers[0] + numbers[1] + numbers[2];
        if (!(numbers[1] > 0 && sum > 0)) return Rgb{};
        return static_cast<float>(numbers[1]) * color_of_chromaticity(numbers[0] / sum, numbers[1] / sum);
    }
    case ParameterType::Float:
    case ParameterType::Integer:
        return grey(static_cast<float>(numbers.front()));
    case ParameterType::Bool:
    case ParameterType::String:
    case ParameterType::Point2:
    case ParameterType::Vector2:
    case ParameterType::Point3:
    case ParameterType::Vector3:
    case ParameterType::Normal3:
    case ParameterType::Spectrum:
    case ParameterType::Blackbody:
    case ParameterType::Texture:
    case ParameterType::Transform:
        break;
    }
    return std::nullopt;
}

/// Reads pairs of wavelength and value from a file of text, in which # begins a comment; nothing if it has none.
std::optional<Spectrum> read_spectrum(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    Tokens tokens({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    std::vector<double> pairs;
    while (tokens.peek().kind == TokenKind::Word) {
        std::string_view word = tokens.next().text;
        if (const auto number = parse_float<double>(word)) pairs.push_back(*number);
    }
    if (pairs.size() < 2) return std::nullopt;
    return make_spectrum(pairs);
}

/// Returns the spectrum of a parameter that has wavelengths or is a black body; nothing for another.
std::optional<Spectrum> stated_spectrum(const Parameter& parameter) {
    if (parameter.type == ParameterType::Blackbody) {
        const double temperature = parameter.numbers.front();
        if (!(temperature > 0 && temperature < 1e9)) return std::nullopt;
        Spectrum spectrum = black_body(temperature);
        if (parameter.numbers.size() > 1) {
            for (double& value : spectrum.values) value *= parameter.numbers[1];
        }
        return spectrum;
    }
    if (parameter.type != ParameterType::Spectrum) return std::nullopt;
    if (parameter.numbers.size() == 1) return Spectrum{{550}, {parameter.numbers.front()}};
    if (!parameter.numbers.empty()) return make_spectrum(parameter.numbers);
    return std::nullopt;
}

/// Returns NAME of `metal-NAME-eta`, or of a file `NAME.eta.spd`; the same text if it has another form.
std::string metal_name(std::string text) {
    if (const std::size_t folder = text.find_last_of("/\\"); folder != std::string::npos) text.erase(0, folder + 1);
    if (text.starts_with("metal-")) text.erase(0, 6);
    return text.substr(0, text.find_first_of("-."));
}

bool is_name_of_spectrum(const std::string& name) {
    if (name.starts_with("metal-")) return find_metal_index(metal_name(name)).has_value();
    if (name.starts_with("glass-")) return find_glass(name.substr(6)).has_value();
    return find_illuminant(name).has_value();
}

/// Says why no colour comes of a name without a file.
std::string fault_of_name(const std::string& name) {
    if (is_name_of_spectrum(name)) return fmt::format("the spectrum {} is for another kind of parameter", name);
    const std::vector<std::string> names = names_of_spectra();
    return fmt::format("there is no spectrum {}{}", shortened(name),
                       did_you_mean(name, std::vector<std::string_view>(names.begin(), names.end())));
}

/// Returns the colour of a parameter that names a file with a spectrum. Otherwise it leaves the parameter out.
template <class OfSpectrum>
std::optional<Rgb> color_of_file(const Parameters& parameters, const Parameter& parameter, const Context& context,
                                 const OfSpectrum& of_spectrum) {
    const std::string& name = parameter.texts.front();
    std::string fault;
    try {
        const auto path =
            context.access.find(base_of(context, parameters.location_of(parameter), name), name, context.sink);
        if (path) {
            const auto spectrum = read_spectrum(*path);
            const auto color = spectrum ? std::optional<Rgb>(of_spectrum(*spectrum)) : std::nullopt;
            if (color && is_finite(*color)) return color;
            fault = fmt::format("{} has no pairs of wavelength and value", shortened(name));
        } else {
            fault = fault_of_name(name);
        }
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        fault = error.location() == parameters.location_of(parameter) ? "it " + error.reason() : error.what();
    }
    leave_out_color(parameters, parameter, fault, context);
    return std::nullopt;
}

/// Returns the colour of a parameter; `of_spectrum` converts spectra.
template <class OfSpectrum>
std::optional<Rgb> color_of(Parameters& parameters, std::string_view name, const Context& context,
                            const OfSpectrum& of_spectrum) {
    const Parameter* const found = parameters.find(name);
    if (found == nullptr) return std::nullopt;
    if (found->type == ParameterType::Spectrum && found->numbers.empty())
        return color_of_file(parameters, *found, context, of_spectrum);
    std::optional<Rgb> color = stated_color(parameters, *found);
    if (!color) {
        if (const auto spectrum = stated_spectrum(*found)) color = of_spectrum(*spectrum);
    }
    if (color && is_finite(*color)) return color;
    leave_out_color(parameters, *found, "expected a colour, a \"blackbody\" or a spectrum", context);
    return std::nullopt;
}

} // namespace

Rgb light_color(Parameters& parameters, std::string_view name, Rgb missing, const Context& context) {
    const Parameter* const found = parameters.find(name);
    if (found == nullptr) return missing;
    if (found->type == ParameterType::Spectrum && !found->texts.empty()) {
        if (const auto color = find_illuminant(found->texts.front())) return *color;
    }
    const auto of_spectrum = [&](const Spectrum& spectrum) {
        return context.is_version_3 ? color_of_light(spectrum) : color_of_unit_light(spectrum);
    };
    return not_negative(color_of(parameters, name, context, of_spectrum).value_or(missing));
}

std::optional<Rgb> reflectance(Parameters& parameters, std::string_view name, const Context& context) {
    const auto color = color_of(parameters, name, context, color_of_reflectance);
    if (!color) return std::nullopt;
    return within_1(not_negative(*color));
}

std::optional<Rgb> plain_color(Parameters& parameters, std::string_view name, const Context& context) {
    const auto color = color_of(parameters, name, context, means_of_channels);
    if (!color) return std::nullopt;
    return not_negative(*color);
}

std::optional<Rgb> index_of_channels(Parameters& parameters, std::string_view name, const Context& context) {
    const Parameter* const found = parameters.find(name);
    if (found == nullptr) return std::nullopt;
    if (found->type == ParameterType::Spectrum && !found->texts.empty()) {
        const std::string& text = found->texts.front();
        const bool is_absorption = text.find("-k") != std::string::npos || text.find(".k") != std::string::npos;
        if (const auto index = find_metal_index(metal_name(text))) return is_absorption ? index->k : index->eta;
        if (const auto glass = find_glass(metal_name(text.substr(text.starts_with("glass-") ? 6 : 0))))
            return is_absorption ? Rgb{} : grey(glass->ior);
    }
    return plain_color(parameters, name, context);
}

std::optional<GlassIndex> glass_index(Parameters& parameters, std::string_view name, const Context& context) {
    const Parameter* const found = parameters.find(name);
    if (found == nullptr) return std::nullopt;
    if (found->type == ParameterType::Spectrum && !found->texts.empty() && found->texts.front().starts_with("glass-")) {
        if (const auto glass = find_glass(found->texts.front().substr(6))) return glass;
    }
    const auto index = plain_color(parameters, name, context);
    if (!index) return std::nullopt;
    return GlassIndex{index->g, 0};
}

} // namespace pertev::pbrt
