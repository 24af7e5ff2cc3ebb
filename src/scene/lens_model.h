#pragma once

// Models of lenses whose pictures do not have straight lines, and the properties by which others tell them apart.
// render/lens_distortion.h has their functions; code outside it asks for these properties, not for a model.

#include <cstddef>
#include <cstdint>

#include "base/host_device.h"

namespace pertev {

enum class LensModel : uint8_t { Straight, OpenCv, Fisheye, Equirectangular, Cube };

/// Returns whether the lens may image directions beyond 90 degrees from its axis. Then its picture has no plane at
/// distance 1: areas in it are compared with solid angles, and it has no depth of field.
HD constexpr bool sees_behind(LensModel lens) {
    switch (lens) {
    case LensModel::Straight:
    case LensModel::OpenCv:
        return false;
    case LensModel::Fisheye:
    case LensModel::Equirectangular:
    case LensModel::Cube:
        break;
    }
    return true;
}

/// Returns whether the lens shows all directions, by a picture of fixed extent: it has neither an angle of view nor
/// coefficients.
HD constexpr bool is_panorama(LensModel lens) {
    switch (lens) {
    case LensModel::Straight:
    case LensModel::OpenCv:
    case LensModel::Fisheye:
        return false;
    case LensModel::Equirectangular:
    case LensModel::Cube:
        break;
    }
    return true;
}

/// Names of a lens's coefficients in their order; those in brackets may be left out.
constexpr const char* coefficient_names(LensModel lens) {
    switch (lens) {
    case LensModel::Straight:
        break;
    case LensModel::Equirectangular:
    case LensModel::Cube:
        return "no coefficients";
    case LensModel::OpenCv:
        return "k1,k2,p1,p2[,k3[,k4,k5,k6]]";
    case LensModel::Fisheye:
        return "k1,k2,k3,k4";
    }
    return "";
}

/// Returns whether a lens can have `count` coefficients, of which none means zeros.
constexpr bool takes_coefficients(LensModel lens, std::size_t count) {
    switch (lens) {
    case LensModel::Straight:
    case LensModel::Equirectangular:
    case LensModel::Cube:
        return count == 0;
    case LensModel::OpenCv:
        return count <= 8;
    case LensModel::Fisheye:
        break;
    }
    return count == 0 || count == 4;
}

} // namespace pertev
