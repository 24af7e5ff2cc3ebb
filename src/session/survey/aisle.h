#pragma once

// The free axis of a room, along which a person would look, for the default camera and the default lights.

#include "scene/scene.h"
#include "session/survey/surroundings.h"

namespace pertev {

/// The line of sight from a point at a person's height, along the longer of x and z. Lengths in metres.
struct Aisle {
    Vec3 middle, along; // `along` is unit; `middle` is half-way between the ends
    float length = 0, floor = 0, height = 0;
};

/// `room` is the result of survey_surroundings() for the scene, of kind Room.
Aisle find_aisle(const Scene& scene, const Surroundings& room);

/// Distance that a ray from `from` along the unit `direction` travels, metres; `otherwise` if it hits nothing.
float distance_along(const Scene& scene, Vec3 from, Vec3 direction, float otherwise);

} // namespace pertev
