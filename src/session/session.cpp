#include "session/session.h"

#include "session/check_integrator.h"
#include "session/crop.h"

namespace pertev {

Session::Session(Queue& queue, const PreparedScene& scene, const Camera& camera, const RenderSettings& settings)
    : scene_(queue), pictures_(scene_), film_(pictures_, camera, settings), frames_(pictures_), meter_(pictures_) {
    pictures_.set_scene(scene, settings);
}

void Session::set_scene(const PreparedScene& scene) {
    cut();
    film_.restart_for_scene();
    pictures_.set_scene(scene, settings());
}

void Session::update_scene(const PreparedScene& scene, uint32_t parts) {
    film_.restart_for_scene();
    frames_.scene_changes();
    pictures_.update_scene(scene, parts, settings());
}

void Session::set_camera(const Camera& camera) {
    const bool has_samples = film_.samples().count() > 0;
    const Camera before = this->camera();
    if (film_.set_camera(camera) && has_samples) previous_camera_ = before;
}

void Session::set_settings(const RenderSettings& settings) {
    check_integrator(settings);
    const bool on_cuda = scene_.queue().is_cuda();
    check_choice(tracers_of(settings, on_cuda), on_cuda);
    const bool same_frames = this->settings().frame_depth == settings.frame_depth;
    if (film_.set_settings(settings)) cut();
    if (!same_frames) frames_.cut();
    const UseThreads use(scene_.queue().threads());
    scene_.set_tracer(settings);
}

void Session::set_targets(AddTargets add) {
    film_.set_targets(std::move(add));
    cut();
}

void Session::cut() {
    previous_camera_.reset();
    ++cuts_;
    frames_.cut();
    film_.restart();
}

Image Session::motion() { return pixels_in(frames_.motion(camera(), settings()), settings().window()); }

RenderResult Session::result() {
    RenderResult result = film_.result();
    if ((settings().aovs & kAovMotion) != 0) result.layers.push_back(motion_layer(motion()));
    return result;
}

RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings, Sink& sink) {
    Session session(queue, prepared, camera, settings);
    session.render(settings.range(), sink);
    return session.result();
}

} // namespace pertev
