#pragma once

// The free axis of a room: where one would stand in it and look along it. For the default camera and the default lamps.

#include "scene/scene.h"
#include "session/survey/surroundings.h"

namespace pertev {

/// How far one can see from a point at a person's height, along the longer of x and z. Lengths in metres.
struct Aisle {
    Vec3 middle, along; // along: unit; middle: half-way between the ends
    float length = 0, floor = 0, height = 0;
};

/// `room`: what look_around() says of the scene; of kind Room.
Aisle find_aisle(const Scene& scene, const Surroundings& room);

/// How far a ray from `from` along the unit `direction` comes, metres; `otherwise` where it meets nothing.
float distance_along(const Scene& scene, Vec3 from, Vec3 direction, float otherwise);

} // namespace pertev
