#pragma once

// What a link is between, and what it could be wrong by.

#include "radiosity/cluster_tree.h"
#include "radiosity/patches.h"

namespace pertev {

/// A patch or what was one, as links see it.
struct LinkedPatch {
    Vec3 corner[3]; // metres
    Vec3 normal;    // unit, out of its side
    Ball ball;
    float area = 0, longest = 0; // m2; its longest edge, metres
};

LinkedPatch linked_patch(const SceneView& scene, const Patch& patch);

/// Whether anything of a ball, or of a patch, lies before `patch`.
bool is_before(const LinkedPatch& patch, const Ball& ball);
bool is_before(const LinkedPatch& patch, const LinkedPatch& other);

/// Whether they overlap: then there is no direction from one to the other.
bool balls_meet(const Ball& a, const Ball& b);

/// The form factor from any place in `receiver` to a source of this ball and area is at most so much.
float most_form_factor(const Ball& receiver, const Ball& source, float area);

} // namespace pertev
