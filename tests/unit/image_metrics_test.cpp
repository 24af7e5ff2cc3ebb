#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/metrics.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Image filled(uint32_t width, uint32_t height, float value) {
    return {width, height, 3, std::vector<float>(std::size_t(width) * height * 3, value)};
}

VarianceOfPictures variance_of(const std::vector<Image>& pictures) {
    VarianceOfPictures variance;
    for (const Image& picture : pictures) variance.add(picture);
    return variance;
}

} // namespace

TEST_CASE("errors of a picture against itself are zero") {
    const Image image = filled(10, 5, 0.3f);
    CHECK(relative_error(image, image).rel_mse == 0);
    CHECK(mean_squared_error(image, image) == 0);
}

TEST_CASE("relMSE and MSE of a uniform difference match their formulas") {
    const Image x = filled(10, 10, 0.75f), r = filled(10, 10, 0.25f);
    CHECK(relative_error(x, r).rel_mse == doctest::Approx(0.25 / (0.0625 + 0.01)).epsilon(1e-12));
    CHECK(mean_squared_error(x, r) == 0.25);
    CHECK(relative_error(x, r).mean[1] == 0.75);
    CHECK(relative_error(x, r).reference_mean[2] == 0.25);
}

TEST_CASE("the trimmed relMSE leaves out exactly the requested share of worst pixels, also from its means") {
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

TEST_CASE("pictures of different sizes are an error that names both") {
    const auto error = test::thrown_error([] { relative_error(filled(4, 3, 0), filled(3, 4, 0)); });
    REQUIRE(error);
    CHECK(error->code() == ErrorCode::BadInput);
    CHECK(test::says(error, "4 x 3 and 3 x 4"));
}

TEST_CASE("the variance of pictures is the unbiased variance of each channel over its squared mean") {
    const VarianceOfPictures same = variance_of({filled(4, 3, 0.3f), filled(4, 3, 0.3f), filled(4, 3, 0.3f)});
    CHECK(same.over(same.best_pixels(1)).rel_mse == 0);

    // The mean of 0.25, 0.5, 0.75 is 0.5 and the variance 1/16.
    const VarianceOfPictures spread = variance_of({filled(4, 3, 0.25f), filled(4, 3, 0.75f), filled(4, 3, 0.5f)});
    const TrimmedVariance all = spread.over(spread.best_pixels(1));
    CHECK(spread.best_pixels(1).size() == 12);
    CHECK(all.rel_mse == doctest::Approx(0.0625 / (0.25 + 0.01)).epsilon(1e-12));
    CHECK(all.mean == doctest::Approx(0.5).epsilon(1e-12));

    // If only one channel varies, the figure is a third of that channel's. Alpha is ignored.
    const VarianceOfPictures green = variance_of({Image{1, 1, 4, {1, 2, 3, 0}}, Image{1, 1, 4, {1, 4, 3, 1}}});
    CHECK(green.over({0}).rel_mse == doctest::Approx(2 / (9 + 0.01) / 3).epsilon(1e-12));
    CHECK(green.over({0}).mean == doctest::Approx(7.0 / 3).epsilon(1e-12));
}

TEST_CASE("the variance of pictures keeps its digits where they are bright and differ little") {
    const float next = std::nextafter(4096.0f, 5000.0f); // 2^-11 above
    const VarianceOfPictures variance = variance_of({filled(1, 1, 4096), filled(1, 1, next)});
    const double mean = 4096 + std::ldexp(1.0, -12);
    CHECK(variance.over({0}).rel_mse == doctest::Approx(std::ldexp(1.0, -23) / (mean * mean + 0.01)).epsilon(1e-12));
}

TEST_CASE("the best pixels are those that vary least, and the variance of others can be requested") {
    Image low = filled(10, 10, 1), high = filled(10, 10, 1);
    for (uint32_t x = 0; x < 10; ++x) { // row 2 varies, most at its right end
        low.at(x, 2)[0] = 1 - 0.01f * static_cast<float>(x + 1);
        high.at(x, 2)[0] = 1 + 0.01f * static_cast<float>(x + 1);
    }
    const VarianceOfPictures variance = variance_of({low, high});
    const std::vector<std::size_t> best = variance.best_pixels(0.92);
    REQUIRE(best.size() == 92);
    CHECK(best[89] == 99);
    CHECK(best[90] == 20);
    CHECK(best[91] == 21);
    CHECK(variance.over(variance.best_pixels(0.9)).rel_mse == 0);
    CHECK(variance.over({25}).rel_mse == doctest::Approx(2 * 0.06 * 0.06 / 1.01 / 3).epsilon(1e-5));
    CHECK(variance.over({0, 25}).rel_mse == doctest::Approx(0.06 * 0.06 / 1.01 / 3).epsilon(1e-5));
    CHECK(variance.best_pixels(1e-9).size() == 1);
}

TEST_CASE("a pixel with a value that is not finite in any picture varies most") {
    for (const float value : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (std::size_t bad = 0; bad < 3; ++bad) {
            CAPTURE(value);
            CAPTURE(bad);
            std::vector<Image> pictures = {filled(10, 10, 1), filled(10, 10, 1), filled(10, 10, 1)};
            pictures[bad].at(3, 4)[1] = value;
            const VarianceOfPictures variance = variance_of(pictures);
            CHECK(variance.best_pixels(1).back() == 43);
            CHECK(std::isinf(variance.over(variance.best_pixels(1)).rel_mse));
            CHECK(variance.over(variance.best_pixels(0.99)).rel_mse == 0);
            CHECK(variance.over(variance.best_pixels(0.99)).mean == doctest::Approx(1).epsilon(1e-12));
        }
    }
}

TEST_CASE("the variance of pictures of different sizes is an error that names both") {
    VarianceOfPictures variance;
    variance.add(filled(4, 3, 0));
    const auto error = test::thrown_error([&] { variance.add(filled(3, 4, 0)); }); // the number of pixels is equal
    REQUIRE(error);
    CHECK(error->code() == ErrorCode::BadInput);
    CHECK(test::says(error, "3 x 4 and 4 x 3"));
}
