#include "lab/thesis_recipes.h"

#include <algorithm>

#include "lab/job_table.h"

namespace pertev {
namespace {

ThesisRecipe recipe_of(const gltf::JsonValue& value) {
    ThesisRecipe recipe = {.name = value.string_or("name", ""),
                           .title = value.string_or("title", ""),
                           .shows = value.string_or("shows", ""),
                           .method = value_named<ThesisMethod>(value.string_or("way", "render")).value(),
                           .scene = value_named<ThesisScene>(value.string_or("scene", "box")).value(),
                           .integrator = value.string_or("integrator", ""),
                           .is_whole = value.bool_or("is_whole", false),
                           .has_photons_by_size = value.bool_or("photons_by_size", false),
                           .panel = {value.bool_or("is_early", false), value.bool_or("has_ambient", true),
                                     value.bool_or("is_flat", false)},
                           .structure = value_named<StructureKind>(value.string_or("structure", "binned")).value(),
                           .stops = value.float_or("stops", 2)};
    for (const gltf::JsonValue& setting : value.elements_of("settings")) {
        recipe.settings.emplace_back(setting.to_string());
    }
    return recipe;
}

} // namespace

const std::vector<ThesisRecipe>& thesis_recipes() {
    static const std::vector<ThesisRecipe> recipes = [] {
        const JobTable table;
        std::vector<ThesisRecipe> all;
        for (const gltf::JsonValue& value : table.root().elements_of("pictures")) all.push_back(recipe_of(value));
        return all;
    }();
    return recipes;
}

ThesisDetail thesis_detail(uint32_t panel_height) {
    constexpr uint32_t kFullHeight = 384; // height of a panel at 1024x768
    constexpr uint32_t kFinestMm = 80, kEarlySteps = 200, kFullPhotons = 1u << 16;
    const uint32_t mm = std::clamp(kFinestMm * kFullHeight / std::max(1u, panel_height), kFinestMm, 4 * kFinestMm);
    const uint32_t area = mm * mm, finest = kFinestMm * kFinestMm;
    return {static_cast<float>(mm) / 1000, kEarlySteps * finest / area, kFullPhotons * finest / area};
}

} // namespace pertev
