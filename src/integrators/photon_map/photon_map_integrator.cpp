#include "integrators/photon_map/photon_map_integrator.h"

#include "integrators/photon_map/photon_map_settings.h"
#include "integrators/photon_map/photon_targets.h"
#include "math/portable_pow.h"
#include "math/scalar.h"

namespace pertev {

namespace {

/// Returns the sizes of the arrays. `in_loop` means those of a CPU thread, which shares no long lookups.
GatherCapacity gather_capacity(uint32_t subpaths, const PhotonMapRequest& settings, const WorkSize& size,
                               bool in_loop) {
    const PhotonMapSettings& map = settings.map;
    return {subpaths, map.nearest, !in_loop && map.search == PhotonSearch::Grid && map.nearest == 0,
            size.has_interiors && size.has_media,
            uses_light_tree(settings.subpaths.light_choice, size.tree_lights, size.has_times)};
}

} // namespace

GatherCapacity PhotonMapIntegrator::loop_capacity() const {
    constexpr std::size_t kLoopBytes = std::size_t(1) << 18; // per thread, so that it fits the cache
    const WorkSize size = size_of(picture_, *tracer_, 1);
    return capacity_within(kLoopBytes, kLoopCount,
                           [&](uint32_t subpaths) { return gather_capacity(subpaths, picture_settings_, size, true); });
}

void PhotonMapIntegrator::reserve(const WorkSize& size) {
    const PhotonMapSettings& map = settings_.map;
    maps_.allocate(map, settings_.subpaths.max_depth, size.has_media);
    targets_.grow(queue_, kMaxTargets, "targets of photons");
    counted_elsewhere_.grow(queue_, 1, "invalid photons");
    if (uses_loop(size)) return;
    const uint64_t subpaths =
        std::max<uint64_t>(size.pixels(), 2 * uint64_t(map.photons)); // camera subpaths or photons
    allocate_capacity(capacity_within(kMaxBytes, std::min<uint64_t>(subpaths, batch_),
                                      [&](uint32_t count) { return gather_capacity(count, settings_, size, false); }),
                      "subpaths of photon mapping");
}

void PhotonMapIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    PERTEV_CHECK(photons_fit(settings_.map.photons, settings_.subpaths.max_depth));
    TwoSchedules::begin(picture, tracer, samples);
    const PhotonMapSettings& map = picture_settings_.map;
    world_ = sphere_round(tracer.bounds());
    global_radius_ = map.radius > 0 ? map.radius : kRadiusOfScene * world_.radius;
    caustic_radius_ = map.caustic_radius > 0 ? map.caustic_radius : kCausticRadius * global_radius_;
    counted_elsewhere_.fill(0);
    find_targets();
}

void PhotonMapIntegrator::find_targets() {
    const SceneView& scene = picture_.scene;
    target_count_ = 0;
    if (!has_lobes(scene.variant) || !(world_.radius > 0)) return;
    std::vector<Float4> spheres = {{world_.centre.x, world_.centre.y, world_.centre.z, world_.radius}};
    if (scene.first_triangle != nullptr) {
        Buffer<SpecularBounds> bounds(queue_, 1, "bounds of mirrors and glass");
        bounds.fill(hploc::kNothing);
        for (const bool in_cells : {false, true}) {
            launch(queue_, "find mirrors and glass", static_cast<uint32_t>(scene.triangle_count),
                   FindSpecular{scene, bounds.data(), in_cells});
        }
        std::vector<SpecularBounds> copy;
        spheres = choose_targets(bounds.read(copy).front());
    }
    target_count_ = static_cast<uint32_t>(spheres.size());
    targets_.upload(spheres);
}

PhotonJob PhotonMapIntegrator::make_job(uint32_t pass, const FilmView& film) {
    PhotonJob job = {};
    job.scene = {picture_, picture_settings_.subpaths, world_, false};
    job.film = film;
    job.samples = {film.window, pass, 1};
    // Photons of a pass are the same for all parts of a picture, of which the one with its first pixel counts them.
    uint64_t* const invalid = film.is_first ? film.invalid : counted_elsewhere_.data();
    const PhotonMapSettings& map = picture_settings_.map;
    job.pass = {pass, map.photons, {targets_.data(), target_count_}, maps_.clear(), invalid, energy_};
    job.how = map.gather;
    job.search = map.search;
    return job;
}

void PhotonMapIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    check_sums(film);
    try {
        for (uint32_t pass = first; pass < first + count && !is_abandoned(); ++pass) render_pass(pass, film);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::Interrupted) throw; // the film is discarded (stop_with)
    }
}

void PhotonMapIntegrator::render_pass(uint32_t pass, const FilmView& film) {
    PhotonJob job = make_job(pass, film);
    const SubpathSettings& subpaths = picture_settings_.subpaths;
    // Shadow rays alone find light that is scattered once.
    const uint64_t kinds = subpaths.max_depth < 2 ? 0 : target_count_ > 0 ? 2 : 1;
    run_stages(job, 0, kinds * picture_settings_.map.photons, loop_capacity(), 1,
               [this](auto& schedule, const PhotonJob& part) {
                   if (!is_abandoned()) run_photons(schedule, part);
               });
    const float shrunk = radius_of_pass(pass), largest = length(world_.centre) + world_.radius;
    job.near = max(shrunk * global_radius_, kMinPhotonRadius);
    const float caustic = max(shrunk * caustic_radius_, kMinPhotonRadius);
    const float in_media = max(radius_in_media_of_pass(pass) * kRadiusInMedia * caustic_radius_, kMinPhotonRadius);
    job.maps = maps_.build({job.near, caustic, in_media}, largest, pass, subpaths.seed, stopping_sink());
    job.in_media = maps_.in_media();
    run_stages(job, 0, job.samples.count(), loop_capacity(), 1, [this](auto& schedule, const PhotonJob& part) {
        if (!is_abandoned()) run_gather(schedule, part);
    });
    rays_.camera += job.samples.count();
}

namespace {

/// Returns the product over i = 1 .. pass of (i + alpha) / (i + 1), in a fixed order, so its bits are the same
/// everywhere.
float shrinking_product(double alpha, uint32_t pass) {
    double product = 1;
    for (uint32_t i = 1; i <= pass; ++i) product *= (i + alpha) / (i + 1.0);
    return static_cast<float>(product);
}

} // namespace

float radius_of_pass(uint32_t pass) { return sqrt(shrinking_product(2.0 / 3.0, pass)); }
float radius_in_media_of_pass(uint32_t pass) { return pow(shrinking_product(4.0 / 7.0, pass), 1.0f / 3.0f); }

} // namespace pertev
