#include "integrators/path/path_integrator.h"

#include <algorithm>
#include <type_traits>

#include "base/error.h"
#include "device/launch.h"
#include "integrators/path/begin_and_trace.h"
#include "integrators/path/compiled_features.h"
#include "integrators/path/meter_light.h"
#include "integrators/path/path_code.h"
#include "integrators/path/path_loop.h"
#include "integrators/path/path_stages.h"

namespace pertev {
namespace {

// Minimum number of paths for two wavefronts: smaller rounds finish before the host has launched those of two. That
// also holds for the last of many rounds, which dominate if all paths are in flight at once.
constexpr uint64_t kSharedPaths = 500'000;
constexpr uint32_t kManyRounds = 16;

bool does_one_wavefront(uint64_t paths, uint32_t max_depth) { return paths < kSharedPaths || max_depth > kManyRounds; }

/// Number of concurrent wavefronts, and of paths in flight in each.
struct Size {
    int wavefronts;
    uint32_t capacity;
};

constexpr uint64_t kRoundedUp = 128; // paths by which capacities may be rounded up, including the round's counts

/// Maximum number of paths in all queues together.
uint64_t max_paths(const PathParts& parts) {
    return PathIntegrator::kMaxQueueBytes / PathIntegrator::bytes_of_path(parts) - kRoundedUp;
}

Size size_for(uint64_t samples, uint32_t batch, bool on_cuda, uint32_t max_depth, const PathParts& parts) {
    const uint32_t paths = static_cast<uint32_t>(std::min<uint64_t>({samples, batch, max_paths(parts)}));
    const bool does_one = !on_cuda || does_one_wavefront(paths, paths == samples ? max_depth : 0);
    const int wavefronts = does_one ? 1 : 2;
    const uint32_t each = (paths - 1) / static_cast<uint32_t>(wavefronts) + 1;
    return {wavefronts, (each + 31) / 32 * 32}; // rounds start 32 paths at a time
}

/// Calls `with`, a template over a mask of features and a listener, with the least code that the job needs.
template <class With>
void choose_shading(const PathJob& job, const With& with) {
    const Features features = features_for(job);
    const auto choose = [&]<class Compiled, class Plain, class Listener>() {
        PERTEV_CHECK(Compiled::choose(features, [&]<Features kFeatures>() {
            with.template operator()<kFeatures, std::conditional_t<(kFeatures & kLayered) == 0, Plain, Listener>>();
        }));
    };
    switch (output_of(job)) {
    case PathOutput::Layers:
        return choose.template operator()<LayerFeatures, LayerListeners, LayerListeners>();
    case PathOutput::Films:
        return choose.template operator()<FilmFeatures, FilmListeners, FilmListeners>();
    case PathOutput::ReusedFrames:
        return choose.template operator()<ReuseFeatures, PlainReuseListeners, ReuseListeners>();
    case PathOutput::Frames:
        return choose.template operator()<FrameFeatures, PlainFrameListeners, FrameListeners>();
    }
}

} // namespace

PathIntegrator::Wavefront::Paths::Paths(Queue& queue, uint32_t capacity)
    : rays(queue, capacity, "path rays"), starts(queue, capacity, "path rays"), throughput(queue, capacity, "paths"),
      radiance(queue, capacity, "paths") {}

PathIntegrator::Wavefront::Wavefront(Queue& queue, uint32_t paths)
    : capacity(paths), sets{{queue, paths}, {queue, paths}}, shadow_rays(queue, paths, "shadow rays"),
      shadow_starts(queue, paths, "shadow rays"), shadow_targets(queue, paths, "shadow rays"),
      path_keys(queue, paths, "path rays"), shadow_keys(queue, paths, "shadow rays"),
      contribution(queue, paths, "shadow rays"), hit_records(queue, paths, "hits"), hit_instances(queue, paths, "hits"),
      order(queue, paths, "paths"), counts(queue, 2, "path counts"), seen(queue) {}

void PathIntegrator::Wavefront::take(Queue& queue, const PathParts& parts) {
    if (parts.has_times && shadow_times.size() == 0) {
        path_times = {queue, capacity, "path rays"};
        shadow_times = {queue, capacity, "shadow rays"};
    }
    if (parts.has_interiors && sets[0].interiors.size() == 0) {
        for (Paths& set : sets) set.interiors = {queue, capacity, "paths"};
    }
    if (parts.has_normals && sets[0].normals.size() == 0) {
        for (Paths& set : sets) set.normals = {queue, capacity, "paths"};
    }
    if (parts.has_thin_walls && sets[0].passed.size() == 0) {
        for (Paths& set : sets) set.passed = {queue, capacity, "paths"};
    }
    if (parts.has_layers && layer_parts.size() == 0) {
        for (Paths& set : sets) set.states = {queue, capacity, "paths"};
        layer_diffuse = {queue, capacity, "shadow rays"};
        layer_parts = {queue, capacity, "shadow rays"};
    }
    if (parts.splits_light && shadow_diffuse.size() == 0) {
        for (Paths& set : sets) set.diffuse = {queue, capacity, "paths"};
        shadow_diffuse = {queue, capacity, "shadow rays"};
    }
    if (parts.records_bounce && shadow_bounce.size() == 0) shadow_bounce = {queue, capacity, "shadow rays"};
}

PathQueueView PathIntegrator::Wavefront::paths(uint32_t of_round) const {
    const Paths& set = sets[of_round % 2];
    return {set.rays.data(),   set.starts.data(),    path_keys.data(),   set.throughput.data(), set.radiance.data(),
            path_times.data(), set.interiors.data(), set.normals.data(), set.passed.data()};
}

ShadowQueueView PathIntegrator::Wavefront::shadows() const {
    return {shadow_rays.data(), shadow_starts.data(), shadow_targets.data(),
            shadow_keys.data(), contribution.data(),  shadow_times.data()};
}

ListenerQueues PathIntegrator::Wavefront::listened(uint32_t of_round) const {
    const Paths &set = sets[of_round % 2], &next = sets[(of_round + 1) % 2];
    return {.diffuse = set.diffuse.data(),
            .next_diffuse = next.diffuse.data(),
            .shadow_diffuse = shadow_diffuse.data(),
            .shadow_bounce = shadow_bounce.data(),
            .states = set.states.data(),
            .next_states = next.states.data(),
            .layer_diffuse = layer_diffuse.data(),
            .layer_parts = layer_parts.data()};
}

std::size_t PathIntegrator::bytes_of_path(const PathParts& parts) {
    Queue queue = Queue::make_dry_run(true);
    Wavefront of_one(queue, 1);
    of_one.take(queue, parts);
    return queue.allocated_bytes() - 2 * sizeof(RoundCounts);
}

PathIntegrator::PathIntegrator(Queue& queue, const PathRequest& settings, bool in_loop, uint32_t batch)
    : IntegratorBase(queue, settings, in_loop, batch) {
    if (settings.rasterises) raster_.emplace(queue);
}

void PathIntegrator::reserve(const WorkSize& size) {
    if (raster_) raster_->reserve(size.triangles, size.width, size.height);
    if (settings_.layers != uploaded_) {
        layers_on_device_.reset();
        uploaded_ = settings_.layers;
        if (uploaded_) layers_on_device_.emplace(queue_, *uploaded_);
    }
    if (uses_loop(size)) return;
    allocate_wavefronts(
        size.all(), {.has_times = size.has_times,
                     .has_layers = settings_.layers != nullptr,
                     .splits_light = size.splits_light,
                     .records_bounce = size.records_bounce,
                     .has_interiors = size.has_interiors,
                     .has_thin_walls = size.has_thin_walls,
                     .has_normals = uses_light_tree(settings_.path.light_choice, size.tree_lights, size.has_times)});
}

void PathIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    IntegratorBase::begin(picture, tracer, samples);
    if (raster_) raster_->begin(picture);
}

/// Returns the view of the film's layers; empty if it has none.
LightPathView PathIntegrator::layers_for(const FilmView& film) const {
    if (!layers_on_device_) return {};
    PERTEV_CHECK(!film.frame.is_there() && film.channels == film_channel_count(film.aovs) + 3 * uploaded_->count());
    return layers_on_device_->view(film.aovs);
}

void PathIntegrator::allocate_wavefronts(uint64_t samples, const PathParts& parts) {
    parts_.has_times |= parts.has_times;
    parts_.has_layers |= parts.has_layers;
    parts_.splits_light |= parts.splits_light;
    parts_.records_bounce |= parts.records_bounce;
    parts_.has_interiors |= parts.has_interiors;
    parts_.has_thin_walls |= parts.has_thin_walls;
    parts_.has_normals |= parts.has_normals;
    const Size size = size_for(samples, batch_, queue_.is_cuda(), settings_.path.max_depth, parts_);
    // Two wavefronts can serve as one, so that passes of few samples and of many use the same memory.
    const uint64_t held = wavefronts_.empty() ? 0 : wavefronts_.size() * uint64_t(wavefronts_.front().capacity);
    const bool are_enough = wavefronts_.size() >= static_cast<std::size_t>(size.wavefronts) &&
                            held >= static_cast<uint64_t>(size.wavefronts) * size.capacity;
    const bool are_too_many = held > max_paths(parts_) + kRoundedUp; // new parts of each path may need it
    if (!are_enough || are_too_many) {
        wavefronts_.clear(); // freed before the new allocation
        render_counts_.grow(queue_, 1, "path counts");
        for (int i = 0; i < size.wavefronts; ++i) wavefronts_.emplace_back(queue_, size.capacity);
    }
    for (Wavefront& wavefront : wavefronts_) wavefront.take(queue_, parts_);
}

void PathIntegrator::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there() || (count == 1 && !settings_.is_meter));
    check_window(film);
    if (const HostTrees* trees = trees_of_loop()) {
        render_loop(first, count, film, *trees);
    } else {
        render_wavefront(first, count, film);
    }
    if (picture_.camera.is_meter()) {
        rays_.shadow += add_meter_lights(queue_, *tracer_, picture_, settings_.path, first, count, film);
    }
}

/// Returns the job for a film. Vertices whose light ReSTIR adds use no roulette.
PathJob PathIntegrator::job_for(const FilmView& film) const {
    PathJob job = {picture_, settings_.path, film, layers_for(film), settings_.is_meter};
    if (film.frame.first_bounce.leaves_direct_light()) {
        job.settings.roulette_depth = std::max(job.settings.roulette_depth, 2u);
    }
    // Frames reproject reflections by what the last ray hits.
    const bool by_nee = settings_.path.strategy == LightStrategy::NeeOnly && !film.frame.is_there();
    job.ends_by_nee = by_nee && picture_.scene.any_unlit == 0;
    // ReSTIR's visibility rays end at thin walls.
    job.passes_thin_walls = picture_.scene.thin_walls.is_there() && output_of(job) != PathOutput::ReusedFrames;
    job.selects_by_tree = uses_light_tree(job);
    return job;
}

void PathIntegrator::render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees) {
    const BeginOrder samples = {film.window, first, count};
    PathJob job = job_for(film);
    job.film.is_exclusive = true; // all samples of a pixel are one thread's
    const TileRasterView* const raster = rasterises(job) ? &raster_->view() : nullptr;
    trace_ranges(film.window.count(), kLoopCount, [&](uint64_t begin, uint64_t end) {
        RayCounts counts;
        if (is_abandoned()) return counts;
        const PixelRange range = {static_cast<uint32_t>(begin), static_cast<uint32_t>(end)};
        render_pixels(job, {trees, raster}, samples, range, counts);
        return counts;
    });
    rays_.camera += samples.count();
}

void PathIntegrator::render_wavefront(uint32_t first, uint32_t count, const FilmView& film) {
    const PathJob job = job_for(film);
    allocate_wavefronts(uint64_t(picture_.camera.width) * picture_.camera.height * count,
                        {.splits_light = film.frame.splits_light(),
                         .records_bounce = film.frame.first_bounce.records_bounce(),
                         .has_normals = uses_light_tree(job)});
    const Work work = {{film.window, first, count}, job};
    // Ray kinds can only be timed one after the other.
    const bool in_turns = tracer_->times_kinds();
    const uint64_t all = work.samples.count();
    const bool fits_one = all <= wavefronts_.front().capacity;
    const bool does_one = in_turns || (fits_one && does_one_wavefront(all, settings_.path.max_depth));
    const int going = does_one ? 1 : static_cast<int>(wavefronts_.size());
    // If all paths fit at once, as in a frame, wavefronts get equal shares and end together.
    const uint64_t share = (all - 1) / static_cast<uint64_t>(going) + 1;
    render_counts_.zero();
    for (int i = 0; i < going; ++i) {
        Wavefront& w = wavefronts_[static_cast<std::size_t>(i)];
        w.in_flight = static_cast<uint32_t>(std::min<uint64_t>(w.capacity, (share + 31) / 32 * 32));
        w.round = 0;
        w.known = {};
        w.is_done = false;
        w.counts.zero();
        w.path_stream = i;
        w.light_stream = in_turns ? i : going + i;
    }
    {
        const Queue::Fork fork(queue_, in_turns ? 1 : 2 * going);
        launch_rounds(going, work);
    }
    const RenderCounts counts = render_counts_.download().front();
    rays_.camera += all;
    rays_.bounce += counts.bounces;
    rays_.shadow += counts.shadows;
}

/// Launches rounds of the first `going` wavefronts alternately until all of them are done.
void PathIntegrator::launch_rounds(int going, const Work& work) {
    for (int done = 0; done < going;) {
        for (int i = 0; i < going; ++i) {
            Wavefront& w = wavefronts_[static_cast<std::size_t>(i)];
            if (w.is_done) continue;
            if (w.round > 0) w.known = w.seen.wait();
            w.is_done = w.round > 0 && w.known.active == 0;
            if (w.is_done) {
                ++done;
            } else {
                launch_round(w, work);
            }
        }
    }
}

void PathIntegrator::launch_round(Wavefront& w, const Work& work) {
    // After all paths have begun, a round has no more of them than the previous one.
    const Round round = {w.counts.data() + w.round % 2, w.known.all_begun != 0 ? w.known.active : w.in_flight};
    {
        const Queue::OnStream on(queue_, w.path_stream);
        launch_paths(w, work, round);
    }
    queue_.make_stream_wait(w.light_stream, w.path_stream);
    const Queue::OnStream on(queue_, w.light_stream);
    launch_light(w, work, round);
    ++w.round;
}

/// Launches a round's plan, its rays and their shading.
void PathIntegrator::launch_paths(Wavefront& w, const Work& work, const Round& round) {
    const uint32_t last = w.capacity - 1;
    const PathQueueView paths = w.paths(w.round), next = w.paths(w.round + 1);
    const HitQueueView hits = {w.hit_records.data(), w.hit_instances.data()};
    launch(queue_, "plan_round", 1,
           PlanRound{w.counts.data() + (w.round + 1) % 2, round.counts, w.seen.target(), render_counts_.data(),
                     w.in_flight, work.samples.count()});
    w.seen.mark();
    if (w.round > 0) {
        tracer_->find_hits(RayKind::Bounce, paths.query(), {round.most, &round.counts->going_on}, hits,
                           round.pool(RayKind::Bounce));
        queue_.make_stream_wait(w.path_stream, w.light_stream); // waits for radiance, and for slots of paths that end
    }
    if (w.known.all_begun == 0) {
        if (picture_.batch.is_there()) {
            begin_paths<true>(w, work, round);
        } else {
            begin_paths<false>(w, work, round);
        }
    }
    choose_shading(work.job, [&]<Features kFeatures, class Listener>() {
        const WorkCount active = {round.most, &round.counts->active};
        if (orders_hits(kFeatures)) {
            const RoundHits found = {hits, round.counts, last};
            launch(queue_, "count_groups", active, CountGroups{picture_.scene, found});
            launch(queue_, "order_hits", active, OrderHits{picture_.scene, found, w.order.data()});
        }
        launch(queue_, "shade_hits", active,
               Shade<kFeatures, Listener>{work.job, paths, next, hits, w.shadows(), w.listened(w.round), round.counts,
                                          last, w.order.data()});
    });
}

/// Launches the camera rays of paths that begin in this round, which lie at the queue's end.
template <bool kInBatch>
void PathIntegrator::begin_paths(Wavefront& w, const Work& work, const Round& round) {
    const uint32_t last = w.capacity - 1;
    const PathQueueView paths = w.paths(w.round);
    const WorkCount fresh = {round.most, &round.counts->fresh};
    const HitQueueView hits = {w.hit_records.data() + last, w.hit_instances.data() + last, -1};
    // The tracer reads the keys of camera rays that meet hidden backs, too, though it does not need them there.
    const bool any_keys = picture_.scene.any_alpha != 0 || picture_.scene.any_hidden_back != 0;
    const GeneratePaths<kInBatch> generate = {work.job, work.samples, round.counts, last, any_keys, paths};
    if (!rasterises(work.job) && begin_and_trace(queue_, *tracer_, fresh, generate, hits)) return;
    launch(queue_, "generate_paths", fresh, generate);
    if (rasterises(work.job)) {
        tracer_->timed(RayKind::Camera, [&] { raster_->find_hits(paths.query_back(last), fresh, hits); });
    } else {
        tracer_->find_hits(RayKind::Camera, paths.query_back(last), fresh, hits, round.pool(RayKind::Camera));
    }
}

/// Launches a round's shadow rays, and adds the light of the rays that reach it.
void PathIntegrator::launch_light(Wavefront& w, const Work& work, const Round& round) {
    const ShadowQueueView shadows = w.shadows();
    const WorkCount shadow_rays = {round.most, &round.counts->shadows};
    tracer_->find_occlusions(shadows.query(work.job.passes_thin_walls), shadow_rays,
                             {nullptr, shadows.keys}, // a ray's key has been used by then
                             round.pool(RayKind::Shadow));
    const PathQueueView next = w.paths(w.round + 1);
    choose_shading(work.job, [&]<Features, class Listener>() {
        launch(queue_, "add_light", shadow_rays, AddLight<Listener>{work.job, shadows, next, w.listened(w.round)});
    });
}

} // namespace pertev
