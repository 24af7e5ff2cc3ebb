#include "apps/viewer/session_frames.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "apps/viewer/layer_colors.h"
#include "apps/viewer/reference_is_better.h"
#include "base/error.h"
#include "base/limits.h"
#include "base/stopwatch.h"
#include "device_scene/ray_queue.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "scene/scene_origin.h"

namespace pertev {
namespace {

constexpr uint32_t kFramesOfLayer = 32;         // at rest, after which a layer of the reconstruction does not
                                                // change
constexpr uint32_t kSamplesWorthAFrame = 16;    // samples of a picture at rest from which on a frame of its size
                                                // comes first
constexpr double kPass = 0.03;                  // seconds between checks whether a render is still needed
constexpr double kMinRate = 30, kMaxRate = 240; // limits of the screen rates that a GPU's frames match, per second

/// Stops when another thread sets the flag; null: never.
struct FlagSink final : Sink {
    explicit FlagSink(const std::atomic<bool>* stops) : flag(stops) {}
    bool should_stop() override { return flag != nullptr && *flag; }
    const std::atomic<bool>* flag;
};

bool is_beauty(ShownLayer layer) { return layer == ShownLayer::Beauty; }

/// Returns the samples of the finished film; one suffices for every layer except the picture.
uint32_t wanted_samples(const FrameRequest& request) {
    return is_beauty(request.view.layer) ? request.view.options.render.samples : 1;
}

/// Returns whether a moving frame belongs to the session's sequence (Session::render_frame), as all do that show more
/// than raw samples.
bool is_of_sequence(const ViewState& view) {
    const ReconstructionOptions& frames = view.options.reconstruction;
    return makes_frames(view.options.render.integrator) && (!frames.none || frames.has_frame_options());
}

bool same_metering(const RenderSettings& a, const RenderSettings& b) {
    return same_light(a, b) && a.width == b.width && a.height == b.height && a.transparent == b.transparent;
}

/// Returns whether a picture displayed `as` this has the requested tones and exposure. `exposed` has the current stops.
bool is_shown_as(const Display& as, const FrameRequest& request, const ShownFrame& exposed) {
    return as.tone_map == request.view.display.tone_map && as.exposure_stops == exposed.exposure_stops;
}

/// Returns the displayed picture. `picture` is a Session, or its Reconstruction.
template <class Picture>
Rgba8Image shown_picture(Picture& picture, ToneMap tone_map, float exposure_stops) {
    picture.display(tone_map, exposure_stops);
    return picture.displayed();
}

/// Records that the picture is shown at `scale` times its size.
void set_size(const FrameRequest& request, float scale, ShownFrame& frame) {
    frame.full_width = request.view.options.render.width;
    frame.full_height = request.view.options.render.height;
    frame.scale = scale;
}

/// Records that rendering took `seconds`.
void set_render_times(double seconds, ShownFrame& frame) {
    const SceneTracer::Seconds& rays = frame.kind_seconds;
    if (rays.total() <= 0) return void(frame.stages.emplace_back("render", 1e3 * seconds));
    frame.stages.emplace_back("camera rays", 1e3 * rays.camera);
    frame.stages.emplace_back("bounce rays", 1e3 * rays.bounce);
    frame.stages.emplace_back("shadow rays", 1e3 * rays.shadow);
    frame.stages.emplace_back("shading", 1e3 * std::max(seconds - rays.total(), 0.0));
}

} // namespace

bool SessionFrames::Seen::is_of(const FrameRequest& request, uint64_t changes) const {
    const RenderSettings& requested = request.view.options.render;
    return scale > 0 && camera == request.camera && layer == request.view.layer && scene_changes == changes &&
           same_light(picture, requested) && picture.width == requested.width && picture.height == requested.height;
}

SessionFrames::SessionFrames(Session& session, MovingScene& scene, double frame_s, double soon_s)
    : session_(session), scene_(scene), pace_(frame_s), growth_(soon_s) {}

void SessionFrames::set_time(double time_s) {
    if (scene_.time_s() == time_s && !is_behind_) return;
    const Stopwatch watch;
    const bool was_behind = std::exchange(is_behind_, true);
    const uint32_t parts = scene_.set_time(time_s, nobody()); // messages were shown at the start
    if (was_behind) {
        shows_reconstruction_ = false; // its frames are discarded
        session_.set_scene(scene_.prepared());
    } else if (parts != 0) {
        session_.update_scene(scene_.prepared(), parts);
    }
    is_behind_ = false;
    scene_changes_ += was_behind || parts != 0;
    update_s_ += watch.seconds();
}

RenderSettings SessionFrames::settings_for(const FrameRequest& request, float scale) {
    RenderSettings settings = request.view.options.render;
    settings.time_limit_s = 0;
    settings.width = scaled_side(settings.width, scale);
    settings.height = scaled_side(settings.height, scale);
    settings.aovs |= aovs_of(request.view.layer);
    // Layers and heat maps need no light.
    if (!is_beauty(request.view.layer) && !is_of_frames(request.view.layer)) settings.path.max_depth = 0;
    if (settings.time_kinds) settings.body = PathBody::Wavefront; // a loop over paths cannot time kinds of rays
    settings.pass_samples = 1;
    if (sample_s_ > 0 && scale == 1)
        settings.pass_samples = static_cast<uint32_t>(std::clamp(kPass / sample_s_, 1.0, 4096.0));
    return settings;
}

/// Settings of a moving picture that belongs to no sequence.
RenderSettings SessionFrames::small_settings_for(const FrameRequest& request, float scale) {
    RenderSettings settings = settings_for(request, scale);
    if (settings.frame_depth) settings.path.max_depth = std::min(settings.path.max_depth, *settings.frame_depth);
    return settings;
}

/// Scale of moving pictures: the requested one, or one that keeps up with the screen; a CPU cannot.
float SessionFrames::scale_for(const FrameRequest& request) {
    const ViewState& view = request.view;
    if (view.on_cuda && view.screen_rate > 0) {
        pace_.keep(1 / std::clamp(static_cast<double>(view.screen_rate), kMinRate, kMaxRate));
    }
    return view.moving_scale > 0 ? view.moving_scale : pace_.scale();
}

/// If the device has no room for new tracers, the previous ones are kept.
void SessionFrames::use(const RenderSettings& settings) {
    const RenderSettings before = session_.settings();
    try {
        session_.set_settings(settings);
        // The picture does not change, but restarts to show its rays at work.
        if (settings.tracers != before.tracers) session_.cut();
    } catch (const Error&) {
        RenderSettings as_before = settings;
        as_before.tracers = before.tracers;
        session_.set_settings(as_before);
        throw;
    }
}

Rgba8Image SessionFrames::show(const FrameRequest& request, ShownFrame& frame) {
    const uint32_t width = session_.settings().width, height = session_.settings().height;
    switch (request.view.layer) {
    case ShownLayer::Beauty:
        return shown_picture(session_, request.view.display.tone_map, frame.exposure_stops);
    case ShownLayer::Albedo:
        return show_albedo(session_.layers().front().image);
    case ShownLayer::Normal:
        frame.caption = "x, y, z of the normal as red, green, blue";
        return show_normal(session_.layers().front().image);
    case ShownLayer::Depth:
        frame.caption = "near is bright";
        return show_depth(session_.layers().front().image);
    case ShownLayer::Instances:
        return show_ids(session_.film().ids(), width, height, IdKind::Instance);
    case ShownLayer::Triangles:
        return show_ids(session_.film().ids(), width, height, IdKind::Primitive);
    case ShownLayer::Materials:
        return show_ids(session_.film().ids(), width, height, IdKind::Material);
    case ShownLayer::NodeHeat:
    case ShownLayer::TriangleHeat:
    case ShownLayer::Motion:
    case ShownLayer::Deviation:
        break;
    }
    const bool nodes = request.view.layer == ShownLayer::NodeHeat;
    const std::vector<RayWork> work = session_.count_camera_work();
    if (work.empty()) {
        frame.caption = "this traversal traces rays together and cannot count the tests of a single one";
        return shown_picture(session_, request.view.display.tone_map, frame.exposure_stops);
    }
    uint32_t most = 0;
    Rgba8Image image = show_work(work, width, height, nodes ? WorkKind::Nodes : WorkKind::Triangles, most);
    frame.caption = std::string("black: none; pale yellow: ") + std::to_string(most) +
                    (nodes ? " nodes per camera ray" : " triangles per camera ray");
    return image;
}

/// Colours of the layer of the last reconstructed frame.
Rgba8Image SessionFrames::show_layer(const FrameRequest& request, ShownFrame& frame) {
    float most = 0;
    if (request.view.layer == ShownLayer::Motion) {
        Rgba8Image image = show_motion(session_.frame().motion(), most);
        frame.caption =
            fmt::format("grey: no motion; right is red, down is green; saturated at {:.3g} pixels per frame", most);
        return image;
    }
    Rgba8Image image = show_deviation(session_.frame().deviation(), most);
    frame.caption = fmt::format("standard deviation: black is 0; pale yellow is {:.3g}, or unknown", most);
    return image;
}

/// Sets the stops with which the current picture is shown.
void SessionFrames::expose(const FrameRequest& request, ShownFrame& frame) {
    frame.found_stops = exposure_.stops();
    frame.exposure_stops = request.view.display.exposure_stops;
    if (request.view.finds_exposure) frame.exposure_stops += frame.found_stops;
}

/// A picture at rest has the exposure that pertev render meters for it. A small one, whose size depends on the
/// machine's speed, keeps that of another size.
void SessionFrames::meter_still(const FrameRequest& request, bool is_small) {
    if (!request.view.finds_exposure) return;
    const Metered& last = metered_;
    const RenderSettings& now = session_.settings();
    const bool is_alike = is_small ? same_light(last.picture, now) : same_metering(last.picture, now);
    if (last.is_there && is_alike && last.camera == request.camera && last.tone_map == request.view.display.tone_map &&
        last.scene_changes == scene_changes_) {
        return;
    }
    begin_exposed(request, session_.meter(request.view.display.tone_map));
}

/// Returns whether the film has samples of exactly this picture at rest.
bool SessionFrames::film_goes_on(const FrameRequest& request) {
    return session_.history().samples > 0 && session_.camera() == request.camera &&
           same_picture(session_.settings(), settings_for(request, 1));
}

/// Scale of the picture before the samples at rest; nothing if these may accumulate.
std::optional<float> SessionFrames::growth_scale(const FrameRequest& request) {
    if (film_goes_on(request)) return std::nullopt;
    if (!grown_.is_of(request, scene_changes_)) {
        growth_.begin(seen_.is_of(request, scene_changes_) ? seen_.scale : 0, pace_.full_s());
        grown_ = {request.view.options.render, request.camera, request.view.layer, scene_changes_, 1};
    }
    // A frame of full size costs as much as a sample, which the film does not get: with many samples it pays.
    const bool has_whole = request.view.options.render.samples >= kSamplesWorthAFrame &&
                           !request.view.options.reconstruction.none && is_beauty(request.view.layer) &&
                           is_of_sequence(request.view);
    return growth_.next(has_whole);
}

void SessionFrames::begin_exposed(const FrameRequest& request, float stops) {
    metered_ = {session_.settings(), request.camera, request.view.display.tone_map, scene_changes_, true};
    exposure_.set(stops);
}

/// Renders and reconstructs a frame. `is_growing`: the camera rests and no sample exists yet. All scatterings count,
/// and the frame stops if no client waits for it.
std::optional<ShownFrame> SessionFrames::reconstruct(const FrameRequest& request, float scale, bool is_growing) {
    const Stopwatch whole;
    const double update_s = std::exchange(update_s_, 0);
    const bool goes_on = std::exchange(shows_reconstruction_, false);
    const uint32_t width_before = session_.settings().width;
    const std::optional<uint32_t> depth_before = session_.settings().frame_depth;
    RenderSettings picture = settings_for(request, scale);
    if (is_growing) picture.frame_depth = picture.path.max_depth;
    use(picture);
    const bool shows_layer = is_of_frames(request.view.layer);
    const RestirSettings& restir = request.view.options.reconstruction.sharing;
    ReconstructionSettings settings = request.view.options.reconstruction.used();
    settings.keep_layers = shows_layer;
    const bool is_alike = settings == reconstruction_settings_ && restir == restir_settings_;
    const bool is_still = session_.camera() == request.camera && goes_on && update_s == 0 &&
                          session_.settings().width == width_before &&
                          session_.settings().frame_depth == depth_before && is_alike;
    reconstruction_settings_ = settings;
    restir_settings_ = restir;
    still_frames_ = is_still ? still_frames_ + 1 : 1;
    session_.set_camera(request.camera);
    const Stopwatch render;
    FlagSink sink(is_growing ? &hurry_ : nullptr);
    if (!session_.render_frame(next_sample_, settings, restir, sink)) return std::nullopt;
    next_sample_ = (next_sample_ + 1) % kMaxSamplesPerPixel;
    shows_reconstruction_ = true;
    reconstructed_as_ = session_.settings();
    shows_film_ = false;
    shows_layer_ = shows_layer;
    reconstruction_.pixels.clear();
    ShownFrame frame;
    frame.rays = session_.frames().rays();
    frame.kind_seconds = session_.frames().kind_seconds();
    const double reconstruction_s = session_.frame().seconds(), sharing_s = session_.frames().sharing_seconds();
    frame.render_s = std::max(render.seconds() - reconstruction_s, 0.0);
    const Stopwatch display;
    if (is_growing) { // smaller ones keep the exposure, because metering takes longer than they do
        if (scale == 1 && !shows_layer) meter_still(request, false);
    } else if (request.view.finds_exposure && !shows_layer) {
        exposure_.next(session_.frames().tones(), request.view.display.tone_map);
        metered_.is_there = false;
    }
    expose(request, frame);
    frame.image = shows_layer ? show_layer(request, frame)
                              : shown_picture(session_.frame(), request.view.display.tone_map, frame.exposure_stops);
    if (update_s > 0) frame.stages.emplace_back("scene", 1e3 * update_s);
    set_render_times(std::max(frame.render_s - sharing_s, 0.0), frame);
    if (sharing_s > 0) frame.stages.emplace_back("ReSTIR", 1e3 * sharing_s);
    frame.stages.emplace_back("reconstruction", 1e3 * reconstruction_s);
    frame.stages.emplace_back("tone map", 1e3 * display.seconds());
    set_size(request, scale, frame);
    frame.samples = still_frames_;
    frame.is_final = shows_layer && !request.is_moving && still_frames_ >= kFramesOfLayer;
    if (is_growing) {
        growth_.took(scale, whole.seconds());
        return frame;
    }
    pace_.took(scale, whole.seconds(), update_s);
    report_pace(request, frame);
    return frame;
}

/// Shows the reconstruction again with another display, if samples have not replaced it yet.
std::optional<ShownFrame> SessionFrames::show_reconstruction_again(const FrameRequest& request) {
    ShownFrame frame;
    expose(request, frame);
    if (is_shown_as(shown_as_, request, frame)) return std::nullopt;
    reconstruction_ = tone_map_image(reconstruction_light_, request.view.display.tone_map, frame.exposure_stops);
    half_samples_ = 0;
    frame.image = reconstruction_;
    const float full_width = static_cast<float>(request.view.options.render.width);
    set_size(request, static_cast<float>(reconstruction_.width) / full_width, frame);
    frame.samples = still_frames_;
    return frame;
}

void SessionFrames::report_pace(const FrameRequest& request, ShownFrame& frame) const {
    if (request.view.moving_scale > 0) return;
    frame.kept_rate = 1 / pace_.frame_s();
    frame.keeps_rate = pace_.keeps_rate();
}

const std::string& SessionFrames::film_hash() {
    const History& now = session_.history();
    const bool is_known = !hashed_.hash.empty() && hashed_.cuts == now.cuts && hashed_.samples == now.samples &&
                          hashed_.scene_changes == scene_changes_ && hashed_.camera == session_.camera();
    if (!is_known) {
        hashed_ = {picture_hash(session_.picture()).hex(), session_.camera(), now.cuts, scene_changes_, now.samples};
    }
    return hashed_.hash;
}

/// Returns whether the picture at rest should replace the reconstruction. Tested only at powers of two, each of which
/// has the previous one as its half.
bool SessionFrames::beats_reconstruction(const FrameRequest& request) {
    const uint32_t samples = session_.history().samples;
    if (!std::has_single_bit(samples)) return false;
    ShownFrame frame; // with the display of the reconstruction
    expose(request, frame);
    Rgba8Image whole = shown_picture(session_, request.view.display.tone_map, frame.exposure_stops);
    const bool is_better =
        half_samples_ > 0 && 2 * half_samples_ == samples && reference_is_better(whole, half_, reconstruction_);
    half_ = std::move(whole);
    half_samples_ = samples;
    return is_better;
}

std::optional<ShownFrame> SessionFrames::next(const FrameRequest& request) {
    std::optional<ShownFrame> frame = make_next(request);
    if (!frame) return frame;
    shown_as_ = {request.view.display.tone_map, frame->exposure_stops, {}};
    if (frame->is_reference) {
        seen_.scale = 0;
    } else {
        seen_ = {request.view.options.render, request.camera, request.view.layer, scene_changes_, frame->scale};
    }
    return frame;
}

std::optional<ShownFrame> SessionFrames::make_next(const FrameRequest& request) {
    const Stopwatch whole;
    const bool is_of_movement = request.is_moving || request.view.is_real_time;
    const std::optional<float> grows_to = is_of_movement ? std::nullopt : growth_scale(request);
    const float scale = grows_to ? *grows_to : is_of_movement ? scale_for(request) : 1;
    const FilmSize size = {scale, is_of_movement, grows_to.has_value()};
    if (is_of_frames(request.view.layer) ||
        (size.is_small() && is_beauty(request.view.layer) && is_of_sequence(request.view))) {
        std::optional<ShownFrame> frame = reconstruct(request, size.scale, size.is_growing);
        if (frame && size.is_growing) growth_.showed(size.scale);
        return frame;
    }
    const double update_s = std::exchange(update_s_, 0);
    const bool competes = prepare_competition(request, size);
    if (competes) {
        if (std::optional<ShownFrame> again = show_reconstruction_again(request)) return again;
    }
    use(is_of_movement ? small_settings_for(request, size.scale) : settings_for(request, size.scale));
    session_.set_camera(request.camera);
    const bool was_begun = session_.history().samples > 0;
    ShownFrame frame;
    if (!add_samples(request, size, competes, frame)) return std::nullopt;
    shows_reconstruction_ = false;
    // A moving frame outside a sequence keeps the previous exposure.
    if (!request.is_moving && !size.is_growing && is_beauty(request.view.layer)) meter_still(request, size.is_small());
    show_film(request, size, frame);
    if (size.is_growing) {
        growth_.took(size.scale, whole.seconds());
        growth_.showed(size.scale);
    }
    if (is_of_movement && !was_begun) pace_.took(size.scale, whole.seconds(), update_s);
    if (is_of_movement) report_pace(request, frame);
    return frame;
}

/// Decides whether the reconstruction stays until the film is better. If so, it is kept as displayed, else forgotten.
bool SessionFrames::prepare_competition(const FrameRequest& request, const FilmSize& size) {
    const bool competes = shows_reconstruction_ && !shows_layer_ && !size.is_small() && is_beauty(request.view.layer) &&
                          !request.view.options.reconstruction.none &&
                          same_light(reconstructed_as_, settings_for(request, size.scale));
    if (!competes) shows_reconstruction_ = false;     // another size discards it
    if (competes && reconstruction_.pixels.empty()) { // before another size discards it
        ShownFrame frame;
        expose(request, frame);
        reconstruction_ = shown_picture(session_.frame(), request.view.display.tone_map, frame.exposure_stops);
        reconstruction_light_ = session_.frame().picture();
    }
    return competes;
}

/// Adds samples to the film until it is time to show it. Returns false if there is nothing new to show. A moving
/// picture is always finished, because input comes faster than pictures and would stop each. At rest no whole sample
/// is lost, because a request for another picture may end with the same one. A short sample is waited for, and a long
/// one uses a film of its own, except for the first sample.
bool SessionFrames::add_samples(const FrameRequest& request, const FilmSize& size, bool competes, ShownFrame& frame) {
    const uint32_t wanted = wanted_samples(request), before = session_.history().samples;
    const bool was_begun = before > 0;
    if (!was_begun) half_samples_ = 0;
    const uint32_t until = competes ? std::min(wanted, std::bit_floor(before) * 2 + !was_begun) : wanted;
    const bool is_slow = growth_.is_slow(), is_short = was_begun && growth_.is_short(sample_s_);
    const std::atomic<bool>& stops = is_slow ? hurry_ : abandon_;
    FlagSink flag(size.is_of_movement ? nullptr : &stops);
    session_.interrupt_passes(!is_short);
    const RayCounts rays_before = session_.rays();
    const Stopwatch render;
    uint32_t added = 0;
    ShownFrame exposed;
    expose(request, exposed);
    // After a change of tones the existing samples are shown first.
    const bool waits =
        was_begun && !size.is_small() && is_slow && shows_film_ && !is_shown_as(shown_as_, request, exposed);
    if (before < wanted && !waits) {
        ProgressSink sink(
            [&](const Progress& now) {
                if (now.made_share < 1 && request.on_progress) request.on_progress(now.made_share);
                const bool has_begun = now.samples_done > before; // a picture has at least one sample, however long
                                                                  // it takes
                return !has_begun || now.seconds < request.budget_s;
            },
            flag);
        added = session_.render(size.is_small() ? 1 : until - before, sink);
        frame.rays = session_.rays() - rays_before;
    }
    frame.render_s = render.seconds();
    if (added > 0 && session_.settings().time_kinds) frame.kind_seconds = session_.stats().kind_seconds;
    if (added > 0 && !size.is_small()) {
        sample_s_ = frame.render_s / added;
        growth_.took(1, sample_s_);
    }
    if (stops && !size.is_of_movement && added == 0 && !waits) return false;
    frame.samples = session_.history().samples;
    return frame.samples > 0 && !(competes && frame.samples < wanted && !beats_reconstruction(request));
}

/// Displays the film, or the requested layer of it.
void SessionFrames::show_film(const FrameRequest& request, const FilmSize& size, ShownFrame& frame) {
    expose(request, frame);
    const Stopwatch display;
    frame.image = show(request, frame);
    const double display_s = display.seconds();
    set_size(request, size.scale, frame);
    shows_film_ = frame.is_reference = !size.is_small() && is_beauty(request.view.layer);
    frame.is_final = !size.is_small() && frame.samples >= wanted_samples(request);
    set_render_times(frame.render_s, frame);
    frame.stages.emplace_back("tone map", 1e3 * display_s);
    if (!frame.is_reference) return;
    const Stopwatch hash;
    frame.hash = film_hash();
    frame.stages.emplace_back("hash", 1e3 * hash.seconds());
}

float SessionFrames::meter(const FrameRequest& request) {
    session_.set_camera(request.camera);
    return session_.meter(request.view.display.tone_map);
}

} // namespace pertev
