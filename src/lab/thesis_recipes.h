#pragma once

// What each picture of the thesis (lab/thesis_pictures.h) is made of: one row of bench/thesis.json a picture.

#include <string>
#include <vector>

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

inline constexpr ValueName<ThesisWay> kThesisWayNames[] = {
    {ThesisWay::Render, "render"}, {ThesisWay::Radiosity, "radiosity"}, {ThesisWay::Photons, "photons"},
    {ThesisWay::Work, "work"},     {ThesisWay::KdTree, "kd-tree"},      {ThesisWay::Octree, "octree"}};
constexpr const auto& names_of_all(ThesisWay) { return kThesisWayNames; }

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

struct ThesisRecipe {
    std::string name, title, shows; // ThesisPicture's
    ThesisWay way = ThesisWay::Render;
    ThesisScene scene = ThesisScene::Box;
    std::string integrator;
    bool is_whole = false;             // else one panel of several: half the width and height
    std::vector<std::string> settings; // NAME or NAME=VALUE, beside scene, integrator and patches
    bool has_photons_by_size = false;  // thesis_detail's
    RadiosityPanel panel = {};         // of Radiosity
    StructureKind structure = {};      // of Work
    float stops = 2;                   // of exposure
};

/// Ordered as the thesis is.
const std::vector<ThesisRecipe>& thesis_recipes();

} // namespace pertev
