#pragma once

// Lights of pbrt and Mitsuba whose intensity follows a table: pictures, and cones with the edges of either renderer.

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "math/double_transform.h"
#include "scene/intensity_table.h"
#include "scene/light.h"

namespace pertev::described {

/// Reads the values of a light's table. Returns nothing for an unreadable picture, which is left out with the light.
std::optional<Image> read_light_picture(const std::filesystem::path& path, Sink& sink);

/// Returns the nearest angle in [least, most], degrees. If that is another one, it warns that the parameter `name` at
/// `location` is left out.
double usable_angle(double degrees, double least, double most, std::string_view name, const FileLocation& location,
                    Sink& sink);

inline constexpr double kWidestCone = 89.9; // degrees

/// usable_angle() for the half angle of a cone. If `most` is the widest cone, one up to 90 degrees counts as that
/// without a warning, because it looks the same.
double usable_cone(double degrees, double least, double most, std::string_view name, const FileLocation& location,
                   Sink& sink);

/// Returns whether a transform does more than turn, move and mirror.
bool has_scale(const DoubleTransform& world_from_light);

/// Warns that a transform does not scale all directions equally. Light that depends on the direction alone would bend.
void leave_out_stretch(const DoubleTransform& world_from_light, const FileLocation& location, Sink& sink);

/// Makes `light` Goniometric with `table`. The light's intensity becomes its intensity where the table is 1.
void set_table(IntensityTable table, Light& light);

/// Sets the tangents of half the angles of view of a picture; `half_width` is the tangent across it.
void set_view(double half_width, IntensityTable& picture);

/// The axes of a light's frame in its own coordinates (scene/intensity_table.h).
struct LightAxes {
    DoubleVec3 right, up, forward;
};
/// Sets the light's directions by its transform.
void set_axes(const LightAxes& axes, const DoubleTransform& world_from_light, Light& light);

/// Adds a light; one with the same table as one before shares it.
void add_light(PlacedLight light, std::vector<PlacedLight>& lights);

} // namespace pertev::described
