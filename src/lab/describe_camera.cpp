#include "lab/describe_camera.h"

#include <fmt/format.h>

#include "math/vec3.h"
#include "session/degrees.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

/// Returns the shortest text that reads back as the same floats; "-0" is written as "0".
std::string text_of(Vec3 v) { return fmt::format("{},{},{}", v.x + 0.0f, v.y + 0.0f, v.z + 0.0f); }

/// Returns the shortest text of a position, in the file's coordinates.
std::string text_of(Vec3 p, DoubleVec3 origin) {
    if (origin == DoubleVec3{0, 0, 0}) return text_of(p);
    const DoubleVec3 place = origin + to_double(p);
    return fmt::format("{},{},{}", place.x, place.y, place.z);
}

} // namespace

std::string describe_camera(const Camera& camera, DoubleVec3 origin) {
    const Transform& m = camera.world_from_camera;
    const Vec3 eye = m.translation, forward = -column(m, 2);
    // The target is as far from the camera as the camera is from the origin. If it were nearer, the direction would
    // lose digits in the difference of the two.
    float distance = 1;
    while (distance < max_component(abs(eye))) distance *= 2;
    const std::string place = fmt::format("`eye={}` `target={}` `up={}`", text_of(eye, origin),
                                          text_of(eye + distance * forward, origin), text_of(column(m, 1)));
    const ViewSize view = view_size(camera);
    return fmt::format("{} `projection={}` `{}={}` ({})", place, name_of(camera.projection), view.setting, view.value,
                       view.meaning);
}

} // namespace pertev
