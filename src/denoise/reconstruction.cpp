#include "denoise/reconstruction.h"

#include <algorithm>

#include "base/error.h"
#include "denoise/accumulate_signals.h"
#include "denoise/anti_alias.h"
#include "denoise/clamp_history.h"
#include "denoise/compose_picture.h"
#include "denoise/keep_layers.h"
#include "denoise/split_signals.h"
#include "denoise/sum_blocks.h"
#include "denoise/wavelet_pass.h"
#include "device/launch.h"

namespace pertev {
namespace {

constexpr std::size_t kOfHistory = 5, kOfSignals = 2; // numbers of arrays of Float4

/// Number of Float4 of a reconstruction: both histories, then signals, twice. Data of temporal gradients uses the
/// memory of the signals before these are written, its numbers at the end, after the first ones; only in tiny
/// pictures does it need more.
std::size_t wide_count(uint32_t width, uint32_t height) {
    const std::size_t pixels = std::size_t(width) * height, small = TemporalGradientsMemory::pixels(width, height);
    return 2 * kOfHistory * pixels +
           std::max({2 * kOfSignals * pixels, kOfSignals * pixels + TemporalGradientsMemory::kNumbers * small,
                     (TemporalGradientsMemory::kPicture + TemporalGradientsMemory::kNumbers) * small});
}

/// Number of Vec2: squares of both histories, then positions in the previous frame, or between frames the small
/// picture of the scene as it was.
std::size_t narrow_count(uint32_t width, uint32_t height) {
    const std::size_t pixels = std::size_t(width) * height;
    return 2 * pixels +
           std::max(pixels, 2 * TemporalGradientsMemory::kPicture * TemporalGradientsMemory::pixels(width, height));
}

constexpr float kTolerance = 8, kMinTrust = 0.125f; // parameters of WaveletPass

/// Returns whether the light of a point may be another than in the previous frame.
bool may_change(const SceneView& scene, const PreviousScene& before, const TemporalGradientsView& change) {
    return change.guide != nullptr || before.instances != scene.instances || before.meshes != scene.meshes;
}

} // namespace

Reconstruction::Reconstruction(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height), timer_(queue), copy_timer_(queue),
      wide_(queue, wide_count(width, height), "reconstruction"),
      narrow_(queue, narrow_count(width, height), "reconstruction") {}

TemporalGradientsMemory Reconstruction::gradients_memory() const {
    Float4* const signals = wide_.data() + 2 * kOfHistory * std::size_t(width_) * height_;
    return {reinterpret_cast<Float4*>(positions_before()), signals,
            wide_.data() + wide_.size() -
                TemporalGradientsMemory::kNumbers * TemporalGradientsMemory::pixels(width_, height_)};
}

HistoryView Reconstruction::history(uint32_t frame) const {
    const std::size_t pixels = std::size_t(width_) * height_, which = frame % 2;
    Float4* const wide = wide_.data() + which * kOfHistory * pixels;
    return {
        wide, wide + pixels, wide + 2 * pixels, narrow_.data() + which * pixels, wide + 3 * pixels, wide + 4 * pixels};
}

/// Computes the filtered light of some rows of the frame; `memory` is a free array of the picture's size.
SignalsView Reconstruction::filter(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                                   const PreviousScene& scene_before, const TemporalGradientsView& change,
                                   const ReconstructionSettings& settings, RowBand rows, Float4*& memory) {
    PERTEV_CHECK(frame.width() == width_ && frame.height() == height_);
    const uint32_t pixels = width_ * height_;
    // Each stage makes the rows that the next ones read.
    const uint32_t reach = (1u << settings.passes) - 1; // rows that all passes together read beside a pixel's
    const RowBand of_clamped = rows.grown(reach, height_), of_means = of_clamped.grown(ClampHistory::kReach, height_),
                  of_samples = of_means.grown(AccumulateSignals<false>::kReach, height_);
    if (others_ != nullptr) others_->take(frame.rows(), of_samples);
    const HistoryView now = history(frames_ + 1), before = history(frames_);
    const NoisyFrameView& noisy = frame.view();
    const bool has_history = frames_ > 0, has_gloss = frame.splits_light();
    const FrameCameras cameras = {camera, last_camera_, width_, height_};
    Float4* const signals = wide_.data() + 2 * kOfHistory * pixels;
    SignalsView a = {signals, signals + pixels},
                b = {signals + 2 * std::size_t(pixels), signals + 3 * std::size_t(pixels)};

    instead_ = nullptr;
    has_gloss_ = has_gloss;
    launch_in_band(*queue_, "split_signals", of_samples, width_, SplitSignals{noisy, a, now, change.guide != nullptr});
    const auto accumulate = [&]<bool kFollows>() {
        launch(*queue_, "accumulate_signals", of_means.count() * width_,
               AccumulateSignals<kFollows>{noisy, a, scene, scene_before, cameras, now, before, change,
                                           positions_before(), settings.history, settings.clamp_fireflies, has_gloss,
                                           has_history, of_means});
    };
    if (change.guide != nullptr) {
        accumulate.operator()<true>();
    } else {
        accumulate.operator()<false>();
    }
    launch(*queue_, "clamp_history", of_clamped.count() * width_,
           ClampHistory{now, b, width_, height_, settings.clamp_history, has_gloss, of_clamped});
    keeps_layers_ = settings.keep_layers;
    if (settings.keep_layers) {
        if (layers_.size() != pixels) layers_ = {*queue_, pixels, "layers of the reconstruction"};
        launch_in_band(*queue_, "keep_layers", rows, width_,
                       KeepLayers{positions_before(), b, width_, has_history, has_gloss, layers_.data()});
    }
    for (uint32_t pass = 0; pass < settings.passes; ++pass) {
        const RowBand of_pass = rows.grown(reach + 1 - (2u << pass), height_);
        launch(*queue_, "wavelet_pass", of_pass.count() * width_,
               WaveletPass{now.guide, b, a, camera, width_, height_, 1 << pass, kTolerance, kMinTrust, has_gloss,
                           of_pass});
        std::swap(a, b);
    }
    memory = a.diffuse;
    return b;
}

SteadyLight Reconstruction::steady_light(const HistoryView& now, bool may_change,
                                         const ReconstructionSettings& settings) const {
    constexpr uint32_t kLeast = 8; // frames in which emitters smaller than a pixel have been seen
    const uint32_t frames = may_change ? std::max(settings.history * 3 / 4, kLeast) : kLeast;
    return {now.diffuse, now.guide, width_, height_, frames, may_change};
}

void Reconstruction::add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                         const PreviousScene& scene_before, const TemporalGradientsView& change,
                         const ReconstructionSettings& settings) {
    if (upsampled_) cut();
    upsampled_.reset();
    const RowBand own = own_rows(others_, height_);
    const RowBand of_picture = own.grown(settings.anti_alias ? AntiAlias::kReach : 0, height_);
    const HistoryView now = history(frames_ + 1);
    timer_.start();
    Float4* memory = nullptr;
    const SignalsView light = filter(frame, camera, scene, scene_before, change, settings, of_picture, memory);
    Float4* const picture = settings.anti_alias ? memory : now.shown;
    launch_in_band(*queue_, "compose_picture", of_picture, width_, ComposePicture{frame.view(), light, picture});
    if (settings.anti_alias) {
        launch(*queue_, "anti_alias", own.count() * width_,
               AntiAlias{picture, frame.view().emission, positions_before(), history(frames_).shown, now.shown, width_,
                         height_, frames_ > 0, steady_light(now, may_change(scene, scene_before, change), settings),
                         own});
    }
    timer_.stop();
    last_camera_ = camera;
    ++frames_;
}

void Reconstruction::add_upsampled(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame& features,
                                   const CameraView& camera, const SceneView& scene, const PreviousScene& scene_before,
                                   const TemporalGradientsView& change, const ReconstructionSettings& settings) {
    if (!upsampled_ || upsampled_->width() != features.width() || upsampled_->height() != features.height()) {
        cut();
        upsampled_.reset(); // freed before the new one, so that both need not fit
        upsampled_.emplace(*queue_, features.width(), features.height());
    }
    const HistoryView now = history(frames_ + 1);
    timer_.start();
    Float4* memory = nullptr;
    const SignalsView light = filter(frame, light_camera, scene, scene_before, change, settings,
                                     upsampled_->rows_of_light(others_, height_), memory);
    upsampled_->add(features, camera, {light, now.guide, light_camera, width_, height_, frame.splits_light()},
                    steady_light(now, may_change(scene, scene_before, change), settings), scene, scene_before, settings,
                    frames_ > 0, others_);
    timer_.stop();
    last_camera_ = light_camera;
    ++frames_;
}

void Reconstruction::begin_after(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame* features,
                                 const CameraView& camera) {
    upsampled_.reset();
    if (features != nullptr) upsampled_.emplace(*queue_, features->width(), features->height()).begin_after(camera);
    has_gloss_ = frame.splits_light();
    last_camera_ = light_camera;
    frames_ = 1;
}

std::vector<RowArray> Reconstruction::rows_of_history() const {
    if (frames_ == 0) return {};
    const HistoryView last = history(frames_);
    const std::size_t wide = width_ * sizeof(Float4);
    std::vector<RowArray> arrays = {{last.guide, wide, height_},
                                    {last.diffuse, wide, height_},
                                    {last.squares, width_ * sizeof(Vec2), height_},
                                    {last.recent, wide, height_}};
    if (has_gloss_) arrays.push_back({last.gloss, wide, height_});
    arrays.push_back(rows_of_result().front());
    return arrays;
}

std::vector<RowArray> Reconstruction::rows_of_result() const {
    Float4* const picture = upsampled_ ? upsampled_->shown() : history(frames_).shown;
    std::vector<RowArray> arrays = {{picture, shown_width() * sizeof(Float4), shown_height()}};
    if (keeps_layers_) arrays.push_back({layers_.data(), width_ * sizeof(Float4), height_});
    return arrays;
}

const Float4* Reconstruction::shown() const {
    PERTEV_CHECK(frames_ > 0);
    return upsampled_ ? upsampled_->shown() : history(frames_).shown;
}

std::optional<Image> Reconstruction::shown_instead() const {
    if (instead_ == nullptr) return std::nullopt;
    return image_of(instead_);
}

Image Reconstruction::image_of(const Float4* picture) const {
    const std::size_t pixels = std::size_t(shown_width()) * shown_height();
    std::vector<Float4> colors(pixels);
    queue_->copy_to_host(colors.data(), picture, pixels * sizeof(Float4));
    Image image{shown_width(), shown_height(), 3, {}};
    image.pixels.reserve(3 * pixels);
    for (const Float4& p : colors) {
        const Rgb light = light_of_shown(rgb_of(p));
        image.pixels.insert(image.pixels.end(), {light.r, light.g, light.b});
    }
    return image;
}

FrameTones Reconstruction::tones(const NoisyFrame& frame) const {
    const uint32_t width = shown_width(), height = shown_height();
    PERTEV_CHECK(frames_ > 0 && frame.width() == width && frame.height() == height);
    const uint32_t side = block_side(width, height);
    const uint32_t columns = block_columns(width, side), rows = (height + side - 1) / side;
    const std::size_t row_sums = std::size_t(columns) * height, blocks = std::size_t(columns) * rows;
    Float4* const signals = wide_.data() + 2 * kOfHistory * std::size_t(width_) * height_; // 4 per pixel
    Float4* const memory = upsampled_ ? upsampled_->tone_memory() : signals;
    const BlockSums sums = {memory, memory + row_sums}, means = {memory + 2 * row_sums, memory + 2 * row_sums + blocks};
    launch(*queue_, "sum_block_rows", static_cast<uint32_t>(row_sums),
           SumBlockRows{shown(), frame.view(), width, side, columns, sums});
    launch(*queue_, "mean_of_block_rows", static_cast<uint32_t>(blocks),
           MeanOfBlockRows{sums, height, side, columns, means});
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

void Reconstruction::display(ToneMap tone_map, float exposure_stops) {
    const uint32_t pixels = shown_width() * shown_height();
    const std::size_t size = std::size_t(4) * pixels;
    if (display_ == nullptr || display_bytes_ != size) display_ = queue_->make_host_copy(size);
    display_bytes_ = size;
    auto* const signals = reinterpret_cast<uint8_t*>(wide_.data() + 2 * kOfHistory * std::size_t(width_) * height_);
    uint8_t* const bytes = upsampled_ ? upsampled_->byte_memory() : signals;
    launch(*queue_, "show_picture", pixels,
           ShowPicture{instead_ != nullptr ? instead_ : shown(), tone_map, exposure_scale(exposure_stops), bytes});
    copy_timer_.start();
    display_->take(bytes);
    copy_timer_.stop();
    queue_->wait(*display_);
}

Rgba8Image Reconstruction::displayed() const {
    PERTEV_CHECK(display_ != nullptr);
    const auto* const bytes = static_cast<const uint8_t*>(queue_->wait(*display_));
    return {shown_width(), shown_height(), {bytes, bytes + display_bytes_}};
}

} // namespace pertev
