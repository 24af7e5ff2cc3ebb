#include "formats/read_camera_path.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/limits.h"
#include "formats/json/json_file.h"
#include "math/transform.h"

namespace pertev {
namespace {

using gltf::JsonValue;

DoubleVec3 read_vec3(const JsonValue& value) {
    const std::array<double, 3> v = value.to_doubles<3>();
    for (const double x : v) {
        if (std::abs(x) > static_cast<double>(kMaxCoordinate))
            throw value.error(fmt::format("{}; expected at most 2^40 metres", x));
    }
    return {v[0], v[1], v[2]};
}

CameraKey read_key(const JsonValue& source, const CameraPath& before) {
    CameraKey key;
    const JsonValue time = source.at("time");
    key.time_s = time.to_double();
    if (key.time_s < 0) throw time.error(fmt::format("{}; expected seconds, at least 0", key.time_s));
    if (!before.keys.empty() && key.time_s <= before.keys.back().time_s) {
        throw time.error(fmt::format("{}; expected more than {}, the time of the previous key", key.time_s,
                                     before.keys.back().time_s));
    }
    key.eye = read_vec3(source.at("eye"));
    key.target = read_vec3(source.at("target"));
    if (const auto up = source.find("up")) key.up = to_float(read_vec3(*up));
    if (!is_finite(look_at(to_float(key.eye - key.target), {}, key.up))) {
        throw source.error("the target must differ from the eye, and its direction from up (0, 1, 0 without \"up\")");
    }
    const auto fov = source.find("fov");
    if (fov) key.fov_deg = fov->to_float();
    if (fov && !(key.fov_deg >= static_cast<float>(kMinFovDeg) && key.fov_deg <= static_cast<float>(kMaxFovDeg))) {
        throw fov->error(fmt::format("{}; expected degrees, from {} to {}", key.fov_deg, kMinFovDeg, kMaxFovDeg));
    }
    if (!before.keys.empty() && fov.has_value() != (before.keys[0].fov_deg > 0)) {
        throw source.error("only some keys have \"fov\"; expected it in all or none");
    }
    return key;
}

} // namespace

CameraPath read_camera_path(const std::filesystem::path& path) {
    const JsonFile file(path);
    CameraPath result;
    const JsonValue keys = file.root().at("keys");
    for (const JsonValue& source : keys.elements()) result.keys.push_back(read_key(source, result));
    if (result.keys.empty()) throw keys.error("the path has no keys; expected at least one");
    return result;
}

} // namespace pertev
