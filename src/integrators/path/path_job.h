#pragma once

// The job of a path tracer: views and numbers for every vertex of every path, and the mask of features that selects
// its code; src/instances.cmake lists the masks that are compiled (integrators/path/compiled_features.h).

#include <cstdint>
#include <type_traits>

#include "device_scene/moved_surface.h"
#include "integrators/path/path_settings.h"
#include "render/film_view.h"
#include "render/light_paths/light_path_view.h"
#include "render/picture_view.h"
#include "shading/chosen_by_tree.h"

namespace pertev {

struct PathJob {
    PictureView picture;
    PathSettings settings;
    FilmView film;
    LightPathView layers;           // may be empty
    bool is_meter = false;          // the picture shows the irradiance of visible surfaces, W/m2
    bool ends_by_nee = false;       // at the maximum depth no ray finds what next-event estimation has not
    bool selects_by_tree = false;   // uses_light_tree(), for vertices in lanes
    bool passes_thin_walls = false; // shadow rays pass thin walls (device_scene/thin_walls.h)
};

/// Features that a scene and a request use. Code for absent features would cost registers.
using Features = uint32_t;
enum Feature : Features {
    kTextured = 1,    // textured colours, emission or normals
    kAlpha = 2,       // surfaces that a ray may pass, including emitters
    kLayered = 4,     // surfaces other than diffuse ones
    kMoving = 8,      // paths have a time
    kBatched = 16,    // several pictures (PictureView::batch); code without it renders one
    kStacked = 32,    // materials that are stacked (MaterialParameters::is_stacked)
    kMipMapped = 64,  // textures are filtered; code with it filters where the settings say so
    kNested = 128,    // solids lie in each other; code with it also serves scenes without
    kLightTree = 256, // lights are selected by a tree
    kMedia = 512,     // media absorb and scatter, or shadow rays pass thin walls; code with it has kNested
};
inline constexpr Features kPlainDiffuse = 0, kDiffuse = kTextured | kAlpha, kUnstacked = kDiffuse | kLayered,
                          kAllMaterials = kUnstacked | kStacked;

HD constexpr ShadingVariant variant_of(Features features) {
    return (features & kStacked) != 0   ? ShadingVariant::General
           : (features & kLayered) != 0 ? ShadingVariant::Unstacked
           : (features & kDiffuse) != 0 ? ShadingVariant::Diffuse
                                        : ShadingVariant::PlainDiffuse;
}
HD constexpr MotionVariant motion_of(Features features) {
    return (features & kMoving) != 0 ? MotionVariant::Some : MotionVariant::None;
}

inline Features features_of(ShadingVariant variant) {
    switch (variant) {
    case ShadingVariant::General:
        break;
    case ShadingVariant::Unstacked:
        return kUnstacked;
    case ShadingVariant::Diffuse:
        return kDiffuse;
    case ShadingVariant::PlainDiffuse:
        return kPlainDiffuse;
    }
    return kAllMaterials;
}

/// Returns the scene that the picture of a pixel shows.
template <Features kFeatures>
HD inline const SceneView& scene_of(const PathJob& job, uint32_t pixel) {
    if constexpr ((kFeatures & kBatched) != 0) return job.picture.scene_of(pixel);
    return job.picture.scene;
}

/// Returns the key of the random numbers of a path.
template <Features kFeatures>
HD inline SampleKey sample_key(const PathJob& job, uint32_t pixel, uint32_t sample) {
    if ((kFeatures & kBatched) != 0 && job.picture.batch.is_there()) return job.picture.batch.key(pixel, sample);
    return sample_key(job.settings, pixel, sample);
}

/// The light selection of code for a mask of features (shading/light_set.h).
template <Features kFeatures>
struct LightChoice : std::conditional_t<(kFeatures & kLightTree) != 0, ChosenByTree, ChosenByPower> {};

/// Masks for which code has been compiled, ordered from the least code on.
template <Features... kMasks>
struct CompiledFor {
    /// Calls `with`, a template over a mask, with the first one that contains all of `wanted`. Returns false if there
    /// is none.
    template <class With>
    static bool choose(Features wanted, const With& with) {
        return (((wanted & ~kMasks) == 0 && (with.template operator()<kMasks>(), true)) || ...);
    }
    static constexpr bool has(Features wanted) { return (((wanted & ~kMasks) == 0) || ...); }
};
inline constexpr Features kAnyFilm = kAllMaterials | kMoving | kBatched | kMipMapped | kNested;

} // namespace pertev
