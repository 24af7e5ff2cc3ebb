#include "integrators/path/path_integrator.h"

#include <algorithm>
#include <atomic>

#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "device/launch.h"
#include "integrators/path/path_stages.h"

namespace pertev {

namespace {

uint32_t capacity_for(uint64_t samples, uint32_t batch) {
    return static_cast<uint32_t>(std::min<uint64_t>(samples, batch));
}

} // namespace

PathIntegrator::PathIntegrator(Queue& queue, const PathSettings& settings, PathBody body, uint32_t batch)
    : queue_(queue), settings_(settings), body_(queue.is_cuda() ? PathBody::Wavefront : body), batch_(batch) {}

std::size_t PathIntegrator::predicted_bytes(uint64_t samples, bool on_cuda, PathBody body, uint32_t batch) {
    const bool wavefront = on_cuda || body == PathBody::Wavefront;
    return wavefront ? kBytesPerPath * capacity_for(samples, batch) : 0;
}

void PathIntegrator::begin(const PictureView& picture, uint32_t samples) {
    picture_ = picture;
    rays_ = {};
    if (body_ == PathBody::Loop) return;
    take_queues(capacity_for(uint64_t(picture.camera.width) * picture.camera.height * samples, batch_));
}

void PathIntegrator::take_queues(uint32_t capacity) {
    if (capacity <= capacity_) return;
    capacity_ = capacity;
    for (auto& floats : path_floats_) floats = Buffer<Float4>(queue_, capacity, "path queue");
    for (auto& floats : shadow_floats_) floats = Buffer<Float4>(queue_, capacity, "shadow ray queue");
    hit_floats_ = Buffer<Float4>(queue_, capacity, "hit queue");
    path_ids_ = Buffer<Uint4>(queue_, capacity, "path queue");
    shadow_ids_ = Buffer<Uint4>(queue_, capacity, "shadow ray queue");
    hit_ids_ = Buffer<Uint4>(queue_, capacity, "hit queue");
    for (auto& list : active_) list = Buffer<uint32_t>(queue_, capacity, "active paths");
    counts_ = Buffer<uint32_t>(queue_, 2, "queue lengths");
}

template <class Stage>
void PathIntegrator::run(const char* name, uint32_t count, const Stage& stage, double StageSeconds::*seconds) {
    if (seconds_ == nullptr) return launch(queue_, name, count, stage);
    queue_.wait();
    const Stopwatch watch;
    launch(queue_, name, count, stage);
    queue_.wait();
    seconds_->*seconds += watch.seconds();
}

PathQueueView PathIntegrator::path_queue() const {
    return {path_floats_[0].data(), path_floats_[1].data(), path_floats_[2].data(), path_floats_[3].data(),
            path_ids_.data()};
}

void PathIntegrator::render(uint32_t first, uint32_t count, Film& film) {
    const FilmView view = film.view();
    if (body_ == PathBody::Loop) {
        render_loop(first, count, view);
    } else {
        render_wavefront(first, count, view);
    }
}

void PathIntegrator::render_loop(uint32_t first, uint32_t count, const FilmView& film) {
    std::atomic<uint64_t> bounces{0}, shadows{0};
    parallel_for_ranges(
        uint64_t(picture_.camera.width) * picture_.camera.height, 64, [&](uint64_t begin, uint64_t end) {
            RayCounts counts;
            for (uint64_t i = begin; i < end; ++i) {
                const uint32_t pixel =
                    tiled_pixel(static_cast<uint32_t>(i), picture_.camera.width, picture_.camera.height);
                for (uint32_t sample = first; sample < first + count; ++sample) {
                    PathState path = generate_path(picture_.camera, settings_, pixel, sample);
                    for (bool goes_on = true; goes_on;) {
                        const bool looks = path.depth == 0 && picture_.scene.any_hidden_back != 0;
                        const Hit hit = looks ? find_camera_hit(picture_.scene, path, settings_.seed)
                                              : find_hit(picture_.scene, path, settings_.seed);
                        const uint32_t key = path_key(path, settings_.seed, true);
                        ShadowRay shadow;
                        bool wants_shadow = false;
                        goes_on = shade_hit(picture_, settings_, film, path, hit, shadow, wants_shadow);
                        counts.bounce += goes_on ? 1 : 0;
                        if (!wants_shadow) continue;
                        ++counts.shadow;
                        if (!is_occluded(picture_.scene, shadow.origin, shadow.direction, shadow.t_max,
                                         {hit.instance, hit.primitive}, shadow.target, key)) {
                            path.radiance += shadow.contribution;
                        }
                    }
                    add_radiance(film, pixel, path.radiance);
                }
            }
            bounces += counts.bounce;
            shadows += counts.shadow;
        });
    rays_.camera += uint64_t(picture_.camera.width) * picture_.camera.height * count;
    rays_.bounce += bounces;
    rays_.shadow += shadows;
}

void PathIntegrator::render_wavefront(uint32_t first, uint32_t count, const FilmView& film) {
    const uint32_t picture = picture_.camera.width * picture_.camera.height;
    const uint32_t pixels = std::min(picture, capacity_);
    const uint32_t samples = std::min(count, capacity_ / pixels);
    const PathQueueView paths = path_queue();
    for (uint32_t sample = 0; sample < count; sample += samples) {
        for (uint32_t pixel = 0; pixel < picture; pixel += pixels) {
            const uint32_t batch_pixels = std::min(pixels, picture - pixel);
            const uint32_t batch = batch_pixels * std::min(samples, count - sample);
            run("generate_paths", batch,
                GeneratePaths{picture_.camera, settings_, pixel, batch_pixels, first + sample, paths},
                &StageSeconds::generate);
            rays_.camera += batch;
            trace_batch(batch, film);
        }
    }
    queue_.wait();
}

void PathIntegrator::trace_batch(uint32_t batch, const FilmView& film) {
    const PathQueueView paths = path_queue();
    const HitQueueView hits = {hit_floats_.data(), hit_ids_.data()};
    const ShadowQueueView shadows = {shadow_floats_[0].data(), shadow_floats_[1].data(), shadow_floats_[2].data(),
                                     shadow_ids_.data()};
    const uint32_t* active = nullptr; // at first every slot
    int next = 0;
    for (uint32_t count = batch; count > 0;) {
        const SlotListView going_on = {active_[next].data(), counts_.data()};
        counts_.zero();
        const bool from_camera = active == nullptr;
        if (from_camera && picture_.scene.any_hidden_back != 0) {
            run("find_camera_hits", count, FindCameraHits{picture_.scene, settings_.seed, paths, hits},
                &StageSeconds::camera_hits);
        } else {
            run("find_hits", count, FindHits{picture_.scene, settings_.seed, paths, active, hits},
                from_camera ? &StageSeconds::camera_hits : &StageSeconds::bounce_hits);
        }
        run("shade_hits", count,
            ShadeHits{picture_, settings_, film, paths, active, hits, going_on, shadows, counts_.data() + 1},
            &StageSeconds::shade);
        const std::vector<uint32_t> counts = counts_.download();
        run("trace_shadows", counts[1], TraceShadows{picture_.scene, shadows, paths}, &StageSeconds::shadows);
        rays_.bounce += counts[0];
        rays_.shadow += counts[1];
        active = active_[next].data();
        next = 1 - next;
        count = counts[0];
    }
    run("add_to_film", batch, AddToFilm{film, paths}, &StageSeconds::film);
}

} // namespace pertev
