#include "session/pictures/render_sequence.h"

#include "base/stopwatch.h"

namespace pertev {
namespace {

/// Lets the camera of `frame` move while the shutter is open.
void move_in_shutter(uint32_t frame, MovingScene& moving, const FrameCamera& camera, Camera& moved) {
    const FrameRange& sequence = camera.sequence;
    // Scale of the permitted error: the distance to what it looks at, or the scene's size if that is smaller.
    const Bounds3 bounds = bounds_of(moving.scene());
    const float size = bounds.is_empty() ? 1.0f : 0.5f * max_component(bounds.size());
    const float half = max(0x1p-30f, min(1.0f, min(moved.focus_distance, size)));
    const PlacedBox about_eye = {moved.world_from_camera, {{-half, -half, -half}, {half, half, half}}};
    const FittedMotions fitted = fit_motions({&about_eye, 1}, [&](double share) {
        const double time_s = sequence.shutter->time_at(sequence.time_of(frame).value(), share);
        Scene cameras; // nothing else of a scene moves a camera
        cameras.cameras = moving.cameras_at(time_s);
        cameras.origin_in_file = moving.scene().origin_in_file;
        const CameraSource at = camera_at(camera.camera, cameras, time_s, sequence.turn_at(frame, share));
        return std::vector{std::optional(at.camera.world_from_camera)};
    });
    moved.motion = fitted.motions.front().keys;
}

/// Goes to the frame to which motion vectors of `frame` refer.
void show_frame_before(uint32_t frame, const FrameCamera& camera, MovingScene& moving, Session& session, Sink& sink) {
    const std::optional<double> time_s = camera.sequence.time_before(frame);
    seek(time_s, moving, session, sink);
    session.set_camera(camera_at(camera.camera, moving.scene(), time_s, camera.sequence.turn_before(frame)).camera);
    session.store_previous();
}

/// Renders a frame of samples. With a history, frames have samples of their own numbers, else their noise would be the
/// same; layers of ids stay those of sample 0.
RenderedFrame render_picture_of(uint32_t frame, Session& session, PictureRecord& record, double update_s, Sink& sink) {
    const uint32_t count = record.settings.samples;
    uint32_t first = 0;
    session.film_render().begin_picture(); // nothing may have moved
    if (record.in_sequence) {
        record.in_sequence->number = frame;
        first = FrameRange::first_sample_of(frame, count);
    }
    const uint32_t rendered = session.render(SampleRange{first, first + count}, sink);
    if (rendered < count && record.in_sequence) return {{}, update_s}; // denoising would end the history
    RenderedFrame made = {session.result(), update_s};
    if (first == 0 || (record.settings.aovs & kAovIds) == 0) return made;
    RenderSettings of_ids = record.settings;
    of_ids.aovs = kAovIds, of_ids.sample_layers = 0, of_ids.denoise = Denoise::None;
    of_ids.samples = 1, of_ids.path.max_depth = 0;
    made.result.ids = session.render_separately(session.camera(), of_ids).ids;
    return made;
}

} // namespace

void seek(std::optional<double> time_s, MovingScene& moving, Session& session, Sink& sink) {
    if (!time_s) return;
    if (const uint32_t parts = moving.set_time(*time_s, sink)) session.update_scene(moving.prepared(), parts);
}

CameraSource camera_at(const MovingCamera& camera, const Scene& scene, std::optional<double> time_s, double turn) {
    const CameraChoice choice = camera.choice_at(time_s);
    CameraSource source = source_of(choice, camera.at(scene, time_s), scene.origin_in_file);
    if (turn == 0) return source;
    source.camera = camera.turned(source.camera, turn);
    source.target.reset(); // its text describes the camera's start
    source.up.reset();
    return source;
}

void place_frame(uint32_t frame, MovingScene& moving, const FrameCamera& camera, PictureRecord& record) {
    record.scene.time_s = camera.sequence.time_of(frame);
    record.scene.shutter = camera.sequence.shutter;
    const ListedCamera* const listed = camera.list.empty() ? nullptr : &camera.list[frame];
    record.camera = camera_at(listed != nullptr ? listed->camera : camera.camera, moving.scene(), record.scene.time_s,
                              camera.sequence.turn_of(frame));
    if (listed != nullptr) record.settings.width = listed->size.width, record.settings.height = listed->size.height;
    if (camera.sequence.shutter) move_in_shutter(frame, moving, camera, record.camera.camera);
}

void seek_frame(uint32_t frame, const FrameCamera& camera, MovingScene& moving, Session& session, PictureRecord& record,
                Sink& sink) {
    seek(camera.sequence.time_of(frame), moving, session, sink);
    place_frame(frame, moving, camera, record);
    session.set_camera(record.camera.camera);
    if (!camera.list.empty()) session.set_settings(record.settings);
}

RenderedFrame render_frame(uint32_t frame, const SequenceOfFrames& frames, Sink& sink) {
    auto& [camera, moving, record, session] = frames;
    const Stopwatch update;
    // In real time the frame before has just been rendered.
    if ((record.settings.aovs & kAovMotion) != 0 && camera.list.empty() && !record.frame)
        show_frame_before(frame, camera, moving, session, sink);
    seek_frame(frame, camera, moving, session, record, sink);
    const double update_s = update.seconds();
    if (!record.frame) {
        session.interrupt_passes(true); // a frame without all its samples is worth nothing
        return render_picture_of(frame, session, record, update_s, sink);
    }
    record.in_sequence->number = frame;
    const Stopwatch watch;
    if (!session.render_frame(FrameRange::sample_of(frame), record.frame->reconstruction, record.frame->restir, sink)) {
        return {{}, update_s};
    }
    RenderedFrame rendered = {session.frame_result(), update_s};
    rendered.result.render_seconds = watch.seconds();
    return rendered;
}

} // namespace pertev
