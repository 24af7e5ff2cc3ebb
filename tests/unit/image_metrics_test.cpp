#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "image/metrics.h"

using namespace pertev;

namespace {

Image filled(uint32_t width, uint32_t height, float value) {
    return {width, height, 3, std::vector<float>(std::size_t(width) * height * 3, value)};
}

} // namespace

TEST_CASE("errors of a picture against itself are zero and its PSNR is infinite") {
    const Image image = filled(10, 5, 0.3f);
    CHECK(relative_error(image, image).rel_mse == 0);
    CHECK(mean_squared_error(image, image) == 0);
    CHECK(std::isinf(peak_signal_to_noise(0)));
}

TEST_CASE("relMSE, MSE and PSNR of a uniform difference are their formulas") {
    const Image x = filled(10, 10, 0.75f), r = filled(10, 10, 0.25f);
    CHECK(relative_error(x, r).rel_mse == doctest::Approx(0.25 / (0.0625 + 0.01)).epsilon(1e-12));
    CHECK(mean_squared_error(x, r) == 0.25);
    CHECK(peak_signal_to_noise(0.25) == doctest::Approx(6.020599913).epsilon(1e-6));
    CHECK(peak_signal_to_noise(0.25, 2) == doctest::Approx(12.041199827).epsilon(1e-6));
    CHECK(peak_signal_to_noise(1e-60) == doctest::Approx(600).epsilon(1e-6));
    CHECK(relative_error(x, r).mean[1] == 0.75);
    CHECK(relative_error(x, r).reference_mean[2] == 0.25);
}

TEST_CASE("the trimmed relMSE leaves the worst pixels out, of its means as well, and no more than asked for") {
    const Image r = filled(10, 10, 1);
    Image x = filled(10, 10, 1);
    x.at(3, 4)[0] = 1e6f;
    x.at(7, 7)[2] = std::numeric_limits<float>::quiet_NaN();
    const TrimmedError trimmed = relative_error(x, r, 0.98);
    CHECK(trimmed.pixels == 98);
    CHECK(trimmed.rel_mse == 0);
    CHECK(trimmed.mean[0] == 1);
    CHECK(trimmed.mean[2] == 1);
    CHECK(relative_error(x, r, 0.99).rel_mse == doctest::Approx(1e12 / 1.01 / 3 / 99).epsilon(1e-5));
    CHECK(std::isinf(relative_error(x, r, 1).rel_mse));
    CHECK(std::isinf(mean_squared_error(x, r)));
}

TEST_CASE("alpha is not compared") {
    const Image r{1, 1, 4, {1, 2, 3, 0}}, x{1, 1, 3, {1, 2, 3}};
    CHECK(relative_error(x, r, 1).rel_mse == 0);
}

TEST_CASE("pictures of different sizes are an error that tells both") {
    try {
        relative_error(filled(4, 3, 0), filled(3, 4, 0));
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        CHECK(std::string(error.what()).find("4 x 3 and 3 x 4") != std::string::npos);
    }
}
