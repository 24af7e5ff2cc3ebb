#include "denoise/picture_denoiser.h"

#include <algorithm>
#include <iterator>

#include "base/error.h"
#include "denoise/compose_samples.h"
#include "denoise/estimate_variance.h"
#include "denoise/even_pass.h"
#include "denoise/fade_filter.h"
#include "denoise/finish_sums.h"
#include "denoise/gather_mirrors.h"
#include "device/launch.h"

namespace pertev {
namespace {

// Pixels between taps. The last passes smooth the lattice that distant taps leave.
constexpr int kSteps[] = {1, 2, 4, 8, 16, 32, 4, 2, 1};
constexpr int kPicturePasses = static_cast<int>(std::size(kSteps));
constexpr float kPictureTolerance = 4; // EvenPass explains it
constexpr std::size_t kOfGuide = 4, kOfSums = 8 + 2 * kNeighbourSurfaces, kOfPictureSignals = 6,
                      kOfChain = 4; // numbers of arrays of Float4
constexpr std::size_t kWidePictureArrays = kOfGuide + kOfSums + kOfPictureSignals + kOfChain;

std::vector<Float4> colors_of(const Image& image) {
    std::vector<Float4> colors;
    for (const float* from = image.pixels.data(); colors.size() < std::size_t(image.width) * image.height;
         from += image.channels) {
        colors.push_back({from[0], from[1], from[2], 0});
    }
    return colors;
}

} // namespace

PictureDenoiser::PictureDenoiser(Queue& queue, uint32_t width, uint32_t height)
    : queue_(&queue), width_(width), height_(height),
      wide_(queue, (kWidePictureArrays + kOfMirrors) * width * height, "denoised picture"),
      exact_(queue, std::size_t(SampleSums::kArrays) * width * height, "sums of a denoised picture"),
      squares_(queue, std::size_t(2) * width * height, "denoised picture"),
      noise_(queue, std::size_t(width) * height, "denoised picture"),
      objects_(queue, std::size_t(width) * height, "denoised picture") {
    Float4* next = wide_.data();
    const auto take = [&](Float4*& array) {
        array = next;
        next += std::size_t(width) * height;
    };
    for (Float4** array :
         {&guide_.normal,     &guide_.albedo,       &smooth_,           &packed_,       &sums_.diffuse,
          &sums_.gloss,       &sums_.diffuse_share, &sums_.gloss_share, &sums_.normal,  &sums_.diffuse_color,
          &sums_.gloss_color, &sums_.emission,      &from_.diffuse,     &from_.gloss,   &to_.diffuse,
          &to_.gloss,         &mirrored_.diffuse,   &mirrored_.gloss,   &mirrors_.seen, &chain_.end,
          &chain_.normal,     &chain_.color,        &chain_.seen}) {
        take(*array);
    }
    for (MirrorBranch& branch : mirrors_.branches) {
        for (Float4** array : {&branch.end, &branch.normal, &branch.light, &branch.color, &branch.edge}) take(*array);
    }
    for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
        take(sums_.neighbour_diffuse[slot]);
        take(sums_.neighbour_gloss[slot]);
    }
    sums_.exact = {exact_.data(), width * height};
    sums_.squares = squares_.data();
    mirrors_.squares = squares_.data() + std::size_t(width) * height;
    guide_.object = objects_.data();
}

PictureDenoiser::PictureDenoiser(Queue& queue, uint32_t width, uint32_t height, uint32_t samples, uint32_t frames)
    : PictureDenoiser(queue, width, height) {
    history_.emplace(queue, width, height, samples, frames);
}

void PictureDenoiser::begin(const NoisyFrame& centres, const CameraView& camera, const PixelWindow& window) {
    PERTEV_CHECK(centres.width() == width_ && centres.height() == height_);
    launch(*queue_, "begin_sums", width_ * height_, BeginSums{centres.view(), guide_, sums_});
    launch(*queue_, "begin_mirrors", width_ * height_, BeginMirrors{mirrors_});
    camera_ = camera;
    window_ = window;
    has_gloss_ = centres.splits_light(), has_mirrors_ = false;
    features_ = 0;
    forget_samples();
}

void PictureDenoiser::forget_samples() {
    samples_ = 0;
    exact_.zero();
}

SampledSurfaces PictureDenoiser::surfaces_of(const NoisyFrame& frame, const SceneView& scene) const {
    PERTEV_CHECK(frame.width() == width_ && frame.height() == height_);
    return {frame.view(), guide_, sums_, scene.instances, scene.meshes, camera_, width_, height_};
}

void PictureDenoiser::follow(const NoisyFrame& centres, const SceneView& scene, const PreviousScene& before) {
    history_.value().follow(centres, guide_, camera_, scene, before);
}

void PictureDenoiser::add_features(const NoisyFrame& frame, const SceneView& scene) {
    launch_in(*queue_, "gather_features", window_, GatherFeatures{surfaces_of(frame, scene)});
    ++features_;
}

void PictureDenoiser::guide_mirrors(const NoisyFrame& frame) {
    PERTEV_CHECK(frame.view().mirrors.is_there());
    launch(*queue_, "guide_mirrors", width_ * height_, GuideMirrors{frame.view().mirrors, mirrors_});
    std::vector<Float4> normals(std::size_t(width_) * height_);
    for (const MirrorBranch& branch : mirrors_.branches) {
        if (has_mirrors_) return;
        queue_->copy_to_host(normals.data(), branch.normal, normals.size() * sizeof(Float4));
        has_mirrors_ = std::ranges::any_of(normals, [](Float4 normal) { return bits_of(normal.w) >= 2; });
    }
}

void PictureDenoiser::add_mirrors(const NoisyFrame& frame, const SceneView& scene) {
    PERTEV_CHECK(frame.view().mirrors.is_there());
    launch_in(*queue_, "gather_mirrors", window_, GatherMirrors{surfaces_of(frame, scene), mirrors_});
}

void PictureDenoiser::add(const NoisyFrame& frame, const SceneView& scene, uint32_t sample) {
    PERTEV_CHECK(features_ > std::min(sample, kFeatures - 1));
    launch_in(*queue_, "gather_light", window_,
              GatherLight{surfaces_of(frame, scene), mirrors_if_gloss(), sample >= kFeatures});
    ++samples_;
}

/// Returns the arrays that accumulate over samples; the sums are last.
std::vector<PixelWords> PictureDenoiser::gathered() const {
    std::vector<PixelWords> arrays;
    for (Float4* const array :
         {guide_.normal, guide_.albedo, sums_.normal, sums_.emission, sums_.diffuse_color, sums_.gloss_color}) {
        arrays.push_back({array, 4});
    }
    for (int slot = 0; slot < kNeighbourSurfaces; ++slot) {
        arrays.push_back({sums_.neighbour_diffuse[slot], 4});
        arrays.push_back({sums_.neighbour_gloss[slot], 4});
    }
    for (const MirrorBranch& branch : mirrors_.branches) {
        for (Float4* const array : {branch.end, branch.normal, branch.color, branch.edge}) arrays.push_back({array, 4});
    }
    arrays.push_back({mirrors_.seen, 4});
    arrays.push_back({guide_.object, 1});
    for (uint32_t i = 0; i < SampleSums::kArrays; ++i) arrays.push_back({&sums_.exact.at(i, 0), 2});
    return arrays;
}

DenoiserState PictureDenoiser::state() const {
    const std::size_t pixels = std::size_t(width_) * height_;
    const DenoiserStateSize size = state_size(pixels);
    DenoiserState words(size.words, kMissingWord);
    std::fill(words.end() - static_cast<std::ptrdiff_t>(size.sums), words.end(), 0u);
    DenoiserHead{std::min(samples_, 1u), features_, has_gloss_, camera_}.write(words); // equal in all parts
    save_pixels(*queue_, gathered(), pixels, std::size_t(window_.y) * width_, window_.count(),
                std::span(words).subspan(DenoiserHead::kWords));
    return words;
}

void PictureDenoiser::restore(const DenoiserState& state) {
    const std::size_t pixels = std::size_t(width_) * height_;
    const DenoiserHead head = DenoiserHead::read(state);
    bool is_sound = state.size() == state_size(pixels).words && head.features == kFeatures;
    const auto check = [&](std::size_t array) { // the array has numbers of pixels that are looked up
        for (std::size_t i = 0; is_sound && i < pixels; ++i) {
            const uint32_t there = state[DenoiserHead::kWords + 4 * (pixels * array + i) + 3];
            is_sound = there == kNoHit || there < pixels;
        }
    };
    constexpr std::size_t kFirstSlot = 6, kFirstBranch = kFirstSlot + 2 * kNeighbourSurfaces; // in gathered()
    for (std::size_t slot = 0; slot < kNeighbourSurfaces; ++slot) check(kFirstSlot + 2 * slot);
    for (std::size_t k = 1; k <= MirrorSums::kBranches; ++k) check(kFirstBranch + k * (MirrorSums::kArrays - 1) - 1);
    if (!is_sound) throw Error(ErrorCode::BadInput, "what the denoiser has gathered is damaged");
    // Between begin() and here other rows have guides, which the window's border needs.
    const bool is_part = window_.count() > 0;
    restore_pixels(*queue_, gathered(), pixels, is_part ? std::size_t(window_.y) * width_ : 0,
                   is_part ? window_.count() : pixels, std::span(state).subspan(DenoiserHead::kWords));
    samples_ = head.samples, features_ = head.features, has_gloss_ = has_mirrors_ = head.has_gloss;
    const LensView lens = camera_.lens; // is not in the head
    camera_ = head.camera;
    camera_.lens = lens;
}

/// Filters the signals of mirrors into mirrored_, and adds their noise; `other` is free.
void PictureDenoiser::filter_mirrors(SignalsView other) {
    const uint32_t pixels = width_ * height_;
    launch(*queue_, "estimate_mirror_variance", pixels,
           EstimateMirrorVariance{guide_, sums_, mirrors_, other, width_, height_});
    if (!history_) {
        launch(*queue_, "gather_mirror_noise", pixels,
               GatherMirrorNoise{sums_, mirrors_, other, static_cast<float>(features_), noise_.data()});
    }
    launch(*queue_, "fade_signals", pixels, FadeSignals{other, true});
    SignalsView from = other, to = mirrored_;
    for (int pass = 0; pass < kPicturePasses; ++pass) {
        launch(*queue_, "mirror_pass", pixels,
               MirrorPass{guide_, mirrors_, from, to, camera_, width_, height_, kSteps[pass], kPictureTolerance});
        std::swap(from, to);
    }
    static_assert(kPicturePasses % 2 == 1, "the last pass writes mirrored_");
}

Image PictureDenoiser::apply(Image picture) {
    PERTEV_CHECK(samples_ > 0 && picture.width == width_ && picture.height == height_);
    const uint32_t pixels = width_ * height_;
    SignalsView from = from_, to = to_;
    const PictureGuide smooth = {smooth_, guide_.albedo, guide_.object};
    launch(*queue_, "finish_sums", pixels, FinishSums{sums_, mirrors_if_gloss()});
    launch(*queue_, "smooth_guide", pixels, SmoothGuide{guide_, sums_, smooth_, packed_});
    launch(
        *queue_, "estimate_variance", pixels,
        EstimateVariance{smooth, sums_, from, history_ ? history_->of_sample() : nullptr, width_, height_, has_gloss_});
    if (history_) history_->mix(sums_, from, packed_, to, has_gloss_, camera_);
    const auto first_features = static_cast<float>(features_);
    if (!history_) {
        launch(*queue_, "gather_noise", pixels, GatherNoise{sums_, from, first_features, has_gloss_, noise_.data()});
    }
    launch(*queue_, "fade_signals", pixels, FadeSignals{from, has_gloss_});
    for (int pass = 0; pass < kPicturePasses; ++pass) {
        launch(*queue_, "even_pass", pixels,
               EvenPass{packed_, from, to, camera_, width_, height_, kSteps[pass], kPictureTolerance, has_gloss_});
        std::swap(from, to);
    }
    if (mirrors_if_gloss().is_there()) filter_mirrors(to);
    launch(*queue_, "compose_samples", pixels,
           ComposeSamples{sums_, from, mirrors_if_gloss(), mirrored_, first_features, has_gloss_, to.diffuse});
    std::vector<Float4> shown = colors_of(picture);
    if (!history_) { // with one, the light is of more samples than the mean
        queue_->copy_to_device(to.gloss, shown.data(), pixels * sizeof(Float4));
        launch(*queue_, "mix_mean", pixels, MixMean{sums_, to.gloss, noise_.data(), to.diffuse});
    }
    queue_->copy_to_host(shown.data(), to.diffuse, pixels * sizeof(Float4));
    return with_colors(std::move(picture), shown);
}

} // namespace pertev
