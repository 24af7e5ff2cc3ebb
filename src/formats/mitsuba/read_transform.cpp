#include "formats/mitsuba/read_transform.h"

#include <cmath>

#include "formats/described/transforms.h"

namespace pertev::mitsuba {
namespace {

using described::is_finite;

DoubleVec3 vec3_of(const std::vector<double>& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

std::optional<DoubleTransform> of_matrix(const std::vector<double>& m, bool is_flat) {
    DoubleTransform to;
    if (m.size() == 16) {
        to = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
        const double w = m[15];
        if (w == 0) return std::nullopt;
        if (w != 1) { // the last row is (0, 0, 0, w)
            for (DoubleVec3* const part : {&to.row0, &to.row1, &to.row2, &to.translation}) *part = *part / w;
        }
        return to;
    }
    if (m.size() != 9) return std::nullopt;
    if (!is_flat) return DoubleTransform{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}, {0, 0, 0}};
    to.row0 = {m[0], m[1], 0}, to.row1 = {m[3], m[4], 0};
    to.translation = {m[2], m[5], 0};
    return to;
}

std::optional<DoubleTransform> look_at(const TransformStep& step) {
    if (step.origin.size() < 3 || step.target.size() < 3) return std::nullopt;
    const DoubleVec3 origin = vec3_of(step.origin), ahead = vec3_of(step.target) - origin;
    DoubleVec3 up = {0, 0, 0};
    if (step.up.size() == 3) up = vec3_of(step.up);
    const DoubleVec3 forward = ahead / std::sqrt(dot(ahead, ahead));
    if (dot(cross(up, forward), cross(up, forward)) == 0) // any direction across
        up = std::abs(forward.x) > std::abs(forward.y) ? DoubleVec3{-forward.z, 0, forward.x}
                                                       : DoubleVec3{0, forward.z, -forward.y};
    const DoubleVec3 across = cross(up, forward), left = across / std::sqrt(dot(across, across)),
                     above = cross(forward, left);
    return DoubleTransform{
        {left.x, above.x, forward.x}, {left.y, above.y, forward.y}, {left.z, above.z, forward.z}, origin};
}

} // namespace

std::optional<DoubleTransform> make_transform(std::string_view kind, const TransformStep& step) {
    std::optional<DoubleTransform> made;
    if (kind == "matrix") {
        made = of_matrix(step.matrix, step.is_flat);
    } else if (kind == "translate") {
        made = described::translation_by(vec3_of(step.vector));
    } else if (kind == "scale") {
        made = described::scale_by(vec3_of(step.vector));
    } else if (kind == "rotate") {
        made = described::make_rotation(step.angle_deg, vec3_of(step.vector));
    } else {
        made = look_at(step);
    }
    return made && is_finite(*made) ? made : std::nullopt;
}

std::vector<double> numbers_of(const DoubleTransform& m) {
    return {m.row0.x, m.row0.y,        m.row0.z, m.translation.x, m.row1.x, m.row1.y,
            m.row1.z, m.translation.y, m.row2.x, m.row2.y,        m.row2.z, m.translation.z};
}

DoubleTransform transform_of_rows(const std::vector<double>& m) {
    return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
}

} // namespace pertev::mitsuba
