#include "formats/gltf/camera.h"

#include <fmt/format.h>

#include "base/limits.h"
#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

float positive(const JsonValue& value, float below) {
    const float number = value.to_float();
    if (!(number > 0 && number < below)) {
        throw value.error(below == kInfinity ? fmt::format("{}; expected a number above 0", number)
                                             : fmt::format("{}; expected between 0 and {}", number, below));
    }
    return number;
}

} // namespace

Camera read_camera(const JsonValue& source, Sink& sink) {
    Camera camera;
    const auto attempt = [&](const char* what, const auto& read) {
        read_or_leave_out(fmt::format("{} of {}", what, source.pointer()), sink, read);
    };
    attempt("the name", [&] { camera.name = source.string_or("name", ""); });
    const std::string type = source.string_or("type", "");
    if (type == "perspective") {
        const JsonValue perspective = source.at("perspective");
        // Without an angle that makes sense it is that of cameras without any.
        attempt("the angle", [&] { camera.fov_y = positive(perspective.at("yfov"), kPi); });
        attempt("the aspect", [&] {
            if (const auto aspect = perspective.find("aspectRatio")) camera.aspect = positive(*aspect, kInfinity);
        });
    } else if (type == "orthographic") {
        const JsonValue orthographic = source.at("orthographic");
        camera.projection = Projection::Orthographic;
        const float half_width = abs(orthographic.at("xmag").to_float());
        const float half_height = abs(orthographic.at("ymag").to_float());
        if (!(half_width > 0 && half_height > 0))
            throw orthographic.error("xmag or ymag is 0; expected any other number");
        if (half_width > kMaxCoordinate || half_height > kMaxCoordinate) {
            throw orthographic.error("xmag or ymag is above 2^40; expected a number of metres");
        }
        camera.ortho_height = 2 * half_height;
        camera.aspect = half_width / half_height;
    } else {
        throw source.error(fmt::format("type \"{}\"; expected perspective or orthographic", type));
    }
    return camera;
}

} // namespace pertev::gltf
