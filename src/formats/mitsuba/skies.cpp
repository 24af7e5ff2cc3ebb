#include "formats/mitsuba/skies.h"

#include <algorithm>

#include <fmt/format.h>

#include "formats/described/transforms.h"
#include "formats/described/usable_values.h"
#include "math/portable_math.h"

namespace pertev::mitsuba {
namespace {

constexpr float kPerDegree = kPi / 180;

/// Returns the day of the year.
int64_t day_of_year(int64_t year, int64_t month, int64_t day) {
    constexpr int64_t kDaysBefore[] = {0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334};
    const bool is_leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    return kDaysBefore[std::clamp<int64_t>(month, 1, 12) - 1] + day + (is_leap && month > 2 ? 1 : 0);
}

/// Returns a direction of the world in the axes of a light. A transform without an inverse leaves it.
Vec3 light_direction(DoubleVec3 of_world, const DoubleTransform& world_from_light) {
    DoubleTransform turned = described::inverse(world_from_light);
    turned.translation = {0, 0, 0};
    return normalize_safely(to_float(described::is_finite(turned) ? transform_point(turned, of_world) : of_world));
}

} // namespace

SunPosition sun_position_at(Parameters& time, Sink& sink) {
    const auto number = [&](const char* name, double missing) {
        return static_cast<float>(time.number(name, missing, sink));
    };
    const float latitude = number("latitude", 35.6894) * kPerDegree, longitude = number("longitude", 139.6917);
    const float zone = number("timezone", 9);
    const float hours = number("hour", 15) + number("minute", 0) / 60 + number("second", 0) / 3600;
    const int64_t year = time.integer("year", 2010, sink), month = time.integer("month", 7, sink);
    const auto day = static_cast<float>(day_of_year(year, month, time.integer("day", 10, sink)));
    const float declination = 0.4093f * sin(2 * kPi * (day - 81) / 368);
    const float solar_hours = hours + 0.170f * sin(4 * kPi * (day - 80) / 373) -
                              0.129f * sin(2 * kPi * (day - 8) / 355) + (longitude - 15 * zone) / 15;
    const float angle = kPi * solar_hours / 12;
    const float up = sin(latitude) * sin(declination) - cos(latitude) * cos(declination) * cos(angle);
    const float west = -cos(declination) * sin(angle);
    const float south = -cos(latitude) * sin(declination) - sin(latitude) * cos(declination) * cos(angle);
    return {kPi / 2 - acos(clamp(up, -1.0f, 1.0f)), atan2(west, south)};
}

void set_sky(Object& emitter, Reading& reading, InfiniteLight& light) {
    Parameters& parameters = emitter.parameters;
    Sink& sink = reading.sink();
    const bool is_old = reading.context.is_old; // where y is up
    SunSky& sky = light.sky.emplace();
    sky.zenith = is_old ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    const double turbidity = parameters.number("turbidity", 3, sink);
    sky.turbidity = std::clamp(turbidity, kLeastTurbidity, kMostTurbidity);
    if (sky.turbidity != turbidity) {
        sink.warn({emitter.location(),
                   fmt::format("a turbidity of {:g} is taken as {:g}: the sky's formulas hold from {:g} to {:g}",
                               turbidity, sky.turbidity, kLeastTurbidity, kMostTurbidity)});
    }
    const auto scale = [&](const char* name) {
        return static_cast<float>(std::max(parameters.number(name, parameters.number("scale", 1, sink), sink), 0.0));
    };
    sky.sky_scale = emitter.type == "sun" ? 0 : scale("sky_scale");
    sky.sun_scale = emitter.type == "sky" ? 0 : scale("sun_scale");
    const double times = parameters.number("sun_radius_scale", 1, sink);
    const double degrees =
        parameters.number("sun_aperture", 2 * static_cast<double>(kSunRadius / kPerDegree) * times, sink);
    sky.sun_radius = static_cast<float>(std::clamp(0.5 * degrees, 0.05, 90.0)) * kPerDegree;
    const auto given = parameters.vector("sun_direction", sink);
    if (given) {
        sky.sun = light_direction(*given, light.world_from_light);
    } else {
        const SunPosition sun = sun_position_at(parameters, sink);
        const float south = cos(sun.height) * cos(sun.from_south), west = cos(sun.height) * sin(sun.from_south);
        sky.sun = is_old ? Vec3{-west, sin(sun.height), south} : Vec3{south, west, sin(sun.height)};
    }
    if (dot(sky.sun, sky.zenith) < 0) throw parameters.error("the sun is below the horizon");
    // Radiance counts per nanometre there.
    light.lumens_per_watt = kLumensOfFlatLight;
    parameters.ignore({"resolution", "complex_sun", "time_samples_per_day"});
    parameters.leave_out({"albedo"}, "the sky does not depend on the ground's", sink);
    parameters.leave_out({"stretch"}, "the sky ends at the horizon", sink);
    sink.warn(
        {FileLocation{emitter.location().file},
         "skies are those of Preetham's formulas, not of Hosek's and Wilkie's, and differ in colour and brightness"});
}

} // namespace pertev::mitsuba
