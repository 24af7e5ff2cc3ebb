#include "lab/thesis_pictures.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "base/error.h"
#include "image/tone_map_image.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/radiosity/radiosity_display_settings.h"
#include "lab/found_points.h"
#include "lab/heat_map.h"
#include "lab/measure_rays.h"
#include "lab/record.h"
#include "lab/thesis_recipes.h"
#include "radiosity/solve_radiosity.h"
#include "settings/setting_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

constexpr float kDotRadius = 1.2f; // times the scene's longest side over the picture's height, so about this many
                                   // pixels

/// Returns the place in the thesis: "Figure 3.7" for "figure-3.7a", "Section 2.1" for "section-2.1-flat".
std::string location_of(std::string_view name) {
    const std::size_t dash = name.find('-'), end = name.find_first_not_of("0123456789.", dash + 1);
    std::string place = fmt::format("{} {}", name.substr(0, dash), name.substr(dash + 1, end - dash - 1));
    place.front() -= 'a' - 'A';
    return place;
}

/// Returns the difference of the films' sums, `a` minus `b`.
Image difference(const Image& a, const Image& b) {
    Image left = a;
    for (std::size_t i = 0; i < left.pixels.size(); ++i) left.pixels[i] = std::max(0.0f, a.pixels[i] - b.pixels[i]);
    return left;
}

/// Scales the picture so that the mean of its pixels that are not black displays well.
void normalise(Image& picture) {
    constexpr double mean = 0.4;
    double sum = 0, lit = 0;
    for (const float value : picture.pixels) {
        if (value > 0) sum += static_cast<double>(value), ++lit;
    }
    if (!(sum > 0)) return;
    const auto scale = static_cast<float>(mean * lit / sum);
    for (float& value : picture.pixels) value *= scale;
}

/// Returns the radiosity settings of a panel in a picture with these settings.
RadiositySettings solution_of(const RadiosityPanel& panel, const RenderSettings& settings) {
    const ThesisDetail detail = thesis_detail(settings.height);
    RadiositySettings requested;
    requested.seed = settings.path.seed;
    requested.patch_size = detail.patch_size;
    requested.subdivisions = panel.is_flat ? 0 : 1;
    if (panel.is_early) {
        requested.solver = RadiositySolver::Southwell;
        requested.steps = detail.early_steps;
    }
    return requested;
}

/// Returns the text of settings for the command line.
std::string settings_of(const RadiosityPanel& panel, const RadiositySettings& requested) {
    return fmt::format(" `patch_size={}` `subdivisions={}`{}{}", requested.patch_size, requested.subdivisions,
                       panel.is_early ? fmt::format(" `solver=southwell` `steps={}`", requested.steps) : "",
                       panel.is_flat ? " `flat_patches`" : "");
}

/// Returns `settings` with those given as NAME or NAME=VALUE, in the syntax of the table of settings.
RenderSettings with_settings(const RenderSettings& settings, const std::vector<std::string>& given) {
    PictureOptions options;
    options.render = settings;
    for (const std::string& one : given) {
        const std::size_t end = one.find('=');
        const std::string value = end == std::string::npos ? "true" : one.substr(end + 1);
        set_value(options, *find_setting(one.substr(0, end)), {&value, 1});
    }
    return options.render;
}

std::string command_text(const ThesisRecipe& recipe, const RenderSettings& settings) {
    const std::string scene = command_of(recipe.scene);
    const bool is_whole =
        recipe.method == ThesisMethod::Render || (recipe.method == ThesisMethod::Radiosity && recipe.panel.has_ambient);
    if (scene.empty() || !is_whole) return {};
    std::string others;
    for (const std::string& setting : recipe.settings) others += fmt::format(" `{}`", setting);
    if (recipe.method == ThesisMethod::Radiosity)
        others += settings_of(recipe.panel, solution_of(recipe.panel, settings));
    if (recipe.has_photons_by_size) others += fmt::format(" `photons={}`", settings.photon_map->photons);
    return fmt::format("{} `integrator={}`{} `size={}x{}` `spp={}` `max_depth={}` `exposure={:g}` `output={}.png`",
                       scene, recipe.integrator, others, settings.width, settings.height, settings.samples,
                       settings.path.max_depth, recipe.stops, recipe.name);
}

} // namespace

std::vector<std::string> thesis_picture_names() {
    std::vector<std::string> names;
    for (const ThesisRecipe& recipe : thesis_recipes()) names.emplace_back(recipe.name);
    return names;
}

/// The inputs that one picture is made from.
struct ThesisPictures::Job {
    const ThesisRecipe& recipe;
    RenderSettings settings;
    Sink& sink;
    Scene scene;
    Camera camera;
    PreparedScene prepared;
};

ThesisPicture ThesisPictures::make(std::string_view name, Sink& sink) {
    const ThesisRecipe* const found_recipe = find_named(thesis_recipes(), name);
    PERTEV_CHECK(found_recipe != nullptr);
    const ThesisRecipe& recipe = *found_recipe;
    ThesisPicture picture = {.name = recipe.name,
                             .place = location_of(recipe.name),
                             .title = recipe.title,
                             .shows = recipe.shows,
                             .integrator = recipe.integrator};
    if (recipe.method == ThesisMethod::KdTree || recipe.method == ThesisMethod::Octree) {
        const FoundPoints found = recipe.method == ThesisMethod::KdTree ? found_in_kd_tree() : found_in_octree();
        picture.svg = svg_of(found);
        picture.shows += ' ' + describe(found);
        return picture;
    }
    Job job = {recipe, settings_, sink, make_thesis_scene(recipe.scene), {}, {}};
    RenderSettings& settings = job.settings;
    if (!recipe.is_whole) {
        settings.width = std::max(1u, settings.width / 2), settings.height = std::max(1u, settings.height / 2);
    }
    if (!recipe.integrator.empty()) PERTEV_CHECK(set_integrator(settings, recipe.integrator));
    settings.path.max_depth = std::min(settings.path.max_depth, max_depth(settings.integrator));
    settings = with_settings(settings, recipe.settings);
    if (recipe.has_photons_by_size) settings.photon_map.edit().photons = thesis_detail(settings.height).photons;
    if (recipe.method == ThesisMethod::Work) {
        settings.tracers =
            same_for_all({.structure = recipe.structure,
                          .traversal = only_traversal_of(recipe.structure).value_or(TraversalKind::WhileWhile)});
    }
    job.prepared = prepare_scene(job.scene, prepare_options(settings, queue_.is_cuda()), job.sink);
    job.camera = camera_of(recipe.scene, job.scene, aspect_of(settings.width, settings.height));
    picture.command = command_text(recipe, settings);
    switch (recipe.method) {
    case ThesisMethod::Radiosity:
        show_radiosity(job, picture);
        break;
    case ThesisMethod::Photons:
        show_photons(job, picture);
        break;
    case ThesisMethod::Work:
        count_work(job, picture);
        break;
    case ThesisMethod::Render:
    case ThesisMethod::KdTree:
    case ThesisMethod::Octree:
        render(job, settings, picture);
        break;
    }
    return picture;
}

/// Renders once and reports its progress as the share [from, to] of the picture's.
RenderResult ThesisPictures::render_once(const Job& job, const RenderSettings& settings, double from, double to) {
    ProgressSink part = part_of(job.sink, from, to);
    RenderResult result = render_picture(queue_, job.prepared, job.camera, settings, part);
    if (result.samples == 0) throw Error(ErrorCode::Interrupted, "interrupted before a picture had a sample");
    return result;
}

void ThesisPictures::render(const Job& job, const RenderSettings& settings, ThesisPicture& picture) {
    const RenderResult result = render_once(job, settings, picture.solve_seconds > 0 ? 0.5 : 0, 1);
    picture.stats = result;
    picture.interrupted = result.samples < settings.samples;
    picture.image = tone_map_image(result.picture, ToneMap::Agx, job.recipe.stops);
}

/// Shows the light that one pass finds in the maps, with a radius so small that photons do not overlap, minus the
/// light that the pass finds without any photons.
void ThesisPictures::show_photons(const Job& job, ThesisPicture& picture) {
    RenderSettings settings = job.settings;
    const Vec3 size = job.prepared.structures->bounds().size();
    const float radius = kDotRadius * max_component(size) / static_cast<float>(settings.height);
    settings.samples = 1;
    settings.photon_map.edit().radius = settings.photon_map.edit().caustic_radius = radius;
    settings.photon_map.edit().gather = PhotonGather::Direct;
    const RenderResult all = render_once(job, settings, 0, 0.5);
    settings.path.max_depth = 1;
    const RenderResult direct = render_once(job, settings, 0.5, 1);
    picture.stats = all;
    Image dots = difference(all.picture, direct.picture);
    normalise(dots);
    picture.image = tone_map_image(dots, ToneMap::Srgb);
    picture.shows += fmt::format(" {} photons have left the lights for each map.", settings.photon_map->photons);
}

void ThesisPictures::count_work(const Job& job, ThesisPicture& picture) {
    Session session(queue_, job.prepared, job.camera, job.settings);
    const std::vector<RayWork> work = session.count_camera_work();
    const WorkSummary mean = summarize_work(work);
    std::vector<uint32_t> tests;
    for (const RayWork& ray : work) tests.push_back(ray.nodes + ray.triangles);
    picture.image = draw_heat_map(tests, job.settings.width, job.settings.height, scale_end(tests));
    picture.shows +=
        fmt::format(" Dark pixels take few tests of nodes and triangles, pale ones many; the scale is below. A ray "
                    "tests {:.1f} nodes and {:.1f} triangles of {} on average.",
                    mean.nodes, mean.triangles, job.prepared.triangles);
}

void ThesisPictures::show_radiosity(const Job& job, ThesisPicture& picture) {
    const RadiosityPanel& panel = job.recipe.panel;
    const RadiositySettings requested = solution_of(panel, job.settings);
    ProgressSink solving = part_of(job.sink, 0, 0.5);
    const SolvedRadiosity solved = solve_radiosity(job.prepared, requested, solving);
    if (solved.stats.was_interrupted) throw Error(ErrorCode::Interrupted, "interrupted");
    const SolveStats& stats = solved.stats;
    picture.solve_seconds = stats.factor_seconds + stats.solve_seconds + stats.divide_seconds;
    const std::string steps = panel.is_early ? fmt::format(" {} steps;", requested.steps) : "";
    picture.shows += fmt::format("{} {} patches that shoot, {} that are shown.", steps, stats.patches, stats.shown);
    RenderSettings settings = job.settings;
    auto solution = std::make_shared<RadiositySolution>(solved.solution);
    if (!panel.has_ambient) solution->ambient = {};
    settings.radiosity = {std::move(solution), panel.is_flat};
    render(job, settings, picture);
}

} // namespace pertev
