#include "formats/mitsuba/media.h"

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/described/described_medium.h"
#include "formats/mitsuba/colors.h"

namespace pertev::mitsuba {

float Media::read_phase(Object& medium) {
    const std::vector<Object*> phases = objects_in(medium, "phase", reading_);
    if (phases.empty()) return 0;
    Object& phase = *phases.front();
    float g = 0;
    if (phase.type == "hg") {
        g = static_cast<float>(phase.parameters.number("g", 0.8, reading_.sink()));
    } else if (phase.type != "isotropic") {
        reading_.sink().leave_out(
            {phase.location(),
             fmt::format("the phase function {} is not supported; an isotropic one is used", shortened(phase.type))});
        return 0;
    }
    phase.parameters.leave_out_unknown(reading_.sink());
    return g;
}

MediumParameters Media::read_homogeneous(Object& medium) {
    Parameters& parameters = medium.parameters;
    const auto color = [&](std::string_view name, Rgb missing) {
        const Parameter* const found = parameters.find(name);
        Object* const volume = found != nullptr ? reading_.object_of(medium, *found) : nullptr;
        if (volume == nullptr || volume->tag != "volume" || volume->type != "constvolume")
            return read_color(medium, name, ColorUse::Index, missing, reading_);
        const Rgb value = read_color(*volume, "value", ColorUse::Index, missing, reading_);
        volume->parameters.leave_out_unknown(reading_.sink());
        return value;
    };
    const auto scale = static_cast<float>(parameters.number("scale", 1, reading_.sink()));
    MediumParameters read;
    if (parameters.has("sigma_a") || parameters.has("sigma_s")) {
        read.sigma_a = color("sigma_a", {0, 0, 0});
        read.sigma_s = color("sigma_s", {0, 0, 0});
    } else if (const std::string name = parameters.text("material", "", reading_.sink()); !name.empty()) {
        const auto substance = described::find_substance(name);
        if (!substance) throw parameters.error(fmt::format("there are no coefficients of {}", shortened(name)));
        read = *substance;
    } else {
        const Rgb sigma_t = color("sigma_t", {1, 1, 1}), albedo = color("albedo", {0.75f, 0.75f, 0.75f});
        read.sigma_s = albedo * sigma_t;
        read.sigma_a = sigma_t - read.sigma_s;
    }
    read.sigma_a = scale * read.sigma_a;
    read.sigma_s = scale * read.sigma_s;
    read.g = read_phase(medium);
    parameters.ignore({"sample_emitters", "has_spectral_extinction", "strategy"});
    parameters.leave_out_unknown(reading_.sink());
    return described::usable_medium(read, medium.location(), reading_.sink());
}

std::optional<uint32_t> Media::read(Object& medium) {
    const auto [known, is_new] = known_.try_emplace(medium.number);
    if (!is_new) return known->second;
    try {
        if (medium.type != "homogeneous")
            throw medium.parameters.error(fmt::format("media of the type {} are left out", shortened(medium.type)));
        reading_.parts.media.push_back(read_homogeneous(medium));
        known->second = static_cast<uint32_t>(reading_.parts.media.size() - 1);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        reading_.sink().leave_out(error.remark().and_then("; it is a vacuum"));
    }
    return known->second;
}

Media::OfShape Media::of_shape(Object& shape) {
    OfShape found;
    for (const char* const side : {"interior", "exterior"}) {
        const Parameter* const parameter = shape.parameters.find(side);
        if (parameter == nullptr) continue;
        Object* const medium = reading_.object_of(shape, *parameter);
        if (medium == nullptr || medium->tag != "medium") continue;
        found.ends_medium = true;
        const auto index = read(*medium);
        (side == std::string_view("interior") ? found.inside : found.outside) = index;
    }
    return found;
}

void Media::set_around(Object& sensor) {
    const std::vector<Object*> media = objects_in(sensor, "medium", reading_);
    const std::optional<uint32_t> medium = media.empty() ? std::nullopt : read(*media.front());
    if (!at_sensor_) at_sensor_ = medium;
    if (medium != *at_sensor_)
        reading_.sink().leave_out({sensor.location(), "the medium of a sensor is left out, because that of the first "
                                                      "one differs"});
}

void Media::finish() { described::finish_media(at_sensor_.value_or(std::nullopt), reading_.sink(), reading_.parts); }

} // namespace pertev::mitsuba
