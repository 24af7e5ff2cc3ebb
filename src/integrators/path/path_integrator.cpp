#include "integrators/path/path_integrator.h"

#include <algorithm>
#include <atomic>

#include "base/parallel_for.h"
#include "device/launch.h"
#include "integrators/path/path_stages.h"
#include "render/find_hit.h"

namespace pertev {
namespace {

uint32_t capacity_for(uint64_t samples, uint32_t batch) {
    return static_cast<uint32_t>(std::min<uint64_t>(samples, batch));
}

} // namespace

PathIntegrator::Queues::Queues(Queue& queue, uint32_t paths)
    : capacity(paths), path_rays(queue, paths, "path rays"), shadow_rays(queue, paths, "shadow rays"),
      path_ends(queue, paths, "path rays"), shadow_ends(queue, paths, "shadow rays"),
      path_keys(queue, paths, "path rays"), shadow_keys(queue, paths, "shadow rays"), throughput(queue, paths, "paths"),
      radiance(queue, paths, "paths"), contribution(queue, paths, "shadow rays"), hit_places(queue, paths, "hits"),
      samples(queue, paths, "paths"), hit_instances(queue, paths, "hits"),
      active{{queue, paths, "active paths"}, {queue, paths, "active paths"}}, counts(queue, 2, "queue lengths") {}

std::size_t PathIntegrator::wavefront_bytes(uint64_t samples, uint32_t batch) {
    constexpr std::size_t of_path = 2 * (sizeof(Ray) + sizeof(Uint4) + sizeof(uint32_t)) + 4 * sizeof(Float4) +
                                    sizeof(Uint2) + 3 * sizeof(uint32_t);
    return of_path * capacity_for(samples, batch) + 2 * sizeof(uint32_t);
}

std::size_t PathIntegrator::bytes() const {
    return queues_ ? wavefront_bytes(queues_->capacity, queues_->capacity) : 0;
}

PathIntegrator::PathIntegrator(Queue& queue, const PathSettings& settings, PathBody body, uint32_t batch)
    : queue_(queue), settings_(settings), body_(body), batch_(batch) {}

void PathIntegrator::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    if (trees_of_loop() != nullptr) return;
    const uint64_t all = uint64_t(picture.camera.width) * picture.camera.height * samples;
    const uint32_t capacity = capacity_for(all, batch_);
    if (queues_ && queues_->capacity >= capacity) return;
    queues_.reset(); // before there is more
    queues_.emplace(queue_, capacity);
}

const HostTrees* PathIntegrator::trees_of_loop() const {
    return body_ == PathBody::Loop ? tracer_->host_trees() : nullptr;
}

PathQueueView PathIntegrator::path_queue() const {
    const Queues& q = *queues_;
    return {q.path_rays.data(),  q.path_ends.data(), q.path_keys.data(),
            q.throughput.data(), q.radiance.data(),  q.samples.data()};
}

ShadowQueueView PathIntegrator::shadow_queue() const {
    const Queues& q = *queues_;
    return {q.shadow_rays.data(), q.shadow_ends.data(), q.shadow_keys.data(), q.contribution.data()};
}

void PathIntegrator::render(uint32_t first, uint32_t count, Film& film) {
    const FilmView view = film.view();
    if (const HostTrees* trees = trees_of_loop()) {
        render_loop(first, count, view, *trees);
    } else {
        render_wavefront(first, count, view);
    }
}

void PathIntegrator::render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees) {
    const uint32_t width = picture_.camera.width, height = picture_.camera.height;
    std::atomic<uint64_t> bounces{0}, shadows{0};
    parallel_for_ranges(uint64_t(width) * height, 64, [&](uint64_t begin, uint64_t end) {
        RayCounts counts;
        for (uint64_t i = begin; i < end; ++i) {
            const uint32_t pixel = tiled_pixel(static_cast<uint32_t>(i), width, height);
            for (uint32_t sample = first; sample < first + count; ++sample) {
                trace_path(generate_path(picture_.camera, settings_, pixel, sample), film, trees, counts);
            }
        }
        bounces += counts.bounce;
        shadows += counts.shadow;
    });
    rays_.camera += uint64_t(width) * height * count;
    rays_.bounce += bounces;
    rays_.shadow += shadows;
}

void PathIntegrator::trace_path(PathState path, const FilmView& film, const HostTrees& trees, RayCounts& counts) const {
    const SceneView& scene = picture_.scene;
    for (bool goes_on = true; goes_on;) {
        const Ray ray = {path.origin, 0.0f, path.direction, kInfinity};
        const AcceptHit accept{scene, path.start, {}, path_key(path, settings_.seed, false)};
        const bool looks = path.depth == 0 && scene.any_hidden_back != 0;
        const Hit hit =
            looks ? find_hit(trees, ray, AcceptCameraHit{accept, ray.direction}) : find_hit(trees, ray, accept);
        const uint32_t key = path_key(path, settings_.seed, true);
        ShadowRay shadow;
        bool wants_shadow = false;
        goes_on = shade_hit(picture_, settings_, film, path, hit, shadow, wants_shadow);
        counts.bounce += goes_on ? 1 : 0;
        if (!wants_shadow) continue;
        ++counts.shadow;
        if (!is_occluded(trees, {shadow.origin, 0.0f, shadow.direction, shadow.t_max},
                         AcceptHit{scene, {hit.instance, hit.primitive}, shadow.target, key})) {
            path.radiance += shadow.contribution;
        }
    }
    add_radiance(film, path.pixel, path.radiance);
}

void PathIntegrator::render_wavefront(uint32_t first, uint32_t count, const FilmView& film) {
    const uint32_t picture = picture_.camera.width * picture_.camera.height;
    const uint32_t pixels = std::min(picture, queues_->capacity);
    const uint32_t samples = std::min(count, queues_->capacity / pixels);
    for (uint32_t sample = 0; sample < count; sample += samples) {
        for (uint32_t pixel = 0; pixel < picture; pixel += pixels) {
            const uint32_t batch_pixels = std::min(pixels, picture - pixel);
            const uint32_t batch = batch_pixels * std::min(samples, count - sample);
            launch(queue_, "generate_paths", batch,
                   GeneratePaths{picture_.camera, settings_, pixel, batch_pixels, first + sample,
                                 picture_.scene.any_alpha != 0, path_queue()});
            rays_.camera += batch;
            trace_batch(batch, film);
        }
    }
    queue_.wait();
}

void PathIntegrator::trace_batch(uint32_t batch, const FilmView& film) {
    const Queues& q = *queues_;
    const PathQueueView paths = path_queue();
    const ShadowQueueView shadows = shadow_queue();
    const HitQueueView hits = {q.hit_places.data(), q.hit_instances.data()};
    Buffer<uint32_t>& lengths = queues_->counts;
    const uint32_t* active = nullptr; // at first every slot
    int next = 0;
    for (uint32_t count = batch; count > 0;) {
        const SlotListView going_on = {q.active[next].data(), lengths.data()};
        lengths.zero();
        tracer_->find_hits(active == nullptr ? RayKind::Camera : RayKind::Bounce,
                           {paths.rays, paths.ends, paths.keys, active}, count, hits);
        launch(queue_, "shade_hits", count,
               ShadeHits{picture_, settings_, film, paths, active, hits, going_on, shadows, lengths.data() + 1});
        const std::vector<uint32_t> counts = lengths.download();
        const HitQueueView occlusions = {nullptr, q.hit_instances.data()}; // the hits have been used
        tracer_->find_occlusions({shadows.rays, shadows.ends, shadows.keys}, counts[1], occlusions);
        launch(queue_, "add_light", counts[1], AddLight{shadows, occlusions.instances, paths});
        rays_.bounce += counts[0];
        rays_.shadow += counts[1];
        active = q.active[next].data();
        next = 1 - next;
        count = counts[0];
    }
    launch(queue_, "add_to_film", batch, AddToFilm{film, paths});
}

} // namespace pertev
