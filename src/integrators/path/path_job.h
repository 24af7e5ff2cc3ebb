#pragma once

// What a path tracer renders: views and numbers that every vertex of every path is given. And which code it needs: a
// mask of features, of which one table says what has been compiled.

#include <cstdint>

#include "device_scene/moved_surface.h"
#include "integrators/path/path_settings.h"
#include "render/film_view.h"
#include "render/light_paths/light_path_view.h"
#include "render/picture_view.h"

namespace pertev {

struct PathJob {
    PictureView picture;
    PathSettings settings;
    FilmView film;
    LightPathView layers;  // may be none
    bool is_meter = false; // the picture is that of the irradiance of what the camera sees, W/m2
};

/// What a scene and a request make use of. Code for what is not there would cost others registers.
using Features = uint32_t;
enum Feature : Features {
    kTextured = 1, // of colours, emission or normals
    kAlpha = 2,    // surfaces that a ray may pass, emitters among them
    kLayered = 4,  // other surfaces than diffuse ones
    kMoving = 8,   // paths have a time
};
inline constexpr Features kPlainDiffuse = 0, kDiffuse = kTextured | kAlpha, kAllMaterials = kDiffuse | kLayered;

HD constexpr MaterialsKnown known_of(Features features) {
    return (features & kLayered) != 0   ? MaterialsKnown::Nothing
           : (features & kDiffuse) != 0 ? MaterialsKnown::Diffuse
                                        : MaterialsKnown::PlainDiffuse;
}
HD constexpr MotionKnown motion_of(Features features) {
    return (features & kMoving) != 0 ? MotionKnown::Some : MotionKnown::None;
}

inline Features features_of(MaterialsKnown known) {
    switch (known) {
    case MaterialsKnown::Nothing:
        break;
    case MaterialsKnown::Diffuse:
        return kDiffuse;
    case MaterialsKnown::PlainDiffuse:
        return kPlainDiffuse;
    }
    return kAllMaterials;
}

/// Returns what code has to know of the job. The depth that a moving camera sees is along its axis at the ray's time.
inline Features features_for(const PathJob& job) {
    const PictureView& picture = job.picture;
    const bool has_times =
        picture.scene.motions.is_there() ||
        (picture.camera.motion.moves() && !job.film.frame.is_there() && (job.film.aovs & kAovDepth) != 0);
    return features_of(picture.scene.known) | (has_times ? Features{kMoving} : 0);
}

/// Code for a mask of features chooses lights by this class (shading/light_set.h). A light tree is a feature, for which
/// it is specialised.
template <Features kFeatures>
struct LightChoice : ChosenByPower {};

/// Masks that code has been compiled for, from those of the least code on.
template <Features... kMasks>
struct CompiledFor {
    /// Calls `with`, a template over a mask, with the first one that holds all of `wanted`. False: there is none.
    template <class With>
    static bool choose(Features wanted, const With& with) {
        return (((wanted & ~kMasks) == 0 && (with.template operator()<kMasks>(), true)) || ...);
    }
};
using FilmFeatures = CompiledFor<kPlainDiffuse, kDiffuse, kAllMaterials, kPlainDiffuse | kMoving, kDiffuse | kMoving,
                                 kAllMaterials | kMoving>;
using FrameFeatures = CompiledFor<kPlainDiffuse, kDiffuse, kAllMaterials>;
using LayerFeatures = CompiledFor<kAllMaterials, kAllMaterials | kMoving>;

} // namespace pertev
