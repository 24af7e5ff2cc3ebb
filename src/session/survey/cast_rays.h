#pragma once

// Casts a few dozen rays against every triangle of a scene without an acceleration structure, to survey it before one
// is built. Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997. It is neither
// watertight nor exact: only for heuristics, never for the picture.

#include <span>
#include <vector>

#include "scene/scene.h"

namespace pertev {

struct SurveyRay {
    Vec3 origin, direction; // world space; the direction is unit
};

struct SurveyHit {
    float distance = kInfinity; // metres; infinite if nothing is hit
    bool is_front = false;      // whether the mesh's front is hit, even under a mirroring transform
    bool is_hit() const { return distance < kInfinity; }
};

/// The backs that rays hit: all, or only those that the camera sees (Material::double_sided).
enum class Backs { All, Shown };
/// The effect of panes of glass on rays. (Alpha-blended surfaces always stop them.)
enum class Glass { Stops, LetsThrough };

/// The nearest hit of each ray; the front if a front and a back have the same distance. A generated ground is
/// ignored. The time is proportional to rays times triangles of all instances whose box is hit. The scene has passed
/// validate().
std::vector<SurveyHit> cast_rays(const Scene& scene, std::span<const SurveyRay> rays, Backs backs = Backs::All,
                                 Glass glass = Glass::Stops);

} // namespace pertev
