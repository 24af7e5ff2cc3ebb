#include "denoise/reconstruction.h"

#include "base/error.h"
#include "denoise/accumulate_signals.h"
#include "denoise/anti_alias.h"
#include "denoise/compose_picture.h"
#include "denoise/limit_history.h"
#include "denoise/split_signals.h"
#include "denoise/wavelet_pass.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr std::size_t kOfHistory = 5, kOfSignals = 2; // arrays of Float4
constexpr std::size_t kWideArrays = 2 * kOfHistory + 2 * kOfSignals;

} // namespace

Reconstruction::Reconstruction(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height), timer_(queue),
      wide_(queue, kWideArrays * width * height, "reconstruction"),
      squares_(queue, std::size_t(2) * width * height, "reconstruction"),
      objects_(queue, std::size_t(2) * width * height, "reconstruction") {}

std::size_t Reconstruction::predicted_bytes(uint32_t width, uint32_t height) {
    return std::size_t(width) * height * (kWideArrays * sizeof(Float4) + 2 * (sizeof(Vec2) + sizeof(uint32_t)));
}

HistoryView Reconstruction::history(uint32_t frame) const {
    const std::size_t pixels = std::size_t(width_) * height_, which = frame % 2;
    Float4* const wide = wide_.data() + which * kOfHistory * pixels;
    return {wide,
            objects_.data() + which * pixels,
            wide + pixels,
            wide + 2 * pixels,
            squares_.data() + which * pixels,
            wide + 3 * pixels,
            wide + 4 * pixels};
}

/// Light of the frame, filtered; `room`: a picture's array that is free.
SignalsView Reconstruction::filter(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                                   const PreviousScene& scene_before, const ReconstructionSettings& settings,
                                   Float4*& room) {
    PERTEV_CHECK(frame.width() == width_ && frame.height() == height_);
    const uint32_t pixels = width_ * height_;
    const HistoryView now = history(frames_ + 1), before = history(frames_);
    const NoisyFrameView& noisy = frame.view();
    const bool has_history = frames_ > 0, has_gloss = frame.splits_light();
    const FrameCameras cameras = {camera, last_camera_, width_, height_};
    Float4* const signals = wide_.data() + 2 * kOfHistory * pixels;
    SignalsView a = {signals, signals + pixels},
                b = {signals + 2 * std::size_t(pixels), signals + 3 * std::size_t(pixels)};

    launch(*queue_, "split_signals", pixels, SplitSignals{noisy, a, now});
    launch(*queue_, "accumulate_signals", pixels,
           AccumulateSignals{noisy, a, scene, scene_before, cameras, now, before, settings.history,
                             settings.limit_fireflies, has_history});
    launch(*queue_, "limit_history", pixels, LimitHistory{now, b, width_, height_, settings.limit_history});
    for (uint32_t pass = 0; pass < settings.passes; ++pass) {
        launch(*queue_, "wavelet_pass", pixels,
               WaveletPass{now.normal, now.object, noisy.albedo, b, a, camera, width_, height_, 1 << pass, has_gloss});
        std::swap(a, b);
    }
    room = a.diffuse;
    return b;
}

void Reconstruction::add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                         const PreviousScene& scene_before, const ReconstructionSettings& settings) {
    if (enlarged_) cut();
    enlarged_.reset();
    const uint32_t pixels = width_ * height_;
    const HistoryView now = history(frames_ + 1);
    timer_.start();
    Float4* room = nullptr;
    const SignalsView light = filter(frame, camera, scene, scene_before, settings, room);
    Float4* const picture = settings.anti_alias ? room : now.shown;
    launch(*queue_, "compose_picture", pixels, ComposePicture{frame.view(), light, picture});
    if (settings.anti_alias) {
        launch(*queue_, "anti_alias", pixels,
               AntiAlias{frame.view(),
                         picture,
                         scene,
                         scene_before,
                         {camera, last_camera_, width_, height_},
                         now,
                         history(frames_),
                         frames_ > 0});
    }
    timer_.stop();
    last_camera_ = camera;
    ++frames_;
}

void Reconstruction::add_enlarged(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame& features,
                                  const CameraView& camera, const SceneView& scene, const PreviousScene& scene_before,
                                  const ReconstructionSettings& settings) {
    if (!enlarged_ || enlarged_->width() != features.width() || enlarged_->height() != features.height()) {
        cut();
        enlarged_.reset(); // before the new one, so that both need not fit
        enlarged_.emplace(*queue_, features.width(), features.height());
    }
    const HistoryView now = history(frames_ + 1);
    timer_.start();
    Float4* room = nullptr;
    const SignalsView light = filter(frame, light_camera, scene, scene_before, settings, room);
    enlarged_->add(features, camera,
                   {light, now.normal, now.object, light_camera, width_, height_, frame.splits_light()}, scene,
                   scene_before, settings, frames_ > 0);
    timer_.stop();
    last_camera_ = light_camera;
    ++frames_;
}

const Float4* Reconstruction::shown() const {
    PERTEV_CHECK(frames_ > 0);
    return enlarged_ ? enlarged_->shown() : history(frames_).shown;
}

Image Reconstruction::picture() const {
    const std::size_t pixels = std::size_t(shown_width()) * shown_height();
    std::vector<Float4> colors(pixels);
    queue_->copy_to_host(colors.data(), shown(), pixels * sizeof(Float4));
    Image image{shown_width(), shown_height(), 3, {}};
    image.pixels.reserve(3 * pixels);
    for (const Float4& p : colors) image.pixels.insert(image.pixels.end(), {p.x, p.y, p.z});
    return image;
}

Rgba8Image Reconstruction::display(ToneMap tone_map, float exposure_stops) const {
    const uint32_t pixels = shown_width() * shown_height();
    auto* const signals = reinterpret_cast<uint8_t*>(wide_.data() + 2 * kOfHistory * std::size_t(width_) * height_);
    uint8_t* const bytes = enlarged_ ? enlarged_->room_for_bytes() : signals;
    launch(*queue_, "show_picture", pixels, ShowPicture{shown(), tone_map, exposure_scale(exposure_stops), bytes});
    Rgba8Image image{shown_width(), shown_height(), {}};
    image.pixels.resize(std::size_t(pixels) * 4);
    queue_->copy_to_host(image.pixels.data(), bytes, image.pixels.size());
    return image;
}

} // namespace pertev
