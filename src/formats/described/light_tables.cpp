#include "formats/described/light_tables.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "image/read_image.h"

namespace pertev::described {
namespace {

DoubleVec3 column(const DoubleTransform& m, double DoubleVec3::*at) { return {m.row0.*at, m.row1.*at, m.row2.*at}; }

/// Returns whether a transform does more than turn, mirror, move and scale all directions to a length whose square this
/// is.
bool differs_from_turn(const DoubleTransform& m, double square) {
    const DoubleVec3 x = column(m, &DoubleVec3::x), y = column(m, &DoubleVec3::y), z = column(m, &DoubleVec3::z);
    const auto differ = [&](double a, double b) { return !(std::abs(a - b) < 1e-4 * square); };
    return differ(dot(x, x), square) || differ(dot(y, y), square) || differ(dot(z, z), square) ||
           differ(dot(x, y), 0) || differ(dot(y, z), 0) || differ(dot(z, x), 0);
}

} // namespace

std::optional<Image> read_light_picture(const std::filesystem::path& path, Sink& sink) {
    try {
        return read_image(path, sink);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.leave_out(error.remark().and_then("; the light is left out"));
    }
    return std::nullopt;
}

double usable_angle(double degrees, double least, double most, std::string_view name, const FileLocation& location,
                    Sink& sink) {
    const double usable = degrees >= least ? std::min(degrees, most) : least; // the least for NaN
    if (usable != degrees)
        sink.leave_out({location, fmt::format("the {} of {} degrees is left out; {} is used", name, degrees, usable)});
    return usable;
}

double usable_cone(double degrees, double least, double most, std::string_view name, const FileLocation& location,
                   Sink& sink) {
    if (most >= kWidestCone && degrees > most && degrees <= 90) return most;
    return usable_angle(degrees, least, most, name, location, sink);
}

bool has_scale(const DoubleTransform& world_from_light) { return differs_from_turn(world_from_light, 1); }

void leave_out_stretch(const DoubleTransform& world_from_light, const FileLocation& location, Sink& sink) {
    const DoubleVec3 x = column(world_from_light, &DoubleVec3::x);
    if (differs_from_turn(world_from_light, dot(x, x))) {
        sink.leave_out({location, "the stretch of a light's transform is left out; it turns, moves and mirrors"});
    }
}

void set_table(IntensityTable table, Light& light) {
    float greatest = 0;
    light.kind = LightKind::Goniometric;
    light.table = make_intensity_table(std::move(table), greatest);
    light.intensity = greatest * light.intensity;
}

void set_view(double half_width, IntensityTable& picture) {
    picture.half_width = static_cast<float>(half_width);
    picture.half_height = static_cast<float>(half_width * picture.values.height / picture.values.width);
}

void set_axes(const LightAxes& axes, const DoubleTransform& world_from_light, Light& light) {
    const auto turn = [&](DoubleVec3 v) {
        return normalize_safely(to_float(
            DoubleVec3{dot(world_from_light.row0, v), dot(world_from_light.row1, v), dot(world_from_light.row2, v)}));
    };
    light.direction = turn(axes.forward);
    light.up = turn(axes.up);
    light.is_mirrored = dot(cross(light.direction, light.up), turn(axes.right)) < 0;
}

void add_light(PlacedLight light, std::vector<PlacedLight>& lights) {
    if (const auto& table = light.light.table; table != nullptr) {
        const auto same = std::ranges::find_if(lights, [&](const PlacedLight& other) {
            return other.light.table != nullptr && other.light.table->hash == table->hash;
        });
        if (same != lights.end()) light.light.table = same->light.table;
    }
    lights.push_back(std::move(light));
}

} // namespace pertev::described
