#pragma once

// What each picture of the thesis (lab/thesis_pictures.h) is made of: one row a picture.

#include <span>

#include "lab/thesis_scenes.h"
#include "settings/render_settings.h"
#include "tracer/combination.h"

namespace pertev {

/// How a picture comes about.
enum class ThesisWay : uint8_t {
    Render,    // rendered
    Radiosity, // solved, then rendered
    Photons,   // photons of one pass as dots
    Work,      // tests of the ray through the middle of each pixel
    KdTree,    // points that a search in such a tree finds, drawn
    Octree,    // likewise
};

/// Of Radiosity.
struct RadiosityPanel {
    bool is_early = false;   // after a few patches have sent
    bool has_ambient = true; // light that is unsent is shown too
    bool is_flat = false;    // patches as they are solved, not divided where light changes
};

/// How finely light is found for a panel. One of the full size, half of 1024x768, has patches of 8 cm; in a smaller one
/// a patch is as many pixels high, up to four times as large, and photons are as many a pixel.
struct ThesisDetail {
    float patch_size;     // metres
    uint32_t early_steps; // of an early panel: 200, or as many as send from the same area
    uint32_t photons;     // of a pass, for each map: 65536 or fewer
};
ThesisDetail thesis_detail(uint32_t panel_height);

inline constexpr uint32_t kThesisPhotons = 16384; // of a pass, for each map, where they are to be seen one by one

struct ThesisRecipe {
    const char *name, *title, *shows; // ThesisPicture's
    ThesisWay way = ThesisWay::Render;
    ThesisScene scene = ThesisScene::Box;
    const char* integrator = "";
    bool is_whole = false;                  // else one panel of several: half the width and height
    const char* settings = "";              // of the command, beside scene, integrator, patches and photons
    void (*set)(RenderSettings&) = nullptr; // does what `settings` say, and chooses photons; null: nothing
    RadiosityPanel panel = {};              // of Radiosity
    StructureKind structure = {};           // of Work
    float stops = 2;                        // of exposure
};

/// Ordered as the thesis is.
std::span<const ThesisRecipe> thesis_recipes();

} // namespace pertev
