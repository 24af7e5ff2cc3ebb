#pragma once

// Geometry of linked nodes, and error bounds of links.

#include "radiosity/cluster_tree.h"
#include "radiosity/patches.h"

namespace pertev {

/// A patch or former patch in a link.
struct LinkedPatch {
    Vec3 corner[3]; // metres
    Vec3 normal;    // unit, out of its side
    Ball ball;
    float area = 0, longest = 0; // m2; its longest edge, metres
};

LinkedPatch linked_patch(const SceneView& scene, const Patch& patch);

/// Returns whether any part of a sphere, or of a patch, is in front of `patch`.
bool is_before(const LinkedPatch& patch, const Ball& ball);
bool is_before(const LinkedPatch& patch, const LinkedPatch& other);

/// Returns whether two spheres overlap, so that there is no direction from one to the other.
bool balls_meet(const Ball& a, const Ball& b);

/// Upper bound of the form factor from any point in `receiver` to a source with this sphere and area.
float max_form_factor(const Ball& receiver, const Ball& source, float area);

} // namespace pertev
