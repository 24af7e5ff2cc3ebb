#include "formats/mitsuba/colors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/files/closest_name.h"
#include "formats/mitsuba/parse_values.h"
#include "formats/spectra/spectrum.h"
#include "math/scalar.h"

namespace pertev::mitsuba {
namespace {

Rgb limited(Rgb color, ColorUse use) {
    const float most = use == ColorUse::Reflectance ? 1.0f : 0x1p126f;
    const auto channel = [&](float x) { return clamp(x, 0.0f, most); };
    return {channel(color.r), channel(color.g), channel(color.b)};
}

Rgb of_spectrum(const Spectrum& spectrum, ColorUse use) {
    return use == ColorUse::Light ? color_of_light(spectrum) : color_under_d65(spectrum);
}

/// A spectrum of pairs; as colour or light it is 0 beyond its wavelengths.
Spectrum bounded_spectrum(std::span<const double> pairs, ColorUse use) {
    Spectrum spectrum = make_spectrum(pairs);
    if (use == ColorUse::Index || spectrum.values.empty()) return spectrum;
    constexpr double kEdge = 1e-3; // nm
    spectrum.wavelengths_nm.insert(spectrum.wavelengths_nm.begin(), spectrum.wavelengths_nm.front() - kEdge);
    spectrum.wavelengths_nm.push_back(spectrum.wavelengths_nm.back() + kEdge);
    spectrum.values.insert(spectrum.values.begin(), 0);
    spectrum.values.push_back(0);
    return spectrum;
}

/// The radiance of a black body, W/(sr m2 nm), as Mitsuba has it.
Spectrum radiance_of_black_body(double temperature_k) {
    constexpr double kPeak = 4.095674682e-15; // Planck's law at the wavelength of Wien's, for 1 K
    const double square = temperature_k * temperature_k, most = kPeak * square * square * temperature_k;
    Spectrum spectrum = black_body(temperature_k); // relative to its peak
    for (double& value : spectrum.values) value *= most;
    return spectrum;
}

/// Reads pairs of wavelength and value from a file of text, in which # begins a comment.
Spectrum spectrum_of_file(const std::filesystem::path& path, ColorUse use) {
    const std::vector<std::byte> bytes = read_file(path);
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::vector<double> pairs;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, std::min(end, text.find('#')));
        const std::vector<double> numbers = parse_numbers(line);
        if (numbers.size() >= 2 && std::isfinite(numbers[0]) && std::isfinite(numbers[1]))
            pairs.insert(pairs.end(), {numbers[0], numbers[1]});
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return bounded_spectrum(pairs, use);
}

std::optional<Rgb> of_file(const std::string& name, const FileLocation& from, ColorUse use, Reading& reading) {
    const auto path = find_file(reading.context, from, name);
    if (!path) throw Error(ErrorCode::BadInput, from, fmt::format("there is no file {}", shortened(name)));
    const Spectrum spectrum = spectrum_of_file(*path, use);
    if (spectrum.values.empty())
        throw Error(ErrorCode::BadInput, from,
                    fmt::format("the file {} has no lines of wavelength and value", shortened(name)));
    return of_spectrum(spectrum, use);
}

std::optional<Rgb> of_black_body(double temperature_k, double scale, ColorUse use) {
    if (!(temperature_k > 1 && temperature_k < 1e9)) return std::nullopt;
    return static_cast<float>(scale) * of_spectrum(radiance_of_black_body(temperature_k), use);
}

/// Numbers of a text or a parameter: "400, 500".
std::vector<double> numbers_of_text(Object& object, std::string_view name, Sink& sink) {
    return parse_numbers(object.parameters.text(name, "", sink));
}

std::optional<Rgb> of_list(Object& object, ColorUse use, Sink& sink) {
    std::vector<double> nm = numbers_of_text(object, "wavelengths", sink);
    const std::vector<double> values = numbers_of_text(object, "values", sink);
    if (object.type == "regular") {
        const double low = object.parameters.number("wavelength_min", 360, sink),
                     high = object.parameters.number("wavelength_max", 830, sink);
        const std::size_t count = values.size();
        nm.clear();
        for (std::size_t i = 0; i < count; ++i)
            nm.push_back(low + (high - low) * static_cast<double>(i) /
                                   static_cast<double>(std::max<std::size_t>(count - 1, 1)));
    }
    if (values.empty() || nm.size() != values.size()) return std::nullopt;
    std::vector<double> pairs;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(nm[i]) || !std::isfinite(values[i])) return std::nullopt;
        pairs.insert(pairs.end(), {nm[i], values[i]});
    }
    return of_spectrum(bounded_spectrum(pairs, use), use);
}

} // namespace

std::optional<Rgb> color_of_object(Object& object, ColorUse use, Reading& reading) {
    const Depth depth(reading.depth, object); // the colour of one may be another
    Sink& sink = reading.sink();
    Parameters& parameters = object.parameters;
    std::optional<Rgb> color;
    constexpr std::array<std::string_view, 8> kKnown = {"uniform",   "d65",  "regular", "irregular",
                                                        "blackbody", "srgb", "rgb",     "rawconstant"};
    if (object.type == "uniform" || object.type == "rawconstant") {
        const Parameter* const value = parameters.find("value");
        color = grey(1);
        if (value != nullptr && !value->numbers.empty()) color = grey(static_cast<float>(value->numbers[0]));
        if (value != nullptr && value->numbers.size() == 3)
            color = Rgb{static_cast<float>(value->numbers[0]), static_cast<float>(value->numbers[1]),
                        static_cast<float>(value->numbers[2])};
    } else if (object.type == "d65") {
        const auto scale = static_cast<float>(parameters.number("scale", 1, sink));
        color = grey(1);
        if (const Parameter* const value = parameters.find("color")) color = color_of(object, *value, use, reading);
        if (color) color = scale * *color;
    } else if (object.type == "regular" || object.type == "irregular") {
        color = of_list(object, use, sink);
    } else if (object.type == "blackbody") {
        parameters.ignore({"wavelength_min", "wavelength_max"});
        color = of_black_body(parameters.number("temperature", 5000, sink), parameters.number("scale", 1, sink), use);
    } else if (object.type == "srgb" || object.type == "rgb") {
        if (const Parameter* const value = parameters.find(parameters.contains("color") ? "color" : "value"))
            color = color_of(object, *value, use, reading);
    } else {
        throw parameters.error(
            fmt::format("there is no spectrum {}{}", shortened(object.type), did_you_mean(object.type, kKnown)));
    }
    parameters.leave_out_unknown(sink);
    if (!color || !is_finite(*color)) throw parameters.error(fmt::format("{} is unreadable", parameters.what()));
    return limited(*color, use);
}

std::optional<Rgb> color_of(Object& object, const Parameter& parameter, ColorUse use, Reading& reading) {
    const FileLocation location = object.parameters.location_of(parameter);
    try {
        const std::vector<double>& numbers = parameter.numbers;
        std::optional<Rgb> color;
        switch (parameter.type) {
        case ParameterType::Rgb:
            color = Rgb{static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2])};
            break;
        case ParameterType::Float:
        case ParameterType::Integer:
            color = grey(static_cast<float>(numbers[0]));
            break;
        case ParameterType::Spectrum:
            if (!parameter.texts.empty()) {
                color = of_file(parameter.texts[0], location, use, reading);
            } else if (numbers.size() > 1) {
                color = of_spectrum(bounded_spectrum(numbers, use), use);
            } else { // light of Mitsuba 3 is equal at all wavelengths, which is not white
                const bool is_flat = use == ColorUse::Light && !reading.context.is_old;
                color = is_flat ? color_of_light({{550}, {numbers[0]}}) : grey(static_cast<float>(numbers[0]));
            }
            break;
        case ParameterType::Blackbody:
            color = of_black_body(numbers[0], numbers.size() > 1 ? numbers[1] : 1, use);
            break;
        case ParameterType::Texture: {
            Object* const spectrum = reading.object_of(object, parameter);
            if (spectrum == nullptr) return std::nullopt;
            if (spectrum->tag == "spectrum") return color_of_object(*spectrum, use, reading);
            break;
        }
        case ParameterType::Bool:
        case ParameterType::String:
        case ParameterType::Point2:
        case ParameterType::Vector2:
        case ParameterType::Point3:
        case ParameterType::Vector3:
        case ParameterType::Normal3:
        case ParameterType::Xyz:
        case ParameterType::Transform:
            break;
        }
        if (color && is_finite(*color)) return limited(*color, use);
        throw Error(ErrorCode::BadInput, location, "expected a colour or a spectrum");
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        reading.sink().leave_out(error.remark().and_then(
            fmt::format("; \"{}\" of {} is left out", shortened(parameter.name), object.parameters.what())));
        return std::nullopt;
    }
}

Rgb read_color(Object& object, std::string_view name, ColorUse use, Rgb missing, Reading& reading) {
    const Parameter* const found = object.parameters.find(name);
    return found == nullptr ? missing : color_of(object, *found, use, reading).value_or(missing);
}

} // namespace pertev::mitsuba
