#include "session/survey/weak_light.h"

#include "base/sink.h"
#include "device/queue.h"
#include "scene/pose/posed_scene.h"
#include "session/meter_exposure.h"
#include "session/session.h"
#include "session/survey/default_camera.h"

namespace pertev {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 36, kBlock = 4, kDepth = 6;
constexpr uint32_t kFewSamples = 4, kSamples = 16;         // the former suffice for most scenes
constexpr float kVisible = 0.18f / 16;                     // four stops below middle grey
constexpr float kBurnt = 16;                               // agx maps it to white
constexpr double kShareToSeeBy = 0.75, kMaxBurnt = 0.0625; // shares of the surfaces in the picture
constexpr double kNextToNothing = 0.03125;

/// The shares of a picture, and that of burnt pixels with no burnt neighbour, of which more samples find more.
struct Shares {
    SeenShares seen;
    double sparks = 0;
};

/// Returns the shares of the picture with settings.samples.
Shares shares_in_picture(Session& session, const RenderSettings& settings) {
    const auto render = [&](const RenderSettings& requested) {
        session.set_settings(requested);
        session.cut();
        session.render(requested.samples);
        return session.picture();
    };
    const Image picture = render(settings);
    // The meter requests the full light, and that of emitters alone; pictures of this size suffice here.
    const float scale = exposure_scale(meter_exposure(settings, ToneMap::Agx, [&](RenderSettings requested) {
        requested.width = kWidth, requested.height = kHeight, requested.samples = settings.samples;
        return requested.path.max_depth > 0 && requested.transparent ? picture : render(requested);
    }));
    // Means of blocks, because single pixels with so few samples are dark by chance.
    double lit = 0, burnt = 0, sparks = 0, all = 0;
    const auto is_burnt = [&](uint32_t x, uint32_t y) {
        const float* pixel = picture.at(x, y);
        return scale * luminance(Rgb{pixel[0], pixel[1], pixel[2]}) >= kBurnt;
    };
    for (uint32_t top = 0; top < kHeight; top += kBlock) {
        for (uint32_t left = 0; left < kWidth; left += kBlock) {
            float light = 0, covered = 0;
            for (uint32_t y = top; y < top + kBlock; ++y) {
                for (uint32_t x = left; x < left + kBlock; ++x) {
                    const float* pixel = picture.at(x, y);
                    light += luminance(Rgb{pixel[0], pixel[1], pixel[2]});
                    covered += pixel[3];
                    if (!is_burnt(x, y)) continue;
                    burnt += static_cast<double>(pixel[3]);
                    const bool has_neighbour = (x > 0 && is_burnt(x - 1, y)) ||
                                               (x + 1 < kWidth && is_burnt(x + 1, y)) ||
                                               (y > 0 && is_burnt(x, y - 1)) || (y + 1 < kHeight && is_burnt(x, y + 1));
                    if (!has_neighbour) sparks += static_cast<double>(pixel[3]);
                }
            }
            if (!(covered > 0)) continue;
            all += static_cast<double>(covered);
            if (scale * light >= kVisible * covered) lit += static_cast<double>(covered);
        }
    }
    return all > 0 ? Shares{{lit / all, burnt / all}, sparks / all} : Shares{};
}

/// Returns whether kSamples would not change what follows from the shares of kFewSamples.
bool is_certain(const Shares& few) {
    const double more = static_cast<double>(kSamples) / kFewSamples - 1;
    return few.seen.lit > 0.5 * (1 + kShareToSeeBy) && few.seen.burnt + more * few.sparks < 0.5 * kMaxBurnt;
}

SeenShares visible_shares(const Camera& camera, const Scene& scene, Sink& sink) {
    Queue queue = Queue::make_cpu();
    RenderSettings settings;
    settings.width = kWidth, settings.height = kHeight, settings.samples = kFewSamples;
    settings.filter = PixelFilter::Box;
    settings.transparent = true;
    settings.tracers = default_tracers(false, TreeBuild::Fast); // few rays need trees that are built quickly
    PartMessages discarded(sink);
    const PreparedScene prepared = prepare_scene(scene, prepare_options(settings, false), discarded);
    settings.path.max_depth = kDepth;
    Session session(queue, prepared, camera, settings);
    const Shares few = shares_in_picture(session, settings);
    if (is_certain(few)) return few.seen;
    settings.samples = kSamples;
    return shares_in_picture(session, settings).seen;
}

} // namespace

SeenShares shares_seen(const Scene& scene, Sink& sink) {
    const bool has_camera = !scene.cameras.empty();
    PartMessages discarded(sink);
    const Camera made_up =
        has_camera ? Camera() : make_default_camera(scene, static_cast<float>(kWidth) / kHeight, discarded);
    const auto shares_of = [&](const Scene& now) {
        return visible_shares(has_camera ? now.cameras.front() : made_up, now, sink);
    };
    if (scene.animations.empty()) return shares_of(scene);
    PosedScene posed(scene);
    posed.set_time(0);
    return shares_of(posed.scene());
}

bool is_light_too_weak(const Scene& scene, Sink& sink) {
    const SeenShares seen = shares_seen(scene, sink);
    return seen.lit < kShareToSeeBy || seen.burnt > kMaxBurnt;
}

bool lights_nothing_seen(const Scene& scene, Sink& sink) { return shares_seen(scene, sink).lit < kNextToNothing; }

} // namespace pertev
