// Steps after a picture's rendering (denoise/denoiser.h).

#include <vector>

#include <doctest/doctest.h>

#include "denoise/denoiser.h"

using namespace pertev;

namespace {

/// Changes each colour x to factor x + offset.
struct LinearStep final : Denoiser {
    LinearStep(float by, float with) : factor(by), offset(with) {}
    void begin(const NoisyFrame&, const CameraView&, const PixelWindow&) override {}
    uint32_t feature_samples() const override { return 0; }
    void add_features(const NoisyFrame&, const SceneView&) override {}
    void add(const NoisyFrame&, const SceneView&, uint32_t) override {}
    DenoiserState state() const override { return {}; }
    void restore(const DenoiserState&) override {}
    Image apply(Image picture) override {
        for (float& value : picture.pixels) value = factor * value + offset;
        return picture;
    }
    float factor, offset;
};

} // namespace

TEST_CASE("each post step gets the result of the previous step") {
    const Image picture{1, 1, 3, {1, 2, 4}};
    std::vector<std::unique_ptr<Denoiser>> steps;
    CHECK(apply_steps(steps, picture).pixels == picture.pixels);
    steps.push_back(std::make_unique<LinearStep>(3.0f, 0.0f));
    steps.push_back(std::make_unique<LinearStep>(1.0f, 5.0f));
    CHECK(apply_steps(steps, picture).pixels == std::vector<float>{8, 11, 17});
}
