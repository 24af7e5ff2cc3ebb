// For no direction, parameter or random number does a BSDF return a value that is negative or not finite, a direction
// that is not unit, or a weight that would be a firefly.

#include <doctest/doctest.h>

#include "tests/statistical/bsdf_cases.h"

using namespace pertev;
using namespace pertev::test;

namespace {

std::vector<BsdfCase> extreme_bsdf_cases() {
    std::vector<BsdfCase> cases = rough_bsdf_cases();
    for (const float r : {0.0f, 1e-3f, 0.0316f, 0.0317f, 0.05f, 1.0f}) {
        const std::string at = " of roughness " + std::to_string(r);
        cases.push_back({"gold" + at, make_conductor(kGoldEta, kGoldK, r)});
        cases.push_back({"conductor without loss" + at, make_conductor(grey(0), grey(1), r)});
        cases.push_back({"conductor of index 1" + at, make_conductor(grey(1), grey(0), r)});
        cases.push_back({"conductor of index 0" + at, make_conductor(grey(0), grey(0), r)});
        cases.push_back({"conductor of huge index" + at, make_conductor(grey(1e3f), grey(1e4f), r)});
        for (const float ior : {0.5f, 0.9999f, 1.0f, 1.0001f, 1.5f, 100.0f}) {
            cases.push_back({"glass" + at + " ior " + std::to_string(ior), make_dielectric(ior, r, grey(1))});
            cases.push_back({"plastic" + at, make_metallic_roughness({1, 0, 0.5f}, 0, r, ior)});
            cases.push_back({"half metal" + at, make_metallic_roughness({1, 0, 0.5f}, 0.5f, r, ior)});
        }
        for (const float through : {0.0f, 0.5f, 1.0f}) {
            const ReflectionParameters pane = {
                .base_color = {1, 0, 0.5f}, .roughness = r, .ior = 1, .color = {1e3f, 1, 0}, .through = through};
            cases.push_back({"pane" + at, make_reflection(pane)});
            cases.push_back({"varnished pane" + at, make_coated(make_reflection(pane), 1, r, 1.5f)});
            cases.push_back(
                {"bent varnish" + at, make_coated(make_reflection(pane), 1, r, 1.5f, normalize(Vec3{2, 0, 1}))});
        }
        cases.push_back({"black plastic" + at, make_metallic_roughness(grey(0), 0, r, 1)});
        cases.push_back({"black metal" + at, make_metallic_roughness(grey(0), 1, r, 1.5f)});
        cases.push_back({"white metal" + at, make_metallic_roughness(grey(1), 1, r, 1.5f)});
        for (const float strength : {0.0f, 0.5f, 1.0f}) {
            const Bsdf varnish = make_coated(Bsdf{}, strength, r, 1.5f);
            cases.push_back({"varnish on nothing" + at, varnish});
            cases.push_back({"sheen on varnish" + at, make_sheen(varnish, grey(strength), r)});
            for (const float under : {0.0f, 0.3f}) {
                const Bsdf glass = make_dielectric(1.5f, under, grey(1));
                cases.push_back({"varnished glass" + at, make_coated(glass, strength, r, 1.5f)});
                cases.push_back({"dusty glass" + at, make_sheen(glass, grey(strength), r)});
                const Bsdf plastic = make_metallic_roughness({1, 0, 0.5f}, 0.3f, under, 1.5f);
                cases.push_back({"varnished plastic" + at, make_coated(plastic, strength, r, 2.5f)});
            }
        }
    }
    cases.push_back({"absorber", Bsdf{}});
    return cases;
}

bool is_value(float x) { return is_finite(x) && x >= 0; }
bool is_value(Rgb c) { return is_value(c.r) && is_value(c.g) && is_value(c.b); }

} // namespace

TEST_CASE("samples of any bsdf from any direction with any random numbers are finite and bounded") {
    const float edges[] = {0.0f, 0x1p-24f, 0.25f, 0.5f, 0.75f, 1.0f - 0x1p-24f, 1.0f};
    for (const BsdfCase& c : extreme_bsdf_cases()) {
        int bad = 0, fireflies = 0;
        float largest = 0;
        for (const float z :
             {1.0f, 0.9999999f, 0.7f, 0.1f, 1e-3f, 1e-6f, 1e-20f, 1e-38f, 0.0f, -1e-38f, -1e-6f, -0.3f, -1.0f})
            for (const float turns : {0.0f, 0.125f, 0.61f})
                for (int k = 0; k < 7 * 7 * 7 + 300; k++) {
                    const Vec3 wo = direction_at(z, turns);
                    const SamplePoint p = k < 343 ? SamplePoint{edges[k / 49], {edges[k / 7 % 7], edges[k % 7]}}
                                                  : random_point(static_cast<uint32_t>(k), 5);
                    const BsdfSample s = c.bsdf.sample(wo, p.lobe, p.u);
                    if (s.pdf == 0) continue;
                    const bool fine = is_value(s.weight) && is_value(s.pdf) && is_finite(s.wi) &&
                                      std::abs(length_squared(s.wi) - 1.0f) < 1e-5f && s.wi.z != 0 &&
                                      s.is_transmission == (s.wi.z * wo.z < 0 || (s.wi.z < 0) != (wo.z < 0));
                    bad += fine ? 0 : 1;
                    largest = max(largest, max_component(s.weight));
                    if (max_component(s.weight) > 20) fireflies++;
                }
        INFO(c.name << ", largest weight " << largest);
        CHECK(bad == 0);
        CHECK(fireflies == 0);
    }
}

TEST_CASE("values of any bsdf for any two directions are finite") {
    for (const BsdfCase& c : extreme_bsdf_cases()) {
        int bad = 0;
        const float heights[] = {1.0f, 0.9999999f, 0.5f,   1e-3f,  1e-6f, 1e-20f, 1e-38f,
                                 0.0f, -1e-38f,    -1e-6f, -1e-3f, -0.5f, -1.0f};
        for (const float zo : heights)
            for (const float zi : heights)
                for (const float turns : {0.0f, 0.1f, 0.25f, 0.5f, 0.5000001f}) {
                    const Vec3 wo = direction_at(zo, 0), wi = direction_at(zi, turns);
                    const BsdfValue value = c.bsdf.evaluate(wo, wi);
                    bad += is_value(value.f) && is_value(value.pdf) ? 0 : 1;
                    bad += max_component(value.f) > 0 && !(value.pdf > 0) ? 1 : 0;
                    bad += c.bsdf.eval(wo, wi) == value.f && c.bsdf.pdf(wo, wi) == value.pdf ? 0 : 1;
                    bad += c.bsdf.has_delta_only() && !is_black(value.f) ? 1 : 0;
                }
        INFO(c.name);
        CHECK(bad == 0);
    }
}
