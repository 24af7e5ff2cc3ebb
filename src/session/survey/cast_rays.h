#pragma once

// A few dozen rays against every triangle of a scene, without any acceleration structure: to look around in it before
// one is built. Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997. Not watertight
// and not exact: for guesses, never for the picture.

#include <span>
#include <vector>

#include "scene/scene.h"

namespace pertev {

struct LookRay {
    Vec3 origin, direction; // world space; the direction is unit
};

struct LookHit {
    float distance = kInfinity; // metres; infinite: nothing there
    bool is_front = false;      // the mesh's front side is met: a mirroring transform does not turn it round
    bool is_hit() const { return distance < kInfinity; }
};

/// Which backs rays meet: all, or those alone that the camera sees (Material::double_sided).
enum class Backs { All, Shown };
/// Whether panes of glass stop rays. (Surfaces of blended alpha always do.)
enum class Glass { Stops, LetsThrough };

/// The nearest hit of each ray; the front where a front and a back lie at one distance. A made-up ground is not met.
/// Time: rays times triangles of all instances whose box some ray meets. The scene has been through validate().
std::vector<LookHit> cast_rays(const Scene& scene, std::span<const LookRay> rays, Backs backs = Backs::All,
                               Glass glass = Glass::Stops);

} // namespace pertev
