#include "apps/viewer/render_loop.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "apps/viewer/file_name.h"
#include "apps/viewer/panel_phrases.h"
#include "apps/viewer/panel_text.h"
#include "base/error.h"
#include "scene/scene_origin.h"
#include "session/pictures/prepare_render.h"
#include "session/writing/write_picture.h"
#include "settings/check_settings.h"
#include "settings/picture_flags.h"

namespace pertev {
namespace {

constexpr double kStillAfter = 0.15; // seconds without a step after which the camera is at rest
constexpr double kReportEvery = 0.2; // seconds between two states, while nothing else is new
constexpr double kFirstBudget = 0.1, kLongestBudget = 1;
constexpr float kSpeedStep = 1.25f;
constexpr double kSlowestTime = 1.0 / 64; // seconds of the scene per second
constexpr double kLongestStep = 0.5;      // seconds; time stops while no client is connected

} // namespace

RenderLoop::RenderLoop(const ViewerStart& start, FrameSource& source, Inbox& inbox, Audience& audience,
                       const Packer& packer, std::function<double()> now_s)
    : start_(start), source_(source), inbox_(inbox), audience_(audience), packer_(packer), now_s_(std::move(now_s)),
      view_(start.view), shown_(start.view), camera_(start.camera, *start.scene), clock_(start.clock),
      shown_s_(start.clock.time_s), speed_(start.speed) {}

/// Returns whether the picture depends on the time.
bool RenderLoop::time_matters() const { return clock_.end_s > 0 && (start_.is_animated || camera_.moves_with_time()); }

bool RenderLoop::time_runs() const { return clock_.plays && time_matters() && saves_.empty(); }

bool RenderLoop::is_moving() const { return now_s_() - moved_at_s_ < kStillAfter || time_runs(); }

FrameRequest RenderLoop::request() const {
    FrameRequest request;
    request.camera = camera_.camera(view_.lens);
    request.view = view_;
    // The first picture is small, because a sample of a large one may take long.
    request.is_moving = (is_moving() || !last_) && saves_.empty();
    if (!saves_.empty()) request.view.is_real_time = false;
    request.budget_s = budget_s_;
    return request;
}

void RenderLoop::run(const std::function<bool()>& goes_on) {
    while (goes_on()) {
        const bool rests = is_done_ && saves_.empty();
        const bool works = (audience_.is_anyone_there() && !rests) || !saves_.empty();
        for (const Command& command : inbox_.take(std::chrono::milliseconds(works ? 0 : 50))) handle(command);
        if (!goes_on()) return;
        if (is_done_ && saves_.empty()) {
            if (now_s_() - reported_at_s_ > 1) report_state(); // the encoding time is known by now
            continue;
        }
        if (!audience_.is_anyone_there() && saves_.empty()) continue;
        // Not faster than it can be shown, because a delayed picture is outdated.
        if (audience_.is_behind(now_s_()) && is_moving()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            continue;
        }
        show_next();
        save_pictures();
    }
}

void RenderLoop::handle(const Command& command) {
    is_new_ = true;
    if (const Steer* requested = std::get_if<Steer>(&command)) {
        try {
            steer(*requested);
        } catch (const Error& error) { // from a pick, or from the light meter
            if (error.code() == ErrorCode::DeviceFault) throw;
            report_error(requested->client, error);
        }
        return inbox_.expect(view_);
    }
    if (const Save* save = std::get_if<Save>(&command)) return saves_.push_back(*save);
    is_done_ = false; // a client has connected, so the current picture is sent again
    if (!last_)
        moved_at_s_ = now_s_(); // a small picture comes first, because a sample of a large picture may take long
}

void RenderLoop::steer(const Steer& requested) {
    const ClientMessage& message = requested.message;
    if (message.input != 0) {
        input_ = message.input;
        steerer_ = requested.client;
    }
    if (message.kind == MessageKind::Rate) {
        view_.screen_rate = shown_.screen_rate = message.hertz;
        return;
    }
    if (message.kind == MessageKind::Shape) return reshape(message);
    is_done_ = is_done_ && message.kind == MessageKind::Pick; // a pick changes nothing
    switch (message.kind) {
    case MessageKind::Move:
    case MessageKind::Orbit:
    case MessageKind::Look:
    case MessageKind::Pan:
    case MessageKind::Zoom:
        camera_.step(message, view_.lens, speed_);
        moved_at_s_ = now_s_();
        break;
    case MessageKind::Speed:
        speed_ *= pow(kSpeedStep, message.steps);
        speed_ = clamp(speed_, 1e-6f * start_.speed, 1e6f * start_.speed);
        audience_.notify(requested.client, notice_text("note", fmt::format("speed {:.3g} m/s", speed_)));
        break;
    case MessageKind::Pick:
        return pick(requested);
    case MessageKind::Home:
        camera_.return_to_start(clock_.time_s, view_.lens);
        break;
    case MessageKind::Camera:
        camera_.use_scene_camera(message.index, clock_.time_s, view_.lens);
        break;
    case MessageKind::Play:
    case MessageKind::Time:
        steer_time(message);
        break;
    case MessageKind::Key:
    case MessageKind::Unkey:
    case MessageKind::Follow:
        steer_path(requested);
        break;
    case MessageKind::Set:
        return set(requested);
    case MessageKind::Meter:
        view_.display.exposure_stops = view_.finds_exposure ? 0 : source_.meter(request());
        break;
    case MessageKind::Rate: // handled above
    case MessageKind::Shape:
    case MessageKind::Hello:
    case MessageKind::Ack:
    case MessageKind::RequestControl:
    case MessageKind::Hand:
        break; // handled by the audience
    }
    budget_s_ = kFirstBudget;
}

/// Fits the picture to the window of a client.
void RenderLoop::reshape(const ClientMessage& message) {
    if (!resize_to_window(view_, message.width, message.height)) return;
    resize_to_window(shown_, message.width, message.height);
    camera_.fit(aspect_of(view_.options.render.width, view_.options.render.height), view_.lens);
    shown_.lens = view_.lens;
    is_done_ = false;
    budget_s_ = kFirstBudget;
}

void RenderLoop::steer_time(const ClientMessage& message) {
    if (message.kind == MessageKind::Time) {
        clock_.seek(static_cast<double>(message.at));
        moved_at_s_ = now_s_();
    } else {
        clock_.speed = std::max(static_cast<double>(message.speed), kSlowestTime);
        clock_.loops = message.loops;
        clock_.play(message.on);
    }
    clocked_at_s_ = now_s_();
    report_state();
}

void RenderLoop::steer_path(const Steer& requested) {
    const ClientMessage& message = requested.message;
    if (message.kind == MessageKind::Key) {
        if (!camera_.add_key(message.at, view_.lens)) {
            audience_.notify(requested.client,
                             notice_text("error", fmt::format("a path has {} keys at most", ViewCamera::kMaxKeys)));
        }
    } else if (message.kind == MessageKind::Unkey) {
        camera_.remove_key(message.index);
    }
    followed_s_.reset(); // the changed path may lead elsewhere
    const std::vector<CameraKey>& keys = camera_.path().keys;
    clock_.end_s = std::max(start_.clock.end_s, keys.empty() ? 0 : keys.back().time_s);
    if (message.kind == MessageKind::Follow && !keys.empty()) {
        clock_.time_s = 0;
        clock_.plays = true;
        clocked_at_s_ = moved_at_s_ = now_s_();
        camera_.follow_path(clock_.time_s, view_.lens);
    }
    report_state();
}

/// Advances time since the last call, if it runs.
void RenderLoop::advance_time() {
    const double now = now_s_(), passed = now - std::exchange(clocked_at_s_, now);
    if (time_runs()) clock_.advance(std::min(passed, kLongestStep));
}

/// Informs a client of an error. `client` is the one that made the request; 0: all are informed.
void RenderLoop::report_error(uint32_t client, const Error& error) {
    audience_.notify(client,
                     notice_text("error", without_folders(panel_phrase(error.remark()), start_.record.scene.scene)));
}

/// Moves scene and camera to the clock's time, if it affects them. Throws as FrameSource::set_time.
void RenderLoop::follow_time() {
    if (!clock_.time_s || clock_.time_s == followed_s_) return;
    followed_s_.reset();
    if (start_.is_animated) source_.set_time(*clock_.time_s);
    camera_.seek(clock_.time_s, view_.lens);
    followed_s_ = clock_.time_s;
}

void RenderLoop::pick(const Steer& requested) {
    const ClientMessage& message = requested.message;
    const Camera now = camera_.camera(view_.lens);
    const std::optional<PickedPoint> point = source_.pick(now, message.x, message.y);
    if (message.use == PickUse::Show) {
        return audience_.notify(requested.client,
                                picked_text(*start_.scene, point ? &*point : nullptr, message.x, message.y));
    }
    if (!point) return audience_.notify(requested.client, notice_text("note", "the pixel shows only background"));
    if (message.use == PickUse::Orbit) {
        camera_.turn_about(point->position);
        return audience_.notify(requested.client, notice_text("note", "this point is the orbit centre"));
    }
    const Transform& from = now.world_from_camera;
    view_.lens.focus_distance = max(-dot(point->position - from.translation, column(from, 2)), 1e-6f);
    budget_s_ = kFirstBudget;
    is_done_ = false;
    const bool has_lens = view_.lens.aperture_radius > 0;
    audience_.notify(requested.client,
                     notice_text("note", fmt::format("in focus: {:.4g} m{}", view_.lens.focus_distance,
                                                     has_lens ? "" : " (the lens has no radius, so all is sharp)")));
}

void RenderLoop::set(const Steer& requested) {
    const std::string why_not = set_view_setting(view_, requested.message.name, requested.message.value);
    if (!why_not.empty()) audience_.notify(requested.client, notice_text("error", why_not));
    budget_s_ = kFirstBudget;
    report_state();
}

/// If something cannot be provided, all clients are informed, and the view returns to the last one that worked.
std::optional<ShownFrame> RenderLoop::next_frame(const FrameRequest& wanted) {
    try {
        return source_.next(wanted);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::DeviceFault) throw;
        report_error(0, error);
        made_share_ = 1;
        is_done_ = error.code() == ErrorCode::OverLimit; // the view itself exceeds a limit, until it changes
        const ViewState failed = std::exchange(view_, shown_);
        view_.display = failed.display;
        // A setting changed at rest takes effect with the next moving frame.
        RestirSettings& restir = view_.options.reconstruction.sharing;
        if (failed.options.reconstruction.sharing == restir) restir.light = RestirLight::Off;
        inbox_.expect(view_);
        report_state();
        return std::nullopt;
    }
}

void RenderLoop::show_next() {
    advance_time();
    try {
        follow_time();
    } catch (const Error& error) {
        if (error.code() == ErrorCode::DeviceFault) throw;
        report_error(0, error);
        const double back_s = shown_s_.value_or(0);
        is_done_ = clock_.time_s == back_s; // only another time can help
        clock_.plays = false;
        clock_.time_s = back_s;
        return report_state();
    }
    FrameRequest wanted = request();
    wanted.on_progress = [this](double share) {
        made_share_ = share;
        if (now_s_() - reported_at_s_ > kReportEvery) report_state();
    };
    if (wanted.is_moving && !is_new_ && !time_runs() && last_ &&
        last_->samples >= view_.options.render.samples) { // nothing new to show
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return;
    }
    std::optional<ShownFrame> frame = next_frame(wanted);
    made_share_ = 1;
    if (!frame) { // samples accumulate in a picture that is not shown yet
        if (now_s_() - reported_at_s_ > kReportEvery) report_state();
        return;
    }
    is_new_ = false;
    shown_ = view_;
    shown_s_ = clock_.time_s;
    view_.found_stops = frame->found_stops;
    const double now = now_s_();
    const double since = now - std::exchange(framed_at_s_, now);
    frames_per_second_ = since > 1 ? 0 : frames_per_second_ + 0.3 * (1 / std::max(since, 1e-4) - frames_per_second_);
    budget_s_ = wanted.is_moving ? kFirstBudget : std::min(1.5 * budget_s_, kLongestBudget);
    // A small picture has all its samples, so nothing is left to do unless it grows.
    const bool rests_small =
        !wanted.is_moving && wanted.view.is_real_time && frame->samples >= view_.options.render.samples;
    is_done_ = (frame->is_final || rests_small) && !is_moving();
    last_ = *frame;
    last_->image.pixels.clear();
    audience_.publish(*std::move(frame), input_);
    if (is_done_ || now - reported_at_s_ > kReportEvery) report_state();
}

/// The options by which `pertev render` makes the picture of `record`: those of the start, as the panel, the camera and
/// the clock have changed them.
PictureOptions RenderLoop::options_for(const PictureRecord& record) const {
    const PictureOptions& start = start_.options;
    PictureOptions options = view_.options;
    options.given = start.given;
    options.tone_map = view_.display.tone_map;
    options.exposure = fmt::format("{}", record.display->exposure_stops);
    options.time_s = record.scene.time_s;
    if (!record.scene.ground.empty()) options.scene.ground = record.scene.ground; // an eye alone removes it
    options.scene.environment = file_name(options.scene.environment);
    options.radiosity.solution = file_name(options.radiosity.solution);
    options.scene.camera = choice_of(record.camera);
    if (camera_.is_of_scene()) {
        for (auto* place : {&options.scene.camera.eye, &options.scene.camera.target}) place->reset();
        options.scene.camera.up.reset();
    }
    for (const Setting& setting : all_settings()) {
        const std::vector<std::string> texts = texts_of(options, setting);
        if (texts == texts_of(start, setting)) continue;
        options.given[setting.name] = SettingOrigin::Caller;
        if (texts.empty() || texts.front().empty()) options.given.erase(setting.name);
    }
    for (const char* name : {"camera_path", "turntable", "f_number", "shutter_time", "iso"}) options.given.erase(name);
    while (const auto conflict = find_conflict(options, kRender)) options.given.erase(conflict->setting->name);
    return options;
}

/// Record of how the current picture is made.
PictureRecord RenderLoop::record() const {
    PictureRecord record = start_.record;
    // The location of files is private to the machine.
    for (std::vector<std::string>* list : {&record.scene.made_up, &record.scene.left_out}) {
        for (std::string& text : *list) text = without_folders(std::move(text), record.scene.scene);
    }
    if (start_.is_animated) record.scene.time_s = clock_.time_s;
    record.settings = view_.options.render;
    record.display = view_.display;
    if (last_) record.display->exposure_stops = last_->exposure_stops;
    record.camera.camera = camera_.camera(view_.lens);
    record.camera.target.reset();
    record.camera.up.reset();
    if (camera_.is_given_by_pose()) {
        record.camera.target = in_file(*start_.scene, camera_.pose().target);
        record.camera.up = camera_.pose().up;
    }
    if (!camera_.is_at_start() || camera_.is_own()) record.camera.name = camera_.name();
    record.camera.fov_deg = degrees_for(view_.lens.fov_y);
    record_settings(options_for(record), *start_.scene, 0, record);
    record.scene.settings = without_folders(std::move(record.scene.settings), record.scene.scene);
    record.scene.scene = file_name(record.scene.scene);
    record.scene.environment = file_name(record.scene.environment);
    return record;
}

void RenderLoop::save_pictures() {
    if (saves_.empty() || !last_ || !last_->is_reference) {
        if (saves_.empty() || view_.layer == ShownLayer::Beauty) return;
        audience_.notify(0, notice_text("error", "a layer is shown; choose the picture to save it"));
        for (const Save& save : std::exchange(saves_, {})) save.reply({});
        return;
    }
    RenderResult result = source_.result();
    const PictureRecord made = record();
    for (const Save& save : std::exchange(saves_, {})) {
        RenderResult copy = result;
        save.reply(encode_picture(save.format == "exr" ? ImageFormat::Exr : ImageFormat::Png, made, copy));
    }
}

void RenderLoop::report_state() {
    reported_at_s_ = now_s_();
    ViewNumbers numbers;
    numbers.frame = last_ ? &*last_ : nullptr;
    numbers.made_share = made_share_;
    numbers.frames_per_second = is_done_ ? 0 : frames_per_second_;
    numbers.pack_ms = packer_.milliseconds();
    numbers.packed_bytes = packer_.bytes();
    numbers.encoder = packer_.encoder();
    numbers.phase = is_done_ ? "done" : (is_moving() ? "moving" : "gathering");
    numbers.flags = camera_.flags(view_.lens, start_.is_animated ? clock_.time_s : start_.still_s);
    if (view_.window_pixels > 0) {
        numbers.flags += fmt::format(" --size {}x{}", view_.options.render.width, view_.options.render.height);
    }
    if (!start_.record.scene.ground.empty()) numbers.flags += " --ground on"; // an --eye alone removes it
    if (last_) {
        PictureRecord made; // without the scene's names, which may be many
        made.scene.time_s = start_.is_animated ? clock_.time_s : start_.record.scene.time_s;
        made.scene.ground = start_.record.scene.ground;
        made.display = view_.display;
        made.display->exposure_stops = last_->exposure_stops;
        numbers.picture_flags =
            without_folders(picture_flags(options_for(made), numbers.flags), start_.record.scene.scene);
    }
    numbers.why_still = start_.why_still;
    numbers.input = input_;
    numbers.steerer = steerer_;
    numbers.clock = clock_;
    if (!time_matters()) numbers.clock.end_s = 0;
    numbers.path = &camera_.path();
    audience_.report_state(state_text(view_, numbers));
}

} // namespace pertev
