#include "denoise/reconstruction.h"

#include "base/error.h"
#include "denoise/accumulate_signals.h"
#include "denoise/anti_alias.h"
#include "denoise/compose_picture.h"
#include "denoise/keep_layers.h"
#include "denoise/limit_history.h"
#include "denoise/split_signals.h"
#include "denoise/sum_blocks.h"
#include "denoise/wavelet_pass.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr std::size_t kOfHistory = 5, kOfSignals = 2; // arrays of Float4
constexpr std::size_t kNarrowArrays = 3;              // of Vec2: squares of both histories, places in the frame before
constexpr std::size_t kWideArrays = 2 * kOfHistory + 2 * kOfSignals;

} // namespace

Reconstruction::Reconstruction(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height), timer_(queue),
      wide_(queue, kWideArrays * width * height, "reconstruction"),
      narrow_(queue, kNarrowArrays * width * height, "reconstruction") {}

std::size_t Reconstruction::predicted_bytes(uint32_t width, uint32_t height) {
    return std::size_t(width) * height * (kWideArrays * sizeof(Float4) + kNarrowArrays * sizeof(Vec2));
}

HistoryView Reconstruction::history(uint32_t frame) const {
    const std::size_t pixels = std::size_t(width_) * height_, which = frame % 2;
    Float4* const wide = wide_.data() + which * kOfHistory * pixels;
    return {
        wide, wide + pixels, wide + 2 * pixels, narrow_.data() + which * pixels, wide + 3 * pixels, wide + 4 * pixels};
}

void Reconstruction::add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                         const PreviousScene& scene_before, const ReconstructionSettings& settings) {
    PERTEV_CHECK(frame.width() == width_ && frame.height() == height_);
    const uint32_t pixels = width_ * height_;
    const HistoryView now = history(frames_ + 1), before = history(frames_);
    const NoisyFrameView& noisy = frame.view();
    const bool has_history = frames_ > 0, has_gloss = frame.splits_light();
    const FrameCameras cameras = {camera, last_camera_, width_, height_};
    Float4* const signals = wide_.data() + 2 * kOfHistory * pixels;
    SignalsView a = {signals, signals + pixels},
                b = {signals + 2 * std::size_t(pixels), signals + 3 * std::size_t(pixels)};

    Vec2* const was_at = narrow_.data() + 2 * std::size_t(pixels);

    timer_.start();
    launch(*queue_, "split_signals", pixels, SplitSignals{noisy, a, now});
    launch(*queue_, "accumulate_signals", pixels,
           AccumulateSignals{noisy, a, scene, scene_before, cameras, now, before, was_at, settings.history,
                             settings.limit_fireflies, has_gloss, has_history});
    launch(*queue_, "limit_history", pixels, LimitHistory{now, b, width_, height_, settings.limit_history, has_gloss});
    if (settings.keep_layers) {
        if (layers_.size() != pixels) layers_ = {*queue_, pixels, "layers of the reconstruction"};
        launch(*queue_, "keep_layers", pixels,
               KeepLayers{was_at, b, width_, has_history, has_gloss, layers_.data()});
    }
    for (uint32_t pass = 0; pass < settings.passes; ++pass) {
        launch(*queue_, "wavelet_pass", pixels,
               WaveletPass{now.guide, b, a, camera, width_, height_, 1 << pass, has_gloss});
        std::swap(a, b);
    }
    Float4* const picture = settings.anti_alias ? a.diffuse : now.shown;
    launch(*queue_, "compose_picture", pixels, ComposePicture{noisy, b, picture});
    if (settings.anti_alias) {
        launch(*queue_, "anti_alias", pixels,
               AntiAlias{picture, was_at, before.shown, now.shown, width_, height_, has_history});
    }
    timer_.stop();
    last_camera_ = camera;
    ++frames_;
}

Image Reconstruction::picture() const {
    PERTEV_CHECK(frames_ > 0);
    const std::size_t pixels = std::size_t(width_) * height_;
    std::vector<Float4> shown(pixels);
    queue_->copy_to_host(shown.data(), history(frames_).shown, pixels * sizeof(Float4));
    Image image{width_, height_, 3, {}};
    image.pixels.reserve(3 * pixels);
    for (const Float4& p : shown) {
        const Rgb light = light_of_shown(rgb_of(p));
        image.pixels.insert(image.pixels.end(), {light.r, light.g, light.b});
    }
    return image;
}

FrameTones Reconstruction::tones(const NoisyFrame& frame) const {
    PERTEV_CHECK(frames_ > 0 && frame.width() == width_ && frame.height() == height_);
    const uint32_t side = block_side(width_, height_);
    const uint32_t columns = (width_ + side - 1) / side, rows = (height_ + side - 1) / side;
    const std::size_t row_sums = std::size_t(columns) * height_, blocks = std::size_t(columns) * rows;
    Float4* const room = wide_.data() + 2 * kOfHistory * std::size_t(width_) * height_; // signals' room: 4 a pixel
    const BlockSums sums = {room, room + row_sums}, means = {room + 2 * row_sums, room + 2 * row_sums + blocks};
    launch(*queue_, "sum_block_rows", static_cast<uint32_t>(row_sums),
           SumBlockRows{history(frames_).shown, frame.view(), width_, side, columns, sums});
    launch(*queue_, "mean_of_block_rows", static_cast<uint32_t>(blocks),
           MeanOfBlockRows{sums, height_, side, columns, means});
    std::vector<Float4> both(2 * blocks);
    queue_->copy_to_host(both.data(), means.scattered, both.size() * sizeof(Float4));
    FrameTones tones = {{columns, rows, 4, {}}, {columns, rows, 3, {}}};
    for (std::size_t i = 0; i < blocks; ++i) {
        const Float4 a = both[i], b = both[blocks + i];
        tones.scattered.pixels.insert(tones.scattered.pixels.end(), {a.x, a.y, a.z, a.w});
        tones.all.pixels.insert(tones.all.pixels.end(), {b.x, b.y, b.z});
    }
    return tones;
}

std::vector<Float4> Reconstruction::kept_layers() const {
    const std::size_t pixels = std::size_t(width_) * height_;
    PERTEV_CHECK(frames_ > 0 && layers_.size() == pixels);
    std::vector<Float4> layers(pixels);
    queue_->copy_to_host(layers.data(), layers_.data(), pixels * sizeof(Float4));
    return layers;
}

Image Reconstruction::motion() const {
    Image image{width_, height_, 2, {}};
    for (const Float4& p : kept_layers()) image.pixels.insert(image.pixels.end(), {p.x, p.y});
    return image;
}

Image Reconstruction::deviation() const {
    Image image{width_, height_, 1, {}};
    for (const Float4& p : kept_layers()) image.pixels.push_back(sqrt(p.z + p.w));
    return image;
}

const uint8_t* Reconstruction::display(ToneMap tone_map, float exposure_stops) {
    PERTEV_CHECK(frames_ > 0);
    const uint32_t pixels = width_ * height_;
    if (display_ == nullptr) display_ = queue_->make_host_copy(std::size_t(4) * pixels);
    auto* const bytes =
        reinterpret_cast<uint8_t*>(wide_.data() + 2 * kOfHistory * std::size_t(pixels)); // signals' room
    launch(*queue_, "show_picture", pixels,
           ShowPicture{history(frames_).shown, tone_map, exposure_scale(exposure_stops), bytes});
    display_->take(bytes);
    return static_cast<const uint8_t*>(queue_->wait(*display_));
}

} // namespace pertev
