#include "formats/described/usable_values.h"

#include <fmt/format.h>

#include "base/limits.h"
#include "math/scalar.h"

namespace pertev::described {

bool is_light(Rgb strength) { return is_finite(strength) && strength.r >= 0 && strength.g >= 0 && strength.b >= 0; }

void leave_out_strength(const std::string& which, const FileLocation& location, Sink& sink) {
    sink.leave_out({location, which + " light is left out, because its strength is not a finite number of at least 0"});
}

bool is_near(Vec3 position) { return is_finite(position) && max_component(abs(position)) <= kMaxCoordinate; }

std::string fault_of(const Camera& camera) {
    if (!is_near(camera.world_from_camera.translation)) return "it lies beyond 2^40 metres";
    if (!(camera.fov_y > 0 && camera.fov_y < kPi) ||
        !(camera.ortho_height > 0 && pertev::is_finite(camera.ortho_height)))
        return "its view has no size, or none that is finite";
    if (!(camera.aperture_radius >= 0 && camera.aperture_radius <= kMaxCoordinate) ||
        !(camera.focus_distance > 0 && camera.focus_distance <= kMaxCoordinate))
        return "its aperture or focus is not a length";
    return "";
}

void keep_usable(Material& material, const FileLocation& location, Sink& sink) {
    constexpr float kMostScale = 0x1p40f;
    visit_parameters(
        material,
        [&](float& value, const char* name, float least, float most) {
            if (pertev::is_finite(value)) return;
            const float nearest = value > 0 ? most : clamp(0.0f, least, most);
            sink.leave_out(
                {location, fmt::format("{} of a material is {} and left out; it is {}", name, value, nearest)});
            value = nearest;
        },
        [&](TextureRef& ref, const char* name) {
            bool is_usable = true;
            for (const float m : {ref.m00, ref.m01, ref.m02, ref.m10, ref.m11, ref.m12})
                is_usable = is_usable && abs(m) <= kMostScale;
            if (is_usable) return;
            sink.leave_out({location, fmt::format("the mapping of {} is left out, because it is too large", name)});
            const TextureRef plain;
            ref.m00 = plain.m00, ref.m01 = plain.m01, ref.m02 = plain.m02;
            ref.m10 = plain.m10, ref.m11 = plain.m11, ref.m12 = plain.m12;
        });
}

} // namespace pertev::described
