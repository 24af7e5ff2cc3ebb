#pragma once

// The table of the thesis's pictures (lab/thesis_pictures.h), one row per picture.

#include <span>

#include "lab/thesis_scenes.h"
#include "settings/render_settings.h"
#include "tracer/combination.h"

namespace pertev {

/// How a picture is made.
enum class ThesisWay : uint8_t {
    Render,    // by an integrator
    Radiosity, // by a radiosity solution that is then rendered
    Photons,   // the photons of one pass, drawn as dots
    Work,      // traversal tests of the ray through each pixel's centre
    KdTree,    // a drawing of the points that a kd-tree search finds
    Octree,    // a drawing of the points that an octree search finds
};

/// Settings of a picture with ThesisWay::Radiosity.
struct RadiosityPanel {
    bool is_early = false;   // shown after a few steps of the solver
    bool has_ambient = true; // unsent light is shown as ambient light
    bool is_flat = false;    // patches are shown with constant radiosity and not subdivided where light changes
};

/// The detail of a panel's solution. A panel of full size, half of 1024x768, has patches of 8 cm. In a smaller one
/// patches keep their height in pixels, up to four times that size, and photons their number per pixel.
struct ThesisDetail {
    float patch_size;     // metres
    uint32_t early_steps; // solver steps of an early panel: 200, or as many as send from the same area
    uint32_t photons;     // photons per pass and map, at most 65536
};
ThesisDetail thesis_detail(uint32_t panel_height);

inline constexpr uint32_t kThesisPhotons = 16384; // photons per pass and map in pictures that show them one by one

struct ThesisRecipe {
    const char *name, *title, *shows; // see ThesisPicture
    ThesisWay way = ThesisWay::Render;
    ThesisScene scene = ThesisScene::Box;
    const char* integrator = "";
    bool is_whole = false;                  // otherwise one of several panels with half the width and height
    const char* settings = "";              // settings of the command, other than scene, integrator, patches and
                                            // photons
    void (*set)(RenderSettings&) = nullptr; // applies `settings` and chooses photons; null if there is nothing to
                                            // apply
    RadiosityPanel panel = {};              // used by ThesisWay::Radiosity
    StructureKind structure = {};           // used by ThesisWay::Work
    float stops = 2;                        // exposure in stops
};

/// Returns all recipes in the thesis's order.
std::span<const ThesisRecipe> thesis_recipes();

} // namespace pertev
