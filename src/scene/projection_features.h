#pragma once

// The parts around a camera ask these functions for features of its projection (scene/camera.h) and name none. Its rays
// are made in render/camera_view.h. tools/check_includes.py lists the files that may name one.

#include <cstdint>
#include <optional>

#include "scene/camera.h"

namespace pertev {

/// Returns whether the view is stated by an angle or by intrinsics, and may be seen through a distorting lens.
HD constexpr bool has_angle_of_view(Projection projection) {
    switch (projection) {
    case Projection::Orthographic:
    case Projection::Cosine:
        return false;
    case Projection::Perspective:
        break;
    }
    return true;
}

/// Returns the projection of a picture's camera that has this number in a file; nothing if there is none.
constexpr std::optional<Projection> projection_of_picture(uint32_t number) {
    const auto projection = static_cast<Projection>(number);
    if (static_cast<uint32_t>(projection) != number) return std::nullopt;
    switch (projection) {
    case Projection::Perspective:
    case Projection::Orthographic:
        return projection;
    case Projection::Cosine:
        break;
    }
    return std::nullopt;
}

} // namespace pertev
