#include "session/picture_renderer.h"

#include "base/error.h"
#include "render/camera_work.h"
#include "session/check_integrator.h"
#include "session/shared_frames.h"
#include "session/shared_render.h"

namespace pertev {

bool is_film_of(const Film& film, const RenderSettings& settings) {
    return film.window() == settings.window() && film.aovs() == settings.aovs &&
           sample_layers_of(film) == settings.sample_layers && film.layers_at() == settings.layers_at &&
           film.light_layers() == light_layers_of(settings);
}

Film make_film(Queue& queue, const RenderSettings& settings) {
    const PixelWindow window = settings.window();
    Film film(queue, window.width, window.height, settings.aovs, light_layers_of(settings), settings.layers_at);
    film.set_window(window);
    hold_sample_layers(queue, settings.sample_layers, film);
    return film;
}

std::size_t predicted_film_bytes(const RenderSettings& settings) {
    Queue queue = Queue::make_dry_run(false);
    const Film film = make_film(queue, settings);
    return queue.allocated_bytes();
}

Film& fit_film(Queue& queue, std::optional<Film>& film, const RenderSettings& settings, const AddTargets& add) {
    if (film && is_film_of(*film, settings)) return *film;
    film.reset(); // freed before the new one, so that two need not fit
    Film made = make_film(queue, settings);
    if (add) add(made);
    return film.emplace(std::move(made));
}

NoisyFrame& fit_frame(const DeviceScene& scene, std::optional<NoisyFrame>& frame, uint32_t width, uint32_t height) {
    const bool splits_light = has_lobes(scene.view().variant);
    if (frame && frame->width() == width && frame->height() == height && frame->splits_light() == splits_light) {
        return *frame;
    }
    frame.reset(); // freed before the new one, so that two need not fit
    return frame.emplace(scene.queue(), width, height, splits_light);
}

Queue& PictureRenderer::film_queue() { return sharing_ != nullptr ? sharing_->film_queue() : queue(); }

void PictureRenderer::set_scene(const PreparedScene& scene, const RenderSettings& settings) {
    const UseThreads use(queue().threads());
    scene_.set(scene, settings);
    update_other_devices(scene, kAllParts);
}

void PictureRenderer::update_scene(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings) {
    const UseThreads use(queue().threads());
    scene_.update(scene, parts, settings);
    update_other_devices(scene, parts);
}

void PictureRenderer::update_other_devices(const PreparedScene& scene, uint32_t parts) {
    if (sharing_ != nullptr) sharing_->change_scene(scene, parts);
    if (sharing_frames_ != nullptr) sharing_frames_->change_scene(scene, parts);
}

PictureView PictureRenderer::view_of(const Camera& camera, const RenderSettings& settings) {
    scene_.make_what_is_used(settings);
    const SceneView& scene = scene_.view();
    PictureView picture = {scene,
                           make_camera_rays(camera, filter_.set(settings.filter, filter_radius_of(settings)),
                                            settings.width, settings.height, scene.centre),
                           settings.transparent};
    picture.camera.interior = scene_.interior_of(camera);
    picture.camera.motion = motion_of(camera, scene.centre);
    picture.camera.is_open = picture.camera.motion.moves() || scene.motions.is_there();
    return picture;
}

/// Returns the camera's motion while the shutter is open, in the translated world and on the device.
MotionTrack PictureRenderer::motion_of(const Camera& camera, Vec3 centre) {
    if (camera.motion.empty()) return {};
    std::vector<MotionKey> keys = camera.motion;
    for (MotionKey& key : keys) key.position = key.position - centre;
    if (camera_motion_.size() != keys.size()) camera_motion_ = {queue(), keys.size(), "camera"};
    queue().wait();
    camera_motion_.upload(std::span<const MotionKey>(keys));
    return {camera_motion_.data(), camera.world_from_camera.translation - centre,
            static_cast<uint32_t>(keys.size() - 1)};
}

Integrator& PictureRenderer::begin(const Camera& camera, const RenderSettings& settings, uint32_t samples,
                                   uint64_t number) {
    const PictureView picture = view_of(camera, settings); // first, because it checks that there is a scene
    check_camera(settings, camera);
    return begin(picture, settings, samples, number);
}

Integrator& PictureRenderer::begin(const PictureView& picture, const RenderSettings& settings, uint32_t samples,
                                   uint64_t number) {
    if (picture.camera.is_open) {
        check_shutter(settings);
        if (picture.camera.is_meter()) {
            throw Error(ErrorCode::BadInput, "shutter", "", "irradiance does not support an open shutter");
        }
    }
    if (picture.scene.has_media != 0) check_media(settings);
    const IntegratorSettings& wanted = settings;
    const bool is_aside =
        number == 0 && begun_number_ == last_number_ && main_.integrator && main_.integrator->has_made();
    HeldIntegrator& held = is_aside ? aside_ : main_;
    if (!is_aside) aside_ = {};
    const bool stays = held.integrator && change_settings(*held.integrator, held.settings, wanted);
    if (!stays) {
        held.integrator.reset(); // freed with its queues
        held.integrator = make_integrator(queue(), wanted);
    }
    held.settings = wanted;
    Integrator& integrator = *held.integrator;
    SceneTracer& tracer = scene_.tracer();
    tracer.time_kinds(settings.time_kinds);
    integrator.stop_with(nullptr);
    if (stays && number != 0 && number == begun_number_) integrator.expect_same_picture();
    if (!is_aside) begun_number_ = 0; // because the next line may throw
    integrator.begin(picture, tracer, samples);
    if (!is_aside) begun_number_ = number;
    queue().wait();
    return integrator;
}

void PictureRenderer::find_centres(const Camera& camera, const RenderSettings& settings, const Film& film) {
    if (!has_centres(settings)) return;
    const UseThreads use(queue().threads());
    centres_.find(view_of(camera, settings), scene_.tracer(), settings.path.seed, film.view().window, film.centres());
    queue().wait(); // the camera's keys may change
}

void PictureRenderer::add_first_hits(const Camera& camera, const RenderSettings& settings, SampleRange samples,
                                     const Film& film) {
    if ((settings.sample_layers & (kFirstHitLayers | kLayerCount)) == 0) return;
    const UseThreads use(queue().threads());
    first_hits_.add(view_of(camera, settings), scene_.tracer(), settings.path.sampler, settings.path.seed,
                    settings.mattes, samples.first, samples.count(), film);
}

RenderResult PictureRenderer::render_separately(const Camera& camera, const RenderSettings& settings, uint32_t first) {
    Film film = make_film(queue(), settings);
    find_centres(camera, settings, film);
    Integrator& integrator = begin(camera, settings, settings.samples);
    integrator.render(first, settings.samples, film.view());
    add_first_hits(camera, settings, {first, first + settings.samples}, film);
    film.set_samples({first, first + settings.samples});
    RenderResult result;
    result.samples = settings.samples;
    result.rays = integrator.rays();
    result.picture = film.picture(settings.transparent);
    result.layers = film.layers();
    result.ids = film.ids();
    return result;
}

std::vector<RayWork> PictureRenderer::count_camera_work(const Camera& camera, const RenderSettings& settings) {
    const PictureView picture = view_of(camera, settings); // first: it checks that there is a scene
    return pertev::count_camera_work(queue(), scene_.tracer(), picture);
}

} // namespace pertev
