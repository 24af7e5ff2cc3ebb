#pragma once

// Flat emitters over a floor, and closed forms of their form factors from points of the floor.

#include <cmath>
#include <cstdint>

#include "scene/mesh.h"

namespace pertev::test {

inline constexpr double kPiInDouble = 3.141592653589793;

/// Returns the form factor of a parallel rectangle with a corner above the point; its sides are relative to its height.
inline double corner_factor(double x, double y) {
    const double sx = std::sqrt(1 + x * x), sy = std::sqrt(1 + y * y);
    return (x / sx * std::atan(y / sx) + y / sy * std::atan(x / sy)) / (2 * kPiInDouble);
}

/// Returns the form factor of a rectangle from -x to x and from -z to z at `height`, from the point (at_x, at_z).
inline double rectangle_factor(double x, double z, double height, double at_x, double at_z) {
    double sum = 0;
    for (const double right : {x - at_x, x + at_x}) {
        for (const double near : {z - at_z, z + at_z}) sum += corner_factor(right / height, near / height);
    }
    return sum;
}

/// Returns the form factor of a disc around the axis, from a point at distance `off` from the axis.
inline double disc_factor(double radius, double height, double off) {
    const double a = off * off, h = height * height, r = radius * radius;
    return 0.5 * (1 - (a + h - r) / std::sqrt((a + h + r) * (a + h + r) - 4 * a * r));
}

/// A disc around the y axis that faces down.
inline Mesh disc(float height, float radius) {
    constexpr uint32_t kCorners = 256;
    Mesh mesh;
    mesh.positions.push_back({0, height, 0});
    for (uint32_t i = 0; i < kCorners; ++i) {
        const double angle = 2 * kPiInDouble * i / kCorners;
        mesh.positions.push_back(
            {radius * static_cast<float>(std::cos(angle)), height, radius * static_cast<float>(std::sin(angle))});
        mesh.indices.insert(mesh.indices.end(), {0, 1 + i, 1 + (i + 1) % kCorners});
    }
    return mesh;
}

} // namespace pertev::test
