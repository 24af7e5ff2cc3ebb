// Bsdf::specular returns the mean of what sample() draws of the delta lobes along their two directions.

#include <doctest/doctest.h>

#include <initializer_list>

#include "shading/make_reflection.h"

using namespace pertev;

namespace {

struct Drawn {
    double mirror = 0, refraction = 0; // red channel
};

Drawn mean_of_draws(const Bsdf& bsdf, Vec3 wo) {
    constexpr int kDraws = 1 << 14;
    Drawn sum;
    for (int i = 0; i < kDraws; ++i) {
        const float lobe = (static_cast<float>(i) + 0.5f) / kDraws;
        const BsdfSample sample = bsdf.sample(wo, lobe, {0.3f, 0.6f});
        if (!(sample.pdf > 0) || !sample.is_delta()) continue;
        (sample.is_transmission ? sum.refraction : sum.mirror) += static_cast<double>(sample.weight.r) / kDraws;
    }
    return sum;
}

void check(const char* name, const Bsdf& bsdf) {
    for (const Vec3 wo : {Vec3{0, 0, 1}, normalize(Vec3{0.6f, -0.3f, 0.5f}), normalize(Vec3{0.2f, 0.5f, -0.7f})}) {
        CAPTURE(name);
        CAPTURE(wo.z);
        const Drawn drawn = mean_of_draws(bsdf, wo);
        const SpecularBranches branches = bsdf.specular(wo);
        CHECK(static_cast<double>(branches.mirror.r) == doctest::Approx(drawn.mirror).epsilon(2e-3));
        CHECK(static_cast<double>(branches.refraction.r) == doctest::Approx(drawn.refraction).epsilon(2e-3));
        if (!is_black(branches.refraction)) {
            CHECK(branches.refracted.z * wo.z < 0);
            CHECK(static_cast<double>(length(branches.refracted)) == doctest::Approx(1).epsilon(1e-5));
        }
        CHECK((is_black(branches.mirror) && is_black(branches.refraction)) == !bsdf.has_delta());
    }
}

} // namespace

TEST_CASE("both branches of delta lobes equal the means of their samples, even under layers") {
    const Bsdf glass = make_dielectric(1.5f, 0, {0.9f, 0.8f, 0.7f});
    const Bsdf plastic = make_metallic_roughness({0.6f, 0.3f, 0.2f}, 0, 0, 1.5f);
    const Bsdf metal = make_conductor({0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}, 0);
    check("diffuse", make_diffuse({0.5f, 0.5f, 0.5f}));
    check("glass", glass);
    check("metal", metal);
    check("plastic", plastic);
    check("rough metal", make_conductor({0.2f, 0.9f, 1.1f}, {3.9f, 2.4f, 2.2f}, 0.5f));
    check("varnish on wood", make_coated(make_diffuse({0.5f, 0.3f, 0.2f}), 0.8f, 0, 1.5f));
    check("a pane", make_reflection({.base_color = {0.9f, 0.5f, 0.1f}, .roughness = 0, .through = 0.7f}));
    check("varnish on a pane",
          make_coated(make_reflection({.base_color = {1, 1, 1}, .roughness = 0, .through = 1}), 1, 0, 1.7f));
    check("varnish on glass", make_coated(glass, 1, 0, 1.7f));
    check("rough varnish on metal", make_coated(metal, 0.7f, 0.4f, 1.5f));
    check("varnish and velvet on plastic", make_sheen(make_coated(plastic, 0.5f, 0, 1.5f), {0.4f, 0.4f, 0.4f}, 0.5f));
}
