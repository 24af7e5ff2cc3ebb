#include "session/session.h"

#include <algorithm>

#include "base/error.h"
#include "base/limits.h"
#include "base/stopwatch.h"
#include "denoise/motion_vectors.h"
#include "device/launch.h"
#include "device_scene/place_meshes.h"
#include "render/add_frame_to_film.h"
#include "render/camera_work.h"
#include "render/hidden_back_share.h"
#include "session/check_integrator.h"
#include "session/meter_exposure.h"

namespace pertev {
namespace {

constexpr uint32_t kFirstAtOnce = 16; // samples of a first pass

/// Samples of the next pass: aims at a third of a second, so that progress moves and Ctrl-C is heard, at no cost that
/// shows. Where samples are cheaper together and there is no limit of time, as many as are done already go at once, as
/// far as they do: progress is soon seen, and what a pass costs by itself is paid a few times. Never past the time that
/// is left. `done` samples took `seconds`, `left` are to come.
uint32_t next_pass(const RenderSettings& settings, uint32_t left, uint32_t done, double seconds) {
    if (settings.pass_samples > 0) return std::min(left, settings.pass_samples);
    const uint64_t pixels = uint64_t(settings.width) * settings.height;
    const uint32_t at_once =
        settings.time_limit_s > 0 ? 1 : std::min(samples_at_once(settings, pixels), std::max(done, kFirstAtOnce));
    if (done == 0) return std::min(left, at_once);
    const double a_sample = std::max(seconds / done, 1e-9);
    double budget = 1.0 / 3;
    if (settings.time_limit_s > 0) budget = std::min(budget, settings.time_limit_s - seconds);
    return std::min(left, std::max(at_once, static_cast<uint32_t>(std::clamp(budget / a_sample, 1.0, 65536.0))));
}

bool same_film(const Film& film, const RenderSettings& settings) {
    return film.width() == settings.width && film.height() == settings.height && film.view().aovs == settings.aovs &&
           film.light_layers() == light_layers_of(settings);
}

/// Auxiliary layers, then those of light paths.
std::vector<FilmLayer> layers_of(const Film& film, const RenderSettings& settings, uint64_t samples) {
    std::vector<FilmLayer> layers = film.layers(samples);
    for (uint32_t i = 0; i < film.light_layers(); ++i) {
        layers.push_back({settings.light_paths->expressions[i].name, {"R", "G", "B"}, film.light_layer(i, samples)});
    }
    return layers;
}

} // namespace

Session::Session(Queue& queue, const PreparedScene& scene, const Camera& camera, const RenderSettings& settings)
    : queue_(queue), camera_(camera), settings_(settings), filter_(queue), sharing_timer_(queue) {
    check_integrator(settings);
    check_camera(settings, camera);
    set_scene(scene);
    history_.cuts = 0;
}

void Session::set_scene(const PreparedScene& scene) {
    cut();
    tracer_.reset(); // with its trees, so that two scenes' need not fit
    upload(scene, kAllParts);
}

void Session::update_scene(const PreparedScene& scene, uint32_t parts) {
    ++picture_number_;
    begin_film();
    scene_has_changed_ = true;
    keep_places();
    upload(scene, parts);
}

/// Of instances, for the next frame, before they are moved.
void Session::keep_places() {
    const bool is_asked_for = reconstruction_ && reconstruction_->frames() > 0 && !has_moved_ && !camera_before_;
    if (is_asked_for) copy_places();
}

void Session::copy_places() {
    if (places_before_.size() != instance_count_) places_before_ = {queue_, instance_count_, "instances before"};
    queue_.copy_on_device(places_before_.data(), scene_->view().instances, instance_count_ * sizeof(InstanceView));
    scene_->keep_positions();
    has_moved_ = true;
}

/// Those parts of `scene`; the others stay. What a part lies in is kept where it is large enough.
void Session::upload(const PreparedScene& scene, uint32_t parts) {
    const Stopwatch watch;
    hidden_back_share_.reset();
    if ((parts & kPartTrees) != 0) structures_ = prepared_structures_ = scene.structures;
    try {
        if ((parts & kPartTrees) != 0 && tracer_) tracer_->set_structures(*structures_);
        if (scene_) {
            scene_->update(queue_, scene, parts);
        } else {
            scene_.emplace(queue_, scene);
        }
    } catch (...) {
        scene_.reset(); // parts of it may be missing
        tracer_.reset();
        throw;
    }
    instance_count_ = static_cast<uint32_t>(scene.scene->instances.size());
    placed_ = scene.placed;
    has_poses_ = !scene.poses.empty();
    deformed_ = scene_->deformed(scene);
    if (tracer_) tracer_->set_surfaces(scene_->view());
    if (!take_tracer() && (parts & (kPartTrees | kPartPoses)) != 0) fit_trees();
    queue_.wait();
    stats_.upload_seconds = watch.seconds();
}

void Session::set_camera(const Camera& camera) {
    if (camera == camera_) return;
    if (history_.samples > 0) history_.previous_camera = camera_;
    camera_ = camera;
    hidden_back_share_.reset();
    ++picture_number_;
    begin_film();
}

void Session::set_settings(const RenderSettings& settings) {
    check_integrator(settings);
    check_choice(tracers_of(settings, queue_.is_cuda()), queue_.is_cuda());
    const bool same = same_picture(settings_, settings), same_frames = settings_.frame_depth == settings.frame_depth;
    if (settings.width != settings_.width || settings.height != settings_.height) hidden_back_share_.reset();
    settings_ = settings;
    if (film_ && !same_film(*film_, settings_)) film_.reset();
    if (!same) cut();
    if (!same_frames) cut_frames();
    if (scene_) take_tracer();
}

void Session::cut() {
    history_.previous_camera.reset();
    ++history_.cuts;
    ++picture_number_;
    cut_frames();
    begin_film();
}

/// What earlier frames have seen is forgotten.
void Session::cut_frames() {
    if (reconstruction_) reconstruction_->cut();
    if (restir_) restir_->cut();
    has_moved_ = scene_has_changed_ = false;
    camera_before_.reset();
}

void Session::keep_as_before() {
    PERTEV_CHECK(scene_.has_value());
    if (reconstruction_) reconstruction_->cut();
    copy_places();
    camera_before_ = camera_;
}

Image Session::motion() {
    if (!camera_before_) {
        Image none{settings_.width, settings_.height, 2, {}};
        none.pixels.resize(std::size_t(2) * settings_.width * settings_.height);
        return none;
    }
    const PictureView picture = view_of(camera_, settings_);
    const SceneView& scene = picture.scene;
    const CameraView camera = make_camera_view(*camera_before_, settings_.width, settings_.height, scene.centre);
    return motion_vectors(queue_, *tracer_, picture, camera, {places_before_.data(), scene_->meshes_before()});
}

/// The tracer that the settings ask for; the one there is where that is the same: false.
bool Session::take_tracer() {
    const TracerChoice choice = tracers_of(settings_, queue_.is_cuda(), has_poses_);
    if (tracer_ && tracer_->choice() == choice) return false;
    tracer_.reset(); // before the new one, so that both need not fit
    tracer_.emplace(queue_, *structures_, choice);
    tracer_->set_surfaces(scene_->view());
    fit_trees();
    return true;
}

/// To the vertices that were moved on the device.
void Session::fit_trees() {
    if (!has_poses_) return;
    try {
        if (tracer_->can_deform()) return tracer_->deform(deformed_, placed_);
        structures_ = deformed_.empty() ? prepared_structures_ : structures_->fitted(queue_, deformed_, placed_);
        tracer_->set_structures(*structures_);
    } catch (...) {
        scene_.reset(); // its trees are not those of its vertices
        tracer_.reset();
        throw;
    }
}

/// Forgets the samples. The film itself is cleared when it is next looked at.
void Session::begin_film() {
    history_.samples = 0;
    stats_ = {.upload_seconds = stats_.upload_seconds};
    film_is_old_ = true;
}

/// `film` as `settings` need it: the one there is, or a new one without samples.
Film& Session::fit(std::optional<Film>& film, const RenderSettings& settings) {
    if (film && same_film(*film, settings)) return *film;
    film.reset(); // before the new one, so that both need not fit
    return film.emplace(queue_, settings.width, settings.height, settings.aovs, light_layers_of(settings));
}

Film& Session::current_film() {
    if (film_ && film_is_old_) film_->clear();
    film_is_old_ = false;
    return fit(film_, settings_);
}

PictureView Session::view_of(const Camera& camera, const RenderSettings& settings) {
    PERTEV_CHECK(scene_.has_value() && tracer_.has_value()); // the last set_scene or set_settings threw
    const SceneView& scene = scene_->view();
    PictureView picture = {scene,
                           make_camera_rays(camera, filter_.set(settings.filter, filter_radius_of(settings)),
                                            settings.width, settings.height, scene.centre),
                           settings.transparent};
    picture.camera.motion = motion_of(camera, scene.centre);
    picture.camera.is_open = picture.camera.motion.moves() || scene.motions.is_there();
    return picture;
}

/// While the shutter is open, in the moved world; on the device.
MotionTrack Session::motion_of(const Camera& camera, Vec3 centre) {
    if (camera.motion.empty()) return {};
    std::vector<MotionKey> keys = camera.motion;
    for (MotionKey& key : keys) key.place = key.place - centre;
    if (camera_motion_.size() != keys.size()) camera_motion_ = {queue_, keys.size(), "camera"};
    queue_.wait();
    camera_motion_.upload(std::span<const MotionKey>(keys));
    return {camera_motion_.data(), camera.world_from_camera.translation - centre,
            static_cast<uint32_t>(keys.size() - 1)};
}

/// Returns an integrator that is ready to add `samples` samples of the picture of `settings`, never to be abandoned.
/// Pictures of one number, not 0, are the same.
Integrator& Session::begin(const Camera& camera, const RenderSettings& settings, uint32_t samples,
                           uint64_t picture_number) {
    const PictureView picture = view_of(camera, settings); // first: it checks that there is a scene
    check_camera(settings, camera);
    if (picture.camera.is_open) {
        check_shutter(settings);
        if (is_light_meter(camera.projection)) {
            throw Error(ErrorCode::BadInput, "--shutter: light is measured at one moment");
        }
    }
    const IntegratorSettings& wanted = settings;
    // A look aside leaves alone what the film's next samples need.
    const bool is_aside =
        picture_number == 0 && begun_number_ == picture_number_ && main_.integrator && main_.integrator->has_made();
    HeldIntegrator& held = is_aside ? aside_ : main_;
    if (!is_aside) aside_ = {};
    const bool stays = held.integrator && change_settings(*held.integrator, held.settings, wanted);
    if (!stays) {
        held.integrator.reset(); // with its queues
        held.integrator = make_integrator(queue_, wanted);
    }
    held.settings = wanted;
    Integrator& integrator = *held.integrator;
    tracer_->time_kinds(settings.time_kinds);
    integrator.abandon_when(nullptr);
    if (stays && picture_number != 0 && picture_number == begun_number_) integrator.expect_same_picture();
    if (!is_aside) begun_number_ = 0; // where the next line throws
    integrator.begin(picture, *tracer_, samples);
    if (!is_aside) begun_number_ = picture_number;
    queue_.wait();
    return integrator;
}

uint32_t Session::render(uint32_t samples, const std::function<bool(const RenderProgress&)>& keep_going) {
    const uint32_t first = history_.samples, count = std::min(samples, kMaxSamplesPerPixel - first);
    if (count == 0) return 0;
    const Stopwatch since_call;
    Film& film = current_film();
    const bool denoises = settings_.denoise != Denoise::None;
    if (denoises && first == 0) begin_signals();
    Integrator& integrator = begin(camera_, settings_, denoises ? 1 : count, picture_number_);
    integrator.abandon_when(abandon_);
    const RayCounts rays_before = stats_.rays;
    const double seconds_before = stats_.render_seconds;
    const Stopwatch watch;
    // The first sample has nothing before it that could be kept.
    const bool is_apart = keeps_samples_ && abandon_ != nullptr && first > 0 && !denoises;
    if (!is_apart) pass_film_.reset();
    Film& into = is_apart ? fit(pass_film_, settings_) : film;
    bool makes = false;
    const auto goes_on = [&](double made_share) {
        makes = true;
        const double seconds = watch.seconds();
        if (abandon_ != nullptr && *abandon_) return false;
        if (settings_.time_limit_s > 0 && seconds >= settings_.time_limit_s) return false;
        return !keep_going || keep_going({first, first + count, seconds, integrator.rays(), made_share, seconds});
    };
    if (!integrator.make_ready(goes_on)) return 0;
    const double made_seconds = makes ? watch.seconds() : 0;
    for (uint32_t done = 0; done < count;) {
        const auto now = [&] {
            return RenderProgress{first + done, first + count, watch.seconds(), integrator.rays(), 1, made_seconds};
        };
        const uint32_t pass = next_pass(settings_, count - done, done, watch.seconds());
        uint32_t added = pass;
        if (denoises) {
            render_signals(integrator, first + done, pass);
        } else {
            if (is_apart) into.clear();
            added = integrator.render_while(first + done, pass, into.view(),
                                            [&] { return !keep_going || keep_going(now()); });
        }
        if (abandon_ != nullptr && *abandon_) { // parts of a sample may be missing
            if (is_apart) break;
            begin_film();
            return 0;
        }
        if (added == 0) break;
        if (is_apart) film.add(into);
        done += added;
        const double seconds = watch.seconds();
        history_.samples = first + done;
        stats_.rays = rays_before + integrator.rays();
        stats_.kind_seconds = tracer_->seconds();
        stats_.render_seconds = seconds_before + seconds;
        if (first == 0 && done == added) stats_.first_pixel_seconds = since_call.seconds();
        if (added < pass || (keep_going && !keep_going(now()))) break;
        if (settings_.time_limit_s > 0 && seconds >= settings_.time_limit_s) break;
    }
    return history_.samples - first;
}

/// Finds what camera rays meet: those through the pixels' centres, and those of the first samples.
void Session::begin_signals() {
    NoisyFrame& frame = fit(noisy_frame_, settings_.width, settings_.height);
    if (!denoiser_ || denoiser_->width() != settings_.width || denoiser_->height() != settings_.height) {
        denoiser_.reset();
        denoiser_.emplace(queue_, settings_.width, settings_.height);
    }
    RenderSettings of_features = settings_;
    of_features.path.max_depth = 0;
    RenderSettings of_centres = of_features;
    of_centres.filter = PixelFilter::Box;
    of_centres.filter_radius = 0x1p-20f; // pixels
    Camera pinhole = camera_;
    pinhole.aperture_radius = 0;
    Integrator& of_pinhole = begin(pinhole, of_centres, 1);
    frame.begin();
    of_pinhole.render(0, 1, frame.film_view());
    denoiser_->begin(frame, view_of(pinhole, of_centres).camera.view);
    Integrator& integrator = begin(camera_, of_features, 1);
    for (uint32_t sample = 0; sample < PictureDenoiser::kFeatures; ++sample) {
        integrator.render(sample, 1, frame.film_view());
        denoiser_->add_features(frame, scene_->view());
    }
}

/// Adds samples to the film and to the signals that are denoised.
void Session::render_signals(Integrator& integrator, uint32_t first, uint32_t count) {
    const SceneView& scene = scene_.value().view();
    FilmView into = noisy_frame_->film_view();
    into.invalid = film_->view().invalid;
    for (uint32_t sample = first; sample < first + count; ++sample) {
        integrator.render(sample, 1, into);
        if (abandon_ != nullptr && *abandon_) return;
        launch(queue_, "add_frame_to_film", settings_.width * settings_.height,
               AddFrameToFilm{noisy_frame_->view(), film_->view(), scene, sample == 0});
        denoiser_->add(*noisy_frame_, scene);
    }
    queue_.wait();
}

std::optional<Image> Session::denoised() {
    if (settings_.denoise == Denoise::None || history_.samples == 0) return std::nullopt;
    Image picture = denoiser_.value().picture();
    if (!settings_.transparent) return picture;
    Image with_alpha = this->picture();
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        with_alpha.pixels[i / 3 * 4 + i % 3] = picture.pixels[i];
    }
    return with_alpha;
}

void Session::display(ToneMap tone_map, float exposure_stops) {
    current_film().display(history_.samples, tone_map, exposure_stops, settings_.transparent);
}

Rgba8Image Session::displayed() { return current_film().displayed(); }

RenderStats Session::stats() {
    if (!hidden_back_share_) {
        const PictureView picture = view_of(camera_, settings_); // first: it checks that there is a scene
        hidden_back_share_ = hidden_back_share(queue_, *tracer_, picture);
    }
    RenderStats stats = stats_;
    stats.samples = history_.samples;
    stats.invalid_samples = current_film().invalid_samples();
    stats.hidden_back_share = *hidden_back_share_;
    stats.device_peak_bytes = queue_.peak_bytes();
    return stats;
}

std::vector<FilmLayer> Session::layers() { return layers_of(current_film(), settings_, history_.samples); }

RenderResult Session::result() {
    RenderResult result = {stats(), picture(), denoised(), layers(), current_film().ids()};
    if ((settings_.aovs & kAovMotion) != 0) {
        const AovGroup& group = aov_group(kAovMotion);
        result.layers.push_back({group.layer, channel_names(group), motion()});
    }
    return result;
}

float Session::meter(ToneMap tone_map) {
    return meter_exposure(settings_, tone_map, [this](const RenderSettings& settings) {
        Film& film = fit(meter_film_, settings);
        film.clear();
        begin(camera_, settings, settings.samples).render(0, settings.samples, film.view());
        return film.picture(settings.samples, settings.transparent);
    });
}

RenderResult Session::look_aside(const Camera& camera, const RenderSettings& settings, uint32_t first) {
    Film film(queue_, settings.width, settings.height, settings.aovs, light_layers_of(settings));
    Integrator& integrator = begin(camera, settings, settings.samples);
    integrator.render(first, settings.samples, film.view());
    RenderResult result;
    result.samples = settings.samples;
    result.rays = integrator.rays();
    result.picture = film.picture(settings.samples, settings.transparent);
    result.layers = layers_of(film, settings, settings.samples);
    result.ids = film.ids();
    return result;
}

std::vector<RayWork> Session::count_camera_work() {
    return pertev::count_camera_work(queue_, *tracer_, view_of(camera_, settings_));
}

} // namespace pertev
