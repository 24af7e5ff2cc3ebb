#include "integrators/kinds/make_integrator.h"

#include <array>
#include <type_traits>

#include <fmt/format.h>

#include "base/error.h"
#include "integrators/irradiance_cache/irradiance_cache_integrator.h"
#include "integrators/path/path_code.h"
#include "integrators/path/path_integrator.h"
#include "integrators/photon_map/photon_map_integrator.h"
#include "integrators/radiosity/radiosity_integrator.h"
#include "integrators/raster/raster_integrator.h"
#include "integrators/ray_tree/ray_tree_integrator.h"
#include "integrators/reyes/reyes_integrator.h"
#include "integrators/subpaths/subpath_integrator.h"

namespace pertev {
namespace {

// Each function picks the settings of one integrator from the settings of all.

PathRequest path_request(const IntegratorSettings& settings) {
    return {settings.path, settings.light_paths, settings.irradiance, settings.integrator == IntegratorKind::Hybrid};
}

RayTreeSettings tree_settings(const IntegratorSettings& settings) {
    return {.max_depth = settings.path.max_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed,
            .light_choice = settings.path.light_choice,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0}),
            .radiosity = {}}; // its integrator adds the radiosity
}

RadiosityIntegrator::Settings radiosity_settings(const IntegratorSettings& settings) {
    return {tree_settings(settings), *settings.radiosity};
}

SubpathSettings subpath_settings(const IntegratorSettings& settings) {
    return {.max_depth = settings.path.max_depth,
            .roulette_depth = settings.path.roulette_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed,
            .light_choice = settings.path.light_choice};
}

PhotonMapRequest photon_map_request(const IntegratorSettings& settings) {
    return {subpath_settings(settings), *settings.photon_map};
}

IrradianceCacheRequest irradiance_cache_request(const IntegratorSettings& settings) {
    return {subpath_settings(settings), *settings.irradiance_cache};
}

RasterSettings raster_settings(const IntegratorSettings& settings) {
    return {.display = *settings.display,
            .max_depth = settings.path.max_depth,
            .seed = settings.path.seed,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0})};
}

ReyesSettings reyes_settings(const IntegratorSettings& settings) {
    return {.shading_rate = settings.shading_rate,
            .heights = settings.heights,
            .max_depth = settings.path.max_depth,
            .sampler = settings.path.sampler,
            .seed = settings.path.seed,
            .has_ambient = settings.ambient.has_value(),
            .ambient = settings.ambient.value_or(Rgb{0, 0, 0})};
}

/// Adds the functions that make and change a `Made` with settings_of(settings) to the row.
template <class Made, auto settings_of>
constexpr IntegratorDescriptor row(IntegratorDescriptor of) {
    of.make = [](Queue& queue, const IntegratorSettings& settings) -> std::unique_ptr<Integrator> {
        const auto own = settings_of(settings);
        if constexpr (std::is_constructible_v<Made, Queue&, decltype(own), bool, uint32_t>) {
            return std::make_unique<Made>(queue, own, settings.body == PathBody::Loop, settings.batch);
        } else {
            return std::make_unique<Made>(queue, own);
        }
    };
    of.change = [](Integrator& integrator, const IntegratorSettings& settings) {
        static_cast<Made&>(integrator).set_settings(settings_of(settings));
    };
    return of;
}

void check_photons(const IntegratorSettings& settings) {
    const uint32_t photons = settings.photon_map->photons, depth = settings.path.max_depth;
    if (photons_fit(photons, depth)) return;
    throw Error(ErrorCode::OverLimit, "photons", fmt::format("{}", photons),
                fmt::format("with `max_depth={}` a pass may store more than {} photons; the limit is {}", depth,
                            kMaxStored, kMaxStored / (2 * uint64_t(depth - 1))));
}

MemoryUse memory_of_photons(const IntegratorSettings& settings, const WorkSize&) {
    return {
        fmt::format("Photons (`photons={}`, `max_depth={}`)", settings.photon_map->photons, settings.path.max_depth),
        "a smaller value of either"};
}

MemoryUse memory_of_records(const IntegratorSettings& settings, const WorkSize& size) {
    const bool has_rays = !size.traverses_on_host || settings.body == PathBody::Wavefront;
    return {fmt::format("Records of {}x{} pixels{}", size.width, size.height, has_rays ? " and their rays" : ""),
            fmt::format("a smaller `size`{}", has_rays ? ", or fewer `hemisphere_rays`," : "")};
}

constexpr const char* kAll = "all";
constexpr const char* kNoCaustics = "all but LS+D of point lights";
constexpr const char* kNoShadows = "L(D|G)E of point lights, no shadows; emitters seen";

using Kind = IntegratorKind;
constexpr std::array kIntegrators = {
    row<PathIntegrator, path_request>(
        {.value = Kind::Path,
         .name = "path",
         .light = kAll,
         .light_with_caustics = kNoCaustics,
         .lacks = "light of point, spot and directional lights that mirrors or clear glass send on to other surfaces",
         .settings = "clamp",
         .makes_frames = true,
         .has_light_path_layers = true,
         .finds_all_light = true,
         .has_shutter = true,
         .renders_batches = true,
         .has_media = true,
         .selects_lights = true}),
    row<PathIntegrator, path_request>({.value = Kind::Hybrid,
                                       .name = "hybrid",
                                       .light = kAll,
                                       .light_with_caustics = kNoCaustics,
                                       .settings = "clamp",
                                       .makes_frames = true,
                                       .has_light_path_layers = true,
                                       .finds_all_light = true,
                                       .rasterises_camera = true,
                                       .has_media = true,
                                       .selects_lights = true}),
    row<RayTreeIntegrator<Cast>, tree_settings>({.value = Kind::Cast,
                                                 .name = "cast",
                                                 .light = "L(D|G)E of point lights; emitters seen",
                                                 .settings = "ambient",
                                                 .has_shutter = true,
                                                 .needs_punctual_lights = true,
                                                 .max_depth = kMaxTreeDepth}),
    row<RayTreeIntegrator<Whitted>, tree_settings>({.value = Kind::Whitted,
                                                    .name = "whitted",
                                                    .light = "L(D|G)S*E of point lights; emitters seen",
                                                    .settings = "ambient",
                                                    .has_shutter = true,
                                                    .needs_punctual_lights = true,
                                                    .has_mean_ambient = true,
                                                    .max_depth = kMaxTreeDepth}),
    row<RayTreeIntegrator<Distributed>, tree_settings>({.value = Kind::Distributed,
                                                        .name = "distributed",
                                                        .light = "L(D|G|S)?(G|S)*E: one bounce off what is rough",
                                                        .has_shutter = true,
                                                        .selects_lights = true,
                                                        .max_depth = kMaxTreeDepth}),
    row<RasterIntegrator, raster_settings>({.value = Kind::Raster,
                                            .name = "raster",
                                            .light = kNoShadows,
                                            .settings = "ambient shading wireframe",
                                            .rasterises_camera = true,
                                            .needs_punctual_lights = true,
                                            .has_mean_ambient = true}),
    row<ReyesIntegrator, reyes_settings>({.value = Kind::Reyes,
                                          .name = "reyes",
                                          .light = kNoShadows,
                                          .settings = "ambient shading_rate displacement",
                                          .rasterises_camera = true,
                                          .needs_punctual_lights = true,
                                          .has_mean_ambient = true,
                                          .samples_at_once = ReyesIntegrator::samples_at_once}),
    row<SubpathIntegrator<ParticlesAlone>, subpath_settings>(
        {.value = Kind::Light,
         .name = "light",
         .light = "L((D|G|S)*(D|G))?E: nothing in mirrors or clear glass",
         .ignores_nesting = true,
         .has_media = true}),
    row<SubpathIntegrator<BothDirections>, subpath_settings>(
        {.value = Kind::Bidirectional,
         .name = "bidirectional",
         .light = kAll,
         .light_with_caustics = "all but LS+DS+E of point lights",
         .lacks = "light of point, spot and directional lights that mirrors or clear glass send on to other surfaces, "
                  "as mirrors and clear glass show it",
         .finds_all_light = true,
         .ignores_nesting = true,
         .has_media = true,
         .selects_lights = true,
         .max_depth = kMaxConnectedDepth}),
    row<PhotonMapIntegrator, photon_map_request>({.value = Kind::PhotonMap,
                                                  .name = "photon_map",
                                                  .light = "all, blurred ever less",
                                                  .lacks = "sharpness: light estimated from photons is blurred",
                                                  .settings = "photons gather radius caustic_radius nearest",
                                                  .finds_all_light = true,
                                                  .needs_any_light = true,
                                                  .ignores_nesting = true,
                                                  .has_media = true,
                                                  .selects_lights = true,
                                                  .max_depth = kMaxPhotonDepth,
                                                  .check = check_photons,
                                                  .memory = memory_of_photons}),
    row<IrradianceCacheIntegrator, irradiance_cache_request>(
        {.value = Kind::IrradianceCache,
         .name = "irradiance_cache",
         .light = "all, interpolated between records",
         .light_with_caustics = "as path, interpolated between records",
         .settings = "accuracy hemisphere_rays show_records records",
         .finds_all_light = true,
         .ignores_nesting = true,
         .selects_lights = true,
         .makes_records = true,
         .memory = memory_of_records}),
    row<RadiosityIntegrator, radiosity_settings>(
        {.value = Kind::Radiosity,
         .name = "radiosity",
         .light = "all, by patches ever smaller",
         .light_if_not_diffuse = "L(D*)S*E, by patches ever smaller",
         .settings = "patch_size subdivisions contrast form_factors patch_rays hemicube solver tolerance steps "
                     "link_error solution flat_patches records",
         .needs_any_light = true,
         .is_solved = true,
         .max_depth = kMaxTreeDepth}),
};

constexpr bool are_in_order() {
    for (std::size_t i = 0; i < kIntegrators.size(); ++i) {
        if (kIntegrators[i].value != static_cast<IntegratorKind>(i)) return false;
    }
    return true;
}
static_assert(are_in_order() && kIntegrators.back().value == kLastIntegrator);

bool same_heights(const IntegratorSettings& a, const IntegratorSettings& b) {
    return a.heights == b.heights || (a.heights && b.heights && *a.heights == *b.heights);
}

} // namespace

std::span<const IntegratorDescriptor> integrators() { return kIntegrators; }

const IntegratorDescriptor& describe(IntegratorKind kind) { return kIntegrators[static_cast<std::size_t>(kind)]; }

bool has_tree_in_media(const IntegratorSettings& settings, bool of_frames) {
    if (!makes_frames(settings.integrator)) return true; // its stages do not depend on what it writes
    const PathOutput output = of_frames              ? PathOutput::Frames
                              : settings.light_paths ? PathOutput::Layers
                                                     : PathOutput::Films;
    return is_compiled(output, kMedia | kLightTree);
}

bool same_light(const IntegratorSettings& a, const IntegratorSettings& b) {
    return a.integrator == b.integrator && a.path == b.path && a.ambient == b.ambient && a.display == b.display &&
           a.shading_rate == b.shading_rate && same_heights(a, b) && a.photon_map == b.photon_map &&
           a.irradiance_cache == b.irradiance_cache && a.radiosity == b.radiosity && a.light_paths == b.light_paths &&
           a.irradiance == b.irradiance;
}

std::unique_ptr<Integrator> make_integrator(Queue& queue, const IntegratorSettings& settings) {
    return describe(settings.integrator).make(queue, settings);
}

bool change_settings(Integrator& integrator, const IntegratorSettings& from, const IntegratorSettings& to) {
    if (from.integrator != to.integrator || from.body != to.body || from.batch != to.batch) return false;
    describe(to.integrator).change(integrator, to);
    return true;
}

std::size_t predicted_bytes(const IntegratorSettings& settings, const WorkSize& size, bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    const std::unique_ptr<Integrator> integrator = make_integrator(queue, settings);
    integrator->reserve(size);
    return queue.allocated_bytes() + (on_cuda ? 0 : integrator->host_bytes());
}

} // namespace pertev
