#include "session/moving_scene.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "device_scene/place_meshes.h"
#include "device_scene/scene_on_device.h"

namespace pertev {
namespace {

/// Marks the instances that move while the shutter is open, now or before, as changed.
void add_moving(const std::shared_ptr<const MotionKeys>& now, const std::shared_ptr<const MotionKeys>& before,
                SceneUpdate& update) {
    for (const auto& motions : {now, before}) {
        if (motions == nullptr) continue;
        for (uint32_t i = 0; i < motions->of_instance.size(); ++i) {
            if (motions->of_instance[i] != kNoMotion) update.moved_instances.push_back(i);
        }
    }
    std::ranges::sort(update.moved_instances);
    const auto copies = std::ranges::unique(update.moved_instances);
    update.moved_instances.erase(copies.begin(), copies.end());
}

/// Returns the shares of the open shutter's time at which an animation has a key, the first ones if there are many, and
/// the midpoints between them.
std::vector<double> keys_within(const Scene& scene, double time_s, const Shutter& shutter) {
    constexpr std::size_t kMaxShares = 64;
    const double open_s = shutter.time_at(time_s, 0), length_s = shutter.close_s - shutter.open_s;
    std::set<double> shares;
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            for (const float key_s : channel.times) {
                const double share = (static_cast<double>(key_s) - open_s) / length_s;
                if (share > 0 && share < 1 && shares.size() < kMaxShares) shares.insert(share);
            }
        }
    }
    std::vector<double> times(shares.begin(), shares.end());
    for (std::size_t i = 0; i + 1 < shares.size(); ++i) times.push_back(0.5 * (times[i] + times[i + 1]));
    return times;
}

} // namespace

MovingScene::MovingScene(Scene rest, std::optional<double> time_s, PrepareOptions options, Sink& sink,
                         std::optional<Shutter> shutter)
    : posed_(std::move(rest), true), shutter_(shutter), time_s_(time_s), options_(std::move(options)) {
    options_.centre = world_centre(posed_.scene());
    if (time_s) posed_.set_time(*time_s);
    if (time_s) options_.motions = motions_at(*time_s);
    prepared_ = prepare_scene(posed_.scene(), options_, sink);
    if (time_s) prepared_.poses = posed_.poses();
}

/// Motions of the instances that are not baked (place_meshes) and move while the shutter is open.
std::shared_ptr<const MotionKeys> MovingScene::motions_at(double time_s) {
    if (!shutter_ || !posed_.is_animated()) return nullptr;
    const Scene& now = scene();
    std::vector<PlacedBox> things;
    std::vector<uint32_t> instances;
    const std::vector<bool> moves = may_move(now);
    for (uint32_t i = 0; i < now.instances.size(); ++i) {
        const Instance& instance = now.instances[i];
        if (!moves[i] || instance.is_hidden || is_skewed(instance.world_from_local)) continue;
        const Bounds3 box = bounds_of(now.meshes[instance.mesh]);
        if (box.is_empty()) continue;
        things.push_back({moved_to(instance.world_from_local, *options_.centre), box});
        instances.push_back(i);
    }
    const auto places_at = [&](double share) {
        const double then_s = shutter_->time_at(time_s, share);
        const PosedScene::Placements placements = posed_.placements_at(then_s);
        std::vector<std::optional<Transform>> of_things;
        for (const uint32_t i : instances) {
            const std::optional<Transform>& placement = placements.instances[i];
            if (placement && !is_within_limits(*placement, bounds_of(now.meshes[now.instances[i].mesh]))) {
                throw Error(
                    ErrorCode::OverLimit, "shutter", "",
                    fmt::format("instance {} lies beyond 2^40 metres at {} s, while it is open; scale the scene down",
                                i, then_s));
            }
            of_things.push_back(placement ? std::optional(moved_to(*placement, *options_.centre)) : std::nullopt);
        }
        return of_things;
    };
    const FittedMotions fitted = fit_motions(things, places_at, keys_within(now, time_s, *shutter_));
    auto motions = std::make_shared<MotionKeys>();
    motions->segments = fitted.segments;
    motions->of_instance.assign(now.instances.size(), kNoMotion);
    for (std::size_t k = 0; k < instances.size(); ++k) {
        const Motion& motion = fitted.motions[k];
        if (motion.keys.empty()) continue;
        motions->of_instance[instances[k]] = static_cast<uint32_t>(motions->pivots.size());
        motions->pivots.push_back(motion.pivot);
        motions->keys.insert(motions->keys.end(), motion.keys.begin(), motion.keys.end());
    }
    return motions->pivots.empty() ? nullptr : motions;
}

double MovingScene::end_s() const {
    double end_s = 0;
    for (const Animation& animation : scene().animations) end_s = std::max(end_s, animation.end_s());
    return end_s;
}

uint32_t MovingScene::set_time(double time_s, Sink& sink) {
    const bool was_behind = std::exchange(is_behind_, true), was_at_rest = prepared_.poses.empty();
    SceneUpdate update = posed_.set_time(time_s);
    const auto motions = motions_at(time_s);
    if (motions != nullptr || prepared_.motions != nullptr) add_moving(motions, prepared_.motions, update);
    options_.motions = motions;
    uint32_t parts = apply(std::move(update), was_behind, sink);
    if (was_at_rest && !posed_.poses().empty()) parts |= kPartShapes | kPartPoses;
    prepared_.poses = posed_.poses();
    time_s_ = time_s;
    return parts;
}

uint32_t MovingScene::edit(const std::function<SceneUpdate(Scene&)>& edit, Sink& sink) {
    SceneUpdate update = posed_.edit(edit);
    bool prepares_anew = std::exchange(is_behind_, true);
    if (time_s_) update += posed_.set_time(*time_s_);
    if (!update.moved_instances.empty() && !is_animated()) {
        const Vec3 centre = world_centre(scene());
        prepares_anew = prepares_anew || !(centre == *options_.centre);
        options_.centre = centre;
    }
    count_baked_moves(update, sink);
    const uint32_t parts = apply(std::move(update), prepares_anew, sink);
    prepared_.poses = time_s_ ? posed_.poses() : prepared_.poses;
    return parts;
}

void MovingScene::count_baked_moves(const SceneUpdate& update, Sink& sink) {
    constexpr int kOften = 3;
    constexpr uint64_t kLargeTree = 20'000; // triangles; refitting fewer takes a few milliseconds at most
    // Skewed instances are baked whatever they are named.
    const auto could_be_apart = [&](uint32_t i) {
        return prepared_.is_baked[i] && !is_skewed(scene().instances[i].world_from_local);
    };
    const auto moved = std::ranges::find_if(update.moved_instances, could_be_apart);
    if (moved == update.moved_instances.end() || ++baked_moves_ != kOften) return;
    const uint64_t triangles = prepared_.trees.triangles.front();
    if (triangles < kLargeTree) return;
    sink.warn(
        fmt::format("{} is in a tree of {} triangles, which each move refits; name it in `movable`, so that it gets "
                    "one of its own",
                    numbered("instance", *moved, scene().instances[*moved].name), triangles));
}

/// Brings prepared() up to date after `update`. Returns the parts that have changed.
uint32_t MovingScene::apply(SceneUpdate update, bool prepares_anew, Sink& sink) {
    uint32_t parts = 0;
    if (prepares_anew) {
        prepared_ = prepare_scene(posed_.scene(), options_, sink);
        parts = kAllParts;
    } else if (!update.is_empty()) {
        if (changes_prepared(update)) {
            prepared_ = update_scene(prepared_, posed_.scene(), update, sink, options_.motions);
        }
        parts = parts_of(update);
    }
    is_behind_ = false;
    return parts;
}

} // namespace pertev
