#include "session/batch_render.h"

#include <algorithm>

#include "base/error.h"
#include "base/limits.h"
#include "base/stopwatch.h"
#include "image/picture_hash.h"

namespace pertev {
namespace {

constexpr uint64_t kAtOnce = 1u << 27, kAtOnceOnCpu = 1u << 20; // samples of a pass, so that cancellation is prompt

CameraBatch checked(CameraBatch batch, const RenderSettings& settings) {
    check_batch(batch, settings);
    return batch;
}

} // namespace

BatchRender::BatchRender(PictureRenderer& pictures, CameraBatch batch, const RenderSettings& settings, uint32_t at_once)
    : pictures_(pictures), batch_(checked(std::move(batch), settings)), settings_(settings),
      at_once_(std::min(at_once, batch_.count())), memory_(pictures.queue(), batch_, settings, at_once_) {
    PERTEV_CHECK(at_once > 0 && uint64_t(settings.width) * settings.height * at_once_ < UINT32_MAX);
    if (!is_one_job(settings)) in_turn_.emplace(pictures, batch_.cameras.front(), settings);
}

bool BatchRender::next(BatchArrays& arrays, Sink& sink) {
    if (done_ == batch_.count()) return false;
    const uint32_t count = std::min(at_once_, batch_.count() - done_);
    arrays.fit(pictures_.queue(), settings_, at_once_);
    arrays.first = done_, arrays.pictures = count;
    arrays.noisy_hashes.assign(settings_.is_denoised() ? count : 0, {});
    if (!(in_turn_ ? render_in_turn(arrays, sink) : render_together(arrays, sink))) return false;
    done_ += count;
    return true;
}

/// Uploads the next `count` cameras with their seeds.
PictureView BatchRender::view_of_chunk(uint32_t count) {
    Camera at_rest = batch_.cameras[done_];
    at_rest.motion.clear();
    PictureView picture = pictures_.view_of(at_rest, settings_);
    std::vector<CameraRays> cameras;
    std::vector<uint32_t> seeds;
    std::vector<MotionKey> motions;
    for (uint32_t k = done_; k < done_ + count; ++k) {
        const Camera& camera = batch_.cameras[k];
        const SceneView& scene = picture.scene_of((k - done_) * settings_.width * settings_.height);
        const Vec3 centre = scene.centre;
        CameraRays rays = make_camera_rays(camera, picture.camera.filter, settings_.width, settings_.height, centre);
        rays.interior = pictures_.scene().interior_of(camera);
        if (!camera.motion.empty()) {
            rays.motion = {memory_.motions.data() + motions.size(), camera.world_from_camera.translation - centre,
                           static_cast<uint32_t>(camera.motion.size() - 1)};
            for (MotionKey key : camera.motion) {
                key.position = key.position - centre;
                motions.push_back(key);
            }
        }
        rays.is_open = rays.motion.moves() || scene.motions.is_there();
        picture.camera.is_open = picture.camera.is_open || rays.is_open;
        cameras.push_back(rays);
        seeds.push_back(batch_.seed_of(k, settings_));
    }
    pictures_.queue().wait(); // the last chunk's views
    memory_.cameras.upload(cameras);
    memory_.seeds.upload(seeds);
    memory_.motions.upload(motions);
    picture.camera.height = settings_.height * count;
    picture.batch = {memory_.cameras.data(), memory_.seeds.data(), settings_.width * settings_.height};
    return picture;
}

bool BatchRender::render_together(BatchArrays& arrays, Sink& sink) {
    const PictureView picture = view_of_chunk(arrays.pictures);
    if (has_centres(settings_)) {
        const UseThreads use(pictures_.queue().threads());
        CentreArrays into;
        for (BatchArrays::Layer& layer : arrays.layers) into.of(layer.group) = layer.values.data();
        into.ids = arrays.ids.data();
        const PixelWindow window = {.width = picture.camera.width, .height = picture.camera.height};
        pictures_.centres().find(picture, pictures_.scene().tracer(), 0, window, into);
        rays_.camera += window.count();
    }
    if (settings_.samples == 0) {
        const double share = static_cast<double>(done_ + arrays.pictures) / batch_.count();
        return sink.goes_on({.doing = "pictures", .share = share});
    }
    if (!add_samples(picture, sink)) return false;
    resolve(*memory_.film, arrays.pictures, 0, arrays);
    return true;
}

/// Renders the samples of a chunk into the film of the tall picture.
bool BatchRender::add_samples(const PictureView& picture, Sink& sink) {
    Film& film = *memory_.film;
    film.clear();
    FilmView view = film.view();
    view.window.height = picture.camera.height; // the last chunk may be smaller
    const bool on_cuda = pictures_.queue().is_cuda();
    const uint32_t samples = settings_.samples;
    const uint64_t at_once = on_cuda ? kAtOnce : kAtOnceOnCpu;
    const auto most = static_cast<uint32_t>(std::clamp<uint64_t>(at_once / view.window.count(), 1, samples));
    Integrator& integrator = pictures_.begin(picture, settings_, most);
    integrator.stop_with(on_cuda ? nullptr : &sink);
    const double before = done_, now = view.window.count() / (picture.batch.pixels * 1.0);
    for (uint32_t first = 0; first < samples; first += most) {
        const uint32_t count = std::min(most, samples - first);
        integrator.render(first, count, view);
        const double share = (before + now * (first + count) / samples) / batch_.count();
        if (!sink.goes_on({.doing = "pictures", .share = share})) return false;
    }
    film.set_samples({0, samples});
    rays_ = rays_ + integrator.rays();
    invalid_samples_ += film.invalid_samples();
    return true;
}

bool BatchRender::render_in_turn(BatchArrays& arrays, Sink& sink) {
    for (uint32_t k = 0; k < arrays.pictures; ++k) {
        RenderSettings settings = settings_;
        settings.path.seed = batch_.seed_of(done_ + k, settings_);
        in_turn_->set_camera(batch_.cameras[done_ + k]);
        in_turn_->set_settings(settings);
        in_turn_->restart();
        const double first = static_cast<double>(done_ + k) / batch_.count(), each = 1.0 / batch_.count();
        ProgressSink of_picture = part_of(sink, first, first + each);
        if (in_turn_->render({0, settings.samples}, of_picture) < settings.samples) return false;
        rays_ = rays_ + in_turn_->rays();
        invalid_samples_ += in_turn_->film().invalid_samples();
        resolve(in_turn_->film(), 1, k, arrays);
        if (const std::optional<Image> denoised = in_turn_->denoised()) {
            arrays.noisy_hashes[k] = picture_hash(in_turn_->picture());
            arrays.denoiser = in_turn_->denoiser();
            pictures_.queue().copy_to_device(arrays.color.data() + k * denoised->pixels.size(), denoised->pixels.data(),
                                             denoised->pixels.size() * sizeof(float));
            pictures_.queue().wait(); // the image ends here
        }
    }
    return !sink.should_stop();
}

/// Stores the film's first `pictures` pictures in the arrays, from picture `at` of the chunk on.
void BatchRender::resolve(Film& film, uint32_t pictures, uint32_t at, BatchArrays& arrays) {
    const uint32_t each = settings_.width * settings_.height, pixels = each * pictures;
    const std::size_t first = std::size_t(each) * at;
    const Buffer<float>& into = settings_.is_denoised() ? arrays.noisy : arrays.color;
    float* const picture = into.data() + first * (settings_.transparent ? 4 : 3);
    const bool has_layers = in_turn_ || !has_centres(settings_); // otherwise they are there
    std::vector<Film::LayerMemory> layers;
    for (BatchArrays::Layer& layer : arrays.layers) {
        if (has_layers) layers.push_back({layer.group, layer.values.data() + first * layer.channels});
    }
    film.resolve_into(picture, settings_.transparent, layers, pixels);
    if (!has_layers || (settings_.aovs & kAovIds) == 0) return;
    pictures_.queue().copy_on_device(arrays.ids.data() + first, film.view().ids, pixels * sizeof(PixelIds));
}

} // namespace pertev
