#pragma once

// Recipes of the thesis's pictures (lab/thesis_pictures.h): one row of bench/jobs.json per picture.

#include <string>
#include <vector>

#include "lab/thesis_scenes.h"
#include "settings/render_settings.h"
#include "tracer/combination.h"

namespace pertev {

/// The way in which a picture is made.
enum class ThesisMethod : uint8_t {
    Render,    // by an integrator
    Radiosity, // by a radiosity solution that is then rendered
    Photons,   // the photons of one pass, drawn as dots
    Work,      // traversal tests of the ray through each pixel's centre
    KdTree,    // a drawing of the points that a kd-tree search finds
    Octree,    // a drawing of the points that an octree search finds
};

inline constexpr ValueName<ThesisMethod> kThesisMethodNames[] = {
    {ThesisMethod::Render, "render"}, {ThesisMethod::Radiosity, "radiosity"}, {ThesisMethod::Photons, "photons"},
    {ThesisMethod::Work, "work"},     {ThesisMethod::KdTree, "kd-tree"},      {ThesisMethod::Octree, "octree"}};
constexpr const auto& names_of_all(ThesisMethod) { return kThesisMethodNames; }

/// A panel of the figure of radiosity.
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

struct ThesisRecipe {
    std::string name, title, shows; // ThesisPicture's
    ThesisMethod method = ThesisMethod::Render;
    ThesisScene scene = ThesisScene::Box;
    std::string integrator;
    bool is_whole = false;             // otherwise one panel of several: half the width and height
    std::vector<std::string> settings; // NAME or NAME=VALUE, beside scene, integrator and patches
    bool has_photons_by_size = false;  // thesis_detail's
    RadiosityPanel panel = {};         // for Radiosity
    StructureKind structure = {};      // for Work
    float stops = 2;                   // exposure stops
};

/// Returns all recipes in the order of the thesis.
const std::vector<ThesisRecipe>& thesis_recipes();

} // namespace pertev
