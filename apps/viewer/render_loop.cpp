#include "apps/viewer/render_loop.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "apps/viewer/panel_text.h"
#include "base/error.h"
#include "session/write_picture.h"

namespace pertev {
namespace {

constexpr double kStillAfter = 0.15; // seconds without a step, and the camera is at rest
constexpr double kTellEvery = 0.2;   // seconds between two states, while nothing else is new
constexpr double kFirstBudget = 0.1, kLongestBudget = 1;
constexpr float kSpeedStep = 1.25f;

} // namespace

RenderLoop::RenderLoop(const ViewerStart& start, FrameSource& source, Inbox& inbox, Audience& audience,
                       const Packer& packer, std::function<double()> now_s)
    : start_(start), source_(source), inbox_(inbox), audience_(audience), packer_(packer), now_s_(std::move(now_s)),
      view_(start.view), shown_(start.view), base_(start.camera), pose_(start.pose), camera_name_(start.camera_name),
      speed_(start.speed) {}

Camera RenderLoop::camera() const {
    Camera lens = base_;
    lens.fov_y = view_.lens.fov_y;
    lens.aperture_radius = view_.lens.aperture_radius;
    lens.focus_distance = view_.lens.focus_distance;
    return has_moved_ ? camera_at(pose_, lens) : lens;
}

bool RenderLoop::is_moving() const { return now_s_() - moved_at_s_ < kStillAfter; }

FrameRequest RenderLoop::request() const {
    FrameRequest request;
    request.camera = camera();
    request.view = view_;
    request.is_moving = is_moving() && saves_.empty();
    if (!saves_.empty()) request.view.is_real_time = false;
    request.budget_s = budget_s_;
    return request;
}

std::string RenderLoop::flags() const { return camera_flags(pose_, camera(), camera_name_); }

void RenderLoop::run(const std::function<bool()>& goes_on) {
    while (goes_on()) {
        const bool rests = is_done_ && saves_.empty();
        const bool works = (audience_.is_anyone_there() && !rests) || !saves_.empty();
        for (const Command& command : inbox_.take(std::chrono::milliseconds(works ? 0 : 50))) handle(command);
        if (!goes_on()) return;
        if (is_done_ && saves_.empty()) {
            if (now_s_() - told_at_s_ > 1) tell_state(); // how the picture was packed is known by now
            continue;
        }
        if (!audience_.is_anyone_there() && saves_.empty()) continue;
        // No faster than somebody can be shown it: what is shown late is old.
        if (audience_.is_behind() && is_moving()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            continue;
        }
        show_next();
        save_pictures();
    }
}

void RenderLoop::handle(const Command& command) {
    is_new_ = true;
    if (const Steer* asked = std::get_if<Steer>(&command)) return steer(*asked);
    if (const Save* save = std::get_if<Save>(&command)) return saves_.push_back(*save);
    is_done_ = false; // somebody came: shows the present picture again
}

void RenderLoop::steer(const Steer& asked) {
    const ClientMessage& message = asked.message;
    if (message.input != 0) input_ = message.input;
    is_done_ = is_done_ && message.kind == MessageKind::Pick; // to look at a place changes nothing
    switch (message.kind) {
    case MessageKind::Move:
    case MessageKind::Orbit:
    case MessageKind::Look:
    case MessageKind::Pan:
    case MessageKind::Zoom:
        step_camera(message);
        break;
    case MessageKind::Speed:
        speed_ *= pow(kSpeedStep, message.steps);
        speed_ = clamp(speed_, 1e-6f * start_.speed, 1e6f * start_.speed);
        audience_.tell(asked.client, notice_text("note", fmt::format("speed {:.3g} m/s", speed_)));
        break;
    case MessageKind::Pick:
        return pick(asked);
    case MessageKind::Home:
        base_ = start_.camera;
        pose_ = start_.pose;
        camera_name_ = start_.camera_name;
        view_.lens = start_.camera;
        has_moved_ = false;
        break;
    case MessageKind::Camera:
        if (message.index < start_.scene->cameras.size()) {
            base_ = start_.scene->cameras[message.index];
            pose_ = pose_of(base_, {}, {}, length(start_.pose.target - start_.pose.eye));
            camera_name_ = fmt::format("{}", message.index);
            view_.lens = base_;
            has_moved_ = false;
        }
        break;
    case MessageKind::Set:
        return set(asked);
    case MessageKind::Meter:
        view_.display.exposure_stops = source_.meter(request());
        break;
    case MessageKind::Hello:
    case MessageKind::Ack:
    case MessageKind::Ask:
    case MessageKind::Hand:
        break; // the audience's
    }
    budget_s_ = kFirstBudget;
}

void RenderLoop::step_camera(const ClientMessage& message) {
    const Pose before = pose_;
    const bool is_flat = base_.projection == Projection::Orthographic;
    const float height = is_flat ? base_.ortho_height : 2 * tan(0.5f * view_.lens.fov_y);
    if (message.kind == MessageKind::Move) {
        const float metres = metres_of(message, speed_);
        pose_ = fly(pose_, metres * message.right, metres * message.up, metres * message.forward);
    } else if (message.kind == MessageKind::Orbit) {
        pose_ = orbit(pose_, message.dx, message.dy);
    } else if (message.kind == MessageKind::Look) {
        pose_ = look(pose_, message.dx, message.dy, is_flat ? 1.0f : view_.lens.fov_y);
    } else if (message.kind == MessageKind::Pan) {
        pose_ = pan(pose_, message.dx, message.dy, height, is_flat);
    } else if (is_flat) {
        base_.ortho_height = clamp(base_.ortho_height * pow(6.0f / 7.0f, message.steps), 1e-6f, 1e12f);
    } else {
        pose_ = zoom(pose_, message.steps);
    }
    const Transform placed = look_at(pose_.eye, pose_.target, pose_.up);
    const bool is_good = is_finite(placed.row0) && is_finite(placed.row1) && is_finite(placed.row2) &&
                         max_component(abs(pose_.eye)) < 1e9f && max_component(abs(pose_.target)) < 1e9f;
    if (!is_good) pose_ = before; // a step too far
    has_moved_ = true;
    moved_at_s_ = now_s_();
}

void RenderLoop::pick(const Steer& asked) {
    const ClientMessage& message = asked.message;
    const Camera now = camera();
    const std::optional<PickedPoint> point = source_.pick(now, message.x, message.y);
    if (message.use == PickUse::Show) {
        return audience_.tell(asked.client,
                              picked_text(*start_.scene, point ? &*point : nullptr, message.x, message.y));
    }
    if (!point) return audience_.tell(asked.client, notice_text("note", "there is nothing but background"));
    if (message.use == PickUse::Orbit) {
        pose_.centre = point->position;
        return audience_.tell(asked.client, notice_text("note", "the view now turns about this place"));
    }
    const Transform& from = now.world_from_camera;
    view_.lens.focus_distance = max(-dot(point->position - from.translation, column(from, 2)), 1e-6f);
    budget_s_ = kFirstBudget;
    is_done_ = false;
    const bool has_lens = view_.lens.aperture_radius > 0;
    audience_.tell(asked.client,
                   notice_text("note", fmt::format("in focus: {:.4g} m{}", view_.lens.focus_distance,
                                                   has_lens ? "" : " (the lens has no radius, so all is sharp)")));
}

void RenderLoop::set(const Steer& asked) {
    const std::string why_not = set_view_setting(view_, asked.message.name, asked.message.value);
    if (!why_not.empty()) audience_.tell(asked.client, notice_text("error", why_not));
    budget_s_ = kFirstBudget;
    tell_state();
}

void RenderLoop::show_next() {
    const FrameRequest wanted = request();
    if (wanted.is_moving && !is_new_ && last_ && last_->samples >= view_.picture.samples) { // nothing new to be seen
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return;
    }
    std::optional<ShownFrame> frame;
    try {
        frame = source_.next(wanted);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::DeviceFault) throw;
        audience_.tell(0, notice_text("error", error.what()));
        const ViewState failed = std::exchange(view_, shown_);
        view_.display = failed.display;
        return tell_state();
    }
    if (!frame) return;
    is_new_ = false;
    shown_ = view_;
    const double now = now_s_();
    const double since = now - std::exchange(framed_at_s_, now);
    frames_per_second_ = since > 1 ? 0 : frames_per_second_ + 0.3 * (1 / std::max(since, 1e-4) - frames_per_second_);
    budget_s_ = wanted.is_moving ? kFirstBudget : std::min(1.5 * budget_s_, kLongestBudget);
    // A small picture has all its samples: nothing is left to do unless it is to become a large one.
    const bool rests_small = !wanted.is_moving && wanted.view.is_real_time && frame->samples >= view_.picture.samples;
    is_done_ = (frame->is_final || rests_small) && !is_moving();
    last_ = *frame;
    last_->image.pixels.clear();
    audience_.publish(*std::move(frame), input_);
    if (is_done_ || now - told_at_s_ > kTellEvery) tell_state();
}

void RenderLoop::save_pictures() {
    if (saves_.empty() || !last_ || !last_->is_reference) {
        if (saves_.empty() || view_.layer == ShownLayer::Beauty) return;
        audience_.tell(0, notice_text("error", "a layer is shown; show the picture to save it"));
        for (const Save& save : std::exchange(saves_, {})) save.reply({});
        return;
    }
    RenderResult result = source_.result();
    PictureRecord record = start_.record;
    record.settings = view_.picture;
    record.display = view_.display;
    record.camera.camera = camera();
    if (has_moved_) {
        record.camera.target = pose_.target;
        record.camera.up = pose_.up;
        record.camera.name = camera_name_;
    }
    record.camera.fov_deg = degrees_for(view_.lens.fov_y);
    for (const Save& save : std::exchange(saves_, {})) {
        RenderResult copy = result;
        save.reply(encode_picture(save.format == "exr" ? ImageFormat::Exr : ImageFormat::Png, record, copy));
    }
}

void RenderLoop::tell_state() {
    told_at_s_ = now_s_();
    ViewNumbers numbers;
    numbers.frame = last_ ? &*last_ : nullptr;
    numbers.frames_per_second = is_done_ ? 0 : frames_per_second_;
    numbers.pack_ms = packer_.milliseconds();
    numbers.packed_bytes = packer_.bytes();
    numbers.phase = is_done_ ? "done" : (is_moving() ? "moving" : "gathering");
    audience_.tell_state(state_text(view_, numbers, flags()));
}

} // namespace pertev
