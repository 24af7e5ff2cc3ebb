#pragma once

// The functions of RayTreeIntegrator: included by the .cpp of each algorithm, and by nothing else.

#include <algorithm>
#include <atomic>
#include <memory>
#include <vector>

#include "base/error.h"
#include "base/parallel_for.h"
#include "device/launch.h"
#include "device_scene/find_hits.h"
#include "integrators/ray_tree/ray_tree_integrator.h"
#include "integrators/ray_tree/tree_stages.h"

namespace pertev {
namespace ray_tree {

inline constexpr std::size_t kMostTreeBytes = std::size_t(1) << 30; // of a device
inline constexpr std::size_t kLoopBytes = std::size_t(1) << 19;     // of a thread: what its cache holds
inline constexpr uint64_t kLoopPixels = 256;                        // at least, that a thread takes at once

/// Rays that a tree holds at most: the one under way and, of each vertex above it, all branches but the one taken.
template <class Algorithm>
uint32_t entries(const RayTreeSettings& settings) {
    return Algorithm::kMostBranches > 1 ? 1 + (Algorithm::kMostBranches - 1) * settings.max_depth : 1;
}

inline std::size_t bytes_of(uint32_t trees, uint32_t entries, bool has_times) {
    TreesView view;
    return lay_out(view, nullptr, trees, entries, has_times);
}

/// As many trees as fit into `bytes`, at most `most` and at least 32.
inline uint32_t trees_within(std::size_t bytes, uint64_t most, uint32_t entries, bool has_times) {
    const std::size_t each = bytes_of(32, entries, has_times) / 32;
    return static_cast<uint32_t>(std::min<uint64_t>(most, std::max<std::size_t>(bytes / each, 32)));
}

/// The trees of one thread of the CPU, taken through all stages.
template <class Algorithm>
class TreeLoop {
public:
    TreeLoop(const PictureView& picture, const RayTreeSettings& settings, const HostTrees& scene, const FilmView& film)
        : picture_(picture), settings_(settings), scene_(scene), film_(film) {
        const uint32_t stacked = entries<Algorithm>(settings);
        const bool moves = picture.scene.motions.is_there();
        capacity_ = trees_within(kLoopBytes, 128, stacked, moves);
        memory_.resize(bytes_of(capacity_, stacked, moves) / sizeof(Float4) + 1);
        lay_out(trees_, reinterpret_cast<std::byte*>(memory_.data()), capacity_, stacked, moves);
        *trees_.counts = {};
        hits_.resize(capacity_);
        met_ = std::make_unique<bool[]>(std::size_t(capacity_) * kShadowsAtOnce);
    }

    void render(const BeginOrder& samples) {
        const uint64_t all = samples.count();
        for (uint64_t first = 0; first < all; first += capacity_) {
            const auto trees = static_cast<uint32_t>(std::min<uint64_t>(capacity_, all - first));
            run(trees, BeginTrees{picture_.camera, settings_, trees_, samples, first});
            BeginRounds{trees_.counts, trees}(0);
            for (uint32_t round = 0; trees_.counts->rays > 0; ++round) give_round(round);
        }
    }
    const TreeCounts& counts() const { return *trees_.counts; }

private:
    template <class Stage>
    static void run(uint32_t count, const Stage& stage) {
        for (uint32_t i = 0; i < count; ++i) stage(i);
    }

    void give_round(uint32_t round) {
        const uint32_t rays = trees_.counts->rays;
        find_hits_of(rays, round);
        const uint32_t shadows = Algorithm::shadow_rays(picture_.scene.lights);
        for (uint32_t first = 0; first == 0 || first < shadows; first += kShadowsAtOnce) {
            const bool is_last = first + kShadowsAtOnce >= shadows;
            run(rays,
                ShadeTrees<Algorithm, MotionKnown::Perhaps>{picture_, settings_, film_, trees_, round, first, is_last});
            find_occlusions_of(trees_.counts->shadows);
            run(rays, AddTreeLight{trees_, round});
            CountTrees{trees_.counts, false}(0);
        }
        run(rays, TakeNextRays{picture_.camera, settings_, film_, trees_, round});
        CountTrees{trees_.counts, true}(0);
    }

    void find_hits_of(uint32_t rays, uint32_t round) {
        const auto ray_of = [&](uint32_t i) { return trees_.rays[i]; };
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{picture_.scene,
                             {trees_.starts[i].x, trees_.starts[i].y},
                             {},
                             trees_.keys[i],
                             trees_.times != nullptr ? trees_.times[i] : kAtRest};
        };
        const RayOrder order = round == 0 ? RayOrder::Together : RayOrder::Scattered;
        if (round == 0 && picture_.scene.any_hidden_back != 0) {
            const auto accept_camera = [&](uint32_t i) {
                return AcceptCameraHit{accept_of(i), trees_.rays[i].direction};
            };
            find_hits(scene_, rays, order, ray_of, accept_camera, hits_.data());
        } else {
            find_hits(scene_, rays, order, ray_of, accept_of, hits_.data());
        }
        for (uint32_t i = 0; i < rays; ++i) trees_.hits().store(i, hits_[i]);
    }

    void find_occlusions_of(uint32_t shadows) {
        const auto ray_of = [&](uint32_t i) { return trees_.shadow_rays[i]; };
        const auto accept_of = [&](uint32_t i) {
            const Uint2 start = trees_.shadow_starts[i], target = trees_.shadow_targets[i];
            return AcceptHit{picture_.scene,
                             {start.x, start.y},
                             {target.x, target.y},
                             trees_.shadow_keys[i],
                             trees_.shadow_times != nullptr ? trees_.shadow_times[i] : kAtRest};
        };
        find_occlusions(scene_, shadows, RayOrder::Together, ray_of, accept_of, met_.get());
        for (uint32_t i = 0; i < shadows; ++i) trees_.shadow_keys[i] = met_[i] ? 0 : kNoHit;
    }

    const PictureView& picture_;
    const RayTreeSettings& settings_;
    const HostTrees& scene_;
    const FilmView& film_;
    uint32_t capacity_;
    std::vector<Float4> memory_;
    TreesView trees_{};
    std::vector<Hit> hits_;
    std::unique_ptr<bool[]> met_;
};

} // namespace ray_tree

template <class Algorithm>
RayTreeIntegrator<Algorithm>::RayTreeIntegrator(Queue& queue, const RayTreeSettings& settings, bool in_loop,
                                                uint32_t batch)
    : queue_(queue), settings_(settings), in_loop_(in_loop), batch_(batch), seen_(queue) {}

template <class Algorithm>
std::size_t RayTreeIntegrator<Algorithm>::predicted_bytes(const RayTreeSettings& settings, uint64_t samples,
                                                          uint32_t batch, bool has_times) {
    const uint32_t stacked = ray_tree::entries<Algorithm>(settings);
    const uint64_t most = std::min<uint64_t>(samples, batch);
    const uint32_t trees = ray_tree::trees_within(ray_tree::kMostTreeBytes, most, stacked, has_times);
    return ray_tree::bytes_of(trees, stacked, has_times);
}

template <class Algorithm>
const HostTrees* RayTreeIntegrator<Algorithm>::trees_of_loop() const {
    return in_loop_ ? tracer_->host_trees() : nullptr;
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) {
    picture_ = picture;
    tracer_ = &tracer;
    rays_ = {};
    picture_settings_ = settings_;
    const LightSetView& lights = picture.scene.lights;
    if (!settings_.has_ambient) {
        picture_settings_.ambient = Algorithm::ambient(lights.has_environment() ? &lights.environment : nullptr);
    }
    if (trees_of_loop() != nullptr) return;
    const uint32_t stacked = ray_tree::entries<Algorithm>(settings_);
    const uint64_t all = uint64_t(picture.camera.width) * picture.camera.height * samples;
    const bool moves = picture.scene.motions.is_there();
    const uint32_t wanted =
        ray_tree::trees_within(ray_tree::kMostTreeBytes, std::min<uint64_t>(all, batch_), stacked, moves);
    const std::size_t bytes = ray_tree::bytes_of(wanted, stacked, moves);
    if (memory_.size() < bytes) {
        memory_ = {}; // before there is more
        memory_ = {queue_, bytes, "ray trees"};
    }
    lay_out(trees_, memory_.data(), wanted, stacked, moves);
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::render(uint32_t first, uint32_t count, const FilmView& film) {
    PERTEV_CHECK(!film.frame.is_there());
    if (const HostTrees* trees = trees_of_loop()) {
        render_loop(first, count, film, *trees);
    } else {
        render_all_at_once(first, count, film);
    }
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::render_loop(uint32_t first, uint32_t count, const FilmView& film,
                                               const HostTrees& trees) {
    const uint64_t pixels = uint64_t(picture_.camera.width) * picture_.camera.height;
    std::atomic<uint64_t> bounces{0}, shadows{0};
    parallel_for_ranges(pixels, ray_tree::kLoopPixels, [&](uint64_t begin, uint64_t end) {
        if (abandon_ != nullptr && *abandon_) return;
        ray_tree::TreeLoop<Algorithm> loop(picture_, picture_settings_, trees, film);
        loop.render({static_cast<uint32_t>(begin), static_cast<uint32_t>(end - begin), first, count});
        bounces += loop.counts().bounces;
        shadows += loop.counts().all_shadows;
    });
    rays_ = rays_ + RayCounts{pixels * count, bounces, shadows};
}

template <class Algorithm>
void RayTreeIntegrator<Algorithm>::render_all_at_once(uint32_t first, uint32_t count, const FilmView& film) {
    const BeginOrder samples = {0, picture_.camera.width * picture_.camera.height, first, count};
    const uint64_t all = samples.count();
    queue_.zero(trees_.counts, sizeof(TreeCounts));
    for (uint64_t done = 0; done < all; done += trees_.capacity) {
        const auto trees = static_cast<uint32_t>(std::min<uint64_t>(trees_.capacity, all - done));
        launch(queue_, "begin_trees", trees, BeginTrees{picture_.camera, picture_settings_, trees_, samples, done});
        launch(queue_, "begin_rounds", 1, BeginRounds{trees_.counts, trees});
        give_rounds(trees, film);
    }
    TreeCounts counts;
    queue_.copy_to_host(&counts, trees_.counts, sizeof counts);
    rays_ = rays_ + RayCounts{all, counts.bounces, counts.all_shadows};
}

/// One launch of ShadeTrees.
template <class Algorithm>
void RayTreeIntegrator<Algorithm>::shade(const WorkCount& rays, const FilmView& film, uint32_t round, uint32_t first,
                                         bool is_last) {
    const auto shade_as = [&]<MotionKnown kMotion>() {
        launch(queue_, "shade_trees", rays,
               ShadeTrees<Algorithm, kMotion>{picture_, picture_settings_, film, trees_, round, first, is_last});
    };
    if constexpr (Algorithm::kHasShutter) {
        if (picture_.camera.is_open) return shade_as.template operator()<MotionKnown::Perhaps>();
    }
    shade_as.template operator()<MotionKnown::None>();
}

/// The host gives rounds without waiting for one, and reads one round late how many rays there were.
template <class Algorithm>
void RayTreeIntegrator<Algorithm>::give_rounds(uint32_t trees, const FilmView& film) {
    const uint32_t shadows = Algorithm::shadow_rays(picture_.scene.lights);
    uint32_t most = trees; // rays of the round: never more than of the one before
    for (uint32_t round = 0;; ++round) {
        const WorkCount rays = {most, &trees_.counts->rays};
        tracer_->find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, trees_.query(), rays, trees_.hits());
        for (uint32_t first = 0; first == 0 || first < shadows; first += kShadowsAtOnce) {
            const bool is_last = first + kShadowsAtOnce >= shadows;
            shade(rays, film, round, first, is_last);
            if (shadows > 0) {
                const uint64_t asked = uint64_t(most) * std::min(shadows - first, kShadowsAtOnce);
                tracer_->find_occlusions(trees_.shadow_query(), {static_cast<uint32_t>(asked), &trees_.counts->shadows},
                                         {nullptr, trees_.shadow_keys}); // a ray's key has been used by then
                launch(queue_, "add_tree_light", rays, AddTreeLight{trees_, round});
            }
            launch(queue_, "count_trees", 1, CountTrees{trees_.counts, false});
        }
        launch(queue_, "take_next_rays", rays, TakeNextRays{picture_.camera, picture_settings_, film, trees_, round});
        launch(queue_, "count_trees", 1, CountTrees{trees_.counts, true});
        if (round > 0) {
            most = seen_.wait().rays;
            if (most == 0) return;
        }
        seen_.take(trees_.counts);
    }
}

} // namespace pertev
