// Single scattering off GGX's and Beckmann's microfacets against values of Mitsuba 3.9 (bsdf.eval of roughconductor,
// roughdielectric and roughplastic), recorded for pairs of directions. Its masking of both directions is independent,
// and ours correlated by height, which the comparison takes into account; so are Schlick's reflectance of plastic and
// the square of the index, which our radiance does not have.

#include <doctest/doctest.h>

#include <span>
#include <string>

#include "device_scene/make_bsdf.h"
#include "formats/described/rough_coat.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/support/mitsuba_materials.h"

using namespace pertev;
using namespace pertev::test;

namespace {

struct RecordedByMitsuba {
    Vec3 wo, wi;
    Rgb metal; // alpha 0.25, gold's index
    float glass, plastic;
};

/// Correlated over independent masking.
float correlation(const Microfacets& widths, Vec3 wo, Vec3 wi) {
    const auto lambda = [&](Vec3 w) { return 0.5f * (widths.slope_length(w) / pertev::abs(w.z) - 1.0f); };
    const float o = lambda(wo), i = lambda(wi);
    return (1.0f + o) * (1.0f + i) / (1.0f + o + i);
}

void compare_with_mitsuba(bool is_beckmann, std::span<const RecordedByMitsuba> above,
                          std::span<const RecordedByMitsuba> through) {
    const ReflectionParameters metal = {
        .base_color = {}, .roughness = 0.5f, .is_beckmann = is_beckmann, .is_single = true};
    const Bsdf gold = make_metal(kGoldEta, kGoldK, metal);
    ReflectionParameters quarter = metal;
    quarter.weight = 0.25f;
    const Bsdf dimmed = make_metal(kGoldEta, kGoldK, quarter); // its specular_reflectance of 0.25
    const ReflectionParameters clear = {
        .base_color = grey(1), .roughness = 0.6f, .solid = 1, .is_beckmann = is_beckmann, .is_single = true};
    const Bsdf glass = make_reflection(clear);
    const Bsdf plastic =
        make_reflection({.base_color = grey(0), .roughness = 0.5f, .is_beckmann = is_beckmann, .is_single = true});
    const double tolerance = is_beckmann ? 0.01 : 1e-3; // its Beckmann masking is a rational fit
    for (const RecordedByMitsuba& r : above) {
        CAPTURE(r.wo.z);
        CAPTURE(r.wi.z);
        const float more = correlation(metal.microfacets(), r.wo, r.wi);
        const Rgb f = gold.eval(r.wo, r.wi);
        CHECK(f.r == doctest::Approx(more * r.metal.r).epsilon(tolerance));
        CHECK(f.g == doctest::Approx(more * r.metal.g).epsilon(tolerance));
        CHECK(f.b == doctest::Approx(more * r.metal.b).epsilon(tolerance));
        CHECK(dimmed.eval(r.wo, r.wi).g == doctest::Approx(0.25f * f.g).epsilon(1e-4));
        CHECK(dimmed.pdf(r.wo, r.wi) == gold.pdf(r.wo, r.wi));
        CHECK(glass.eval(r.wo, r.wi).g ==
              doctest::Approx(correlation(clear.microfacets(), r.wo, r.wi) * r.glass).epsilon(tolerance));
        const float cos_h = dot(r.wo, normalize(r.wo + r.wi));
        const float schlick = fresnel_schlick(cos_h, grey(0.04f)).g / fresnel_dielectric(cos_h, 1.5f).reflectance;
        CHECK(plastic.eval(r.wo, r.wi).g == doctest::Approx(more * schlick * r.plastic).epsilon(tolerance));
    }
    for (const RecordedByMitsuba& r : through) {
        CAPTURE(r.wo.z);
        CAPTURE(r.wi.z);
        const float eta = r.wo.z > 0 ? 1.5f : 1 / 1.5f;
        const float more = correlation(clear.microfacets(), r.wo, r.wi) * eta * eta;
        CHECK(glass.eval(r.wo, r.wi).g == doctest::Approx(more * r.glass).epsilon(2 * tolerance));
    }
}

const Vec3 kMirrorA = direction_at(0.9f, 0.1f), kMirrorB = direction_at(0.5f, 0.1f),
           kMirrorC = direction_at(0.7f, 0.1f), kMirrorA2 = direction_at(0.8f, 0.55f),
           kMirrorB2 = direction_at(0.6f, 0.65f), kMirrorC2 = direction_at(0.95f, 0.3f);
const Vec3 kBelow = direction_at(-0.75f, 0.6f), kUp1 = direction_at(0.6f, 0.55f), kUp2 = direction_at(0.5f, 0.65f),
           kInside1 = direction_at(-0.9f, 0.1f), kInside2 = direction_at(-0.8f, 0.1f);

} // namespace

TEST_CASE("GGX's metal, glass and plastic of one bounce are those of Mitsuba") {
    const RecordedByMitsuba above[] = {
        {kMirrorA, kMirrorA2, {0.827267f, 0.538979f, 0.444465f}, 0.0221434f, 0.0362953f},
        {kMirrorB, kMirrorB2, {0.660917f, 0.434348f, 0.365369f}, 0.0401567f, 0.0497604f},
        {kMirrorC, kMirrorC2, {0.095354f, 0.062121f, 0.0511586f}, 0.00572132f, 0.00404246f}};
    const RecordedByMitsuba through[] = {
        {kMirrorB, kBelow, {}, 3.67437f, 0}, {kInside1, kUp1, {}, 0.761377f, 0}, {kInside2, kUp2, {}, 0.97291f, 0}};
    compare_with_mitsuba(false, above, through);
}

TEST_CASE("Beckmann's metal, glass and plastic of one bounce are those of Mitsuba") {
    const RecordedByMitsuba above[] = {
        {kMirrorA, kMirrorA2, {1.04335f, 0.679762f, 0.560561f}, 0.025663f, 0.0457758f},
        {kMirrorB, kMirrorB2, {1.04312f, 0.685524f, 0.576657f}, 0.0620795f, 0.0785361f},
        {kMirrorC, kMirrorC2, {0.035178f, 0.0229177f, 0.0188734f}, 0.00694637f, 0.00149134f}};
    const RecordedByMitsuba through[] = {
        {kMirrorB, kBelow, {}, 5.17294f, 0}, {kInside1, kUp1, {}, 1.19048f, 0}, {kInside2, kUp2, {}, 1.56959f, 0}};
    compare_with_mitsuba(true, above, through);
    // With the widths 0.4 and 0.15 along x and y.
    const Microfacets widths = {.x = 0.4f, .y = 0.15f, .is_beckmann = true, .is_single = true};
    const Bsdf brushed{MetalLobe{kGoldEta, kGoldK, widths}};
    CHECK(brushed.eval(kMirrorA, kMirrorA2).r ==
          doctest::Approx(correlation(widths, kMirrorA, kMirrorA2) * 1.21439f).epsilon(0.01));
    CHECK(brushed.eval(kMirrorB, kMirrorB2).g ==
          doctest::Approx(correlation(widths, kMirrorB, kMirrorB2) * 0.699192f).epsilon(0.01));
}

namespace {

/// The albedo of Mitsuba 3.9's plastic (width 0) and roughplastic under a white sky, by bsdf.sample at 10^5 points or
/// more, and the one that they have if their colour is black.
struct PlasticOfMitsuba {
    bool is_beckmann;
    float width, ior, color;
    bool nonlinear;
    double albedo, of_black;
};
constexpr PlasticOfMitsuba kPlastics[] = {
    {false, 0, 1.3f, 0.5f, false, 0.5309, 0.0611},     {false, 0, 1.5f, 0.9f, false, 0.9101, 0.0918},
    {false, 0, 1.9f, 0.5f, true, 0.3103, 0.1475},      {false, 0, 1.5f, 0.5f, true, 0.3530, 0.0918},
    {false, 0.05f, 1.5f, 0.5f, false, 0.5207, 0.0858}, {false, 0.2f, 1.5f, 0.9f, false, 0.7140, 0.0641},
    {false, 0.2f, 1.5f, 0.1f, true, 0.1030, 0.0641},   {false, 0.5f, 1.3f, 0.5f, false, 0.3053, 0.0202},
    {false, 0.5f, 1.9f, 0.9f, true, 0.3559, 0.0781},   {false, 0.3f, 1.5f, 0.5f, true, 0.2836, 0.0536},
    {true, 0.05f, 1.9f, 0.9f, true, 0.7073, 0.1457},   {true, 0.1f, 1.5f, 0.5f, false, 0.5262, 0.0862},
    {true, 0.2f, 1.3f, 0.1f, false, 0.1370, 0.0476},   {true, 0.3f, 1.9f, 0.5f, true, 0.2820, 0.1232},
    {true, 0.5f, 1.5f, 0.9f, true, 0.6197, 0.0553},    {true, 0.5f, 1.5f, 0.5f, false, 0.3936, 0.0553},
};

/// Returns the BSDF of a colour beneath a coat as the readers of scenes make it.
Bsdf coated_as_read(const PlasticOfMitsuba& plastic, float color) {
    described::Surface surface;
    Material& m = surface.material;
    m.kind = MaterialKind::MetallicRoughness;
    m.energy = MicrofacetEnergy::Single;
    m.ior = plastic.ior;
    m.roughness = sqrt(plastic.width);
    if (plastic.is_beckmann) m.microfacet_distribution = MicrofacetDistribution::Beckmann;
    described::set_coated_color(surface, described::constant(grey(color)), described::CoatModel::Mitsuba,
                                plastic.nonlinear);
    return make_reflection({.base_color = m.base_color,
                            .roughness = m.roughness,
                            .ior = m.ior,
                            .is_beckmann = m.microfacet_distribution == MicrofacetDistribution::Beckmann,
                            .is_single = m.energy == MicrofacetEnergy::Single});
}
double albedo_under_sky(const Bsdf& bsdf) {
    constexpr int kSteps = 32;
    double albedo = 0;
    for (int i = 0; i < kSteps; ++i) {
        const float cosine = (static_cast<float>(i) + 0.5f) / kSteps;
        albedo += 2.0 / kSteps * static_cast<double>(cosine) * mean_weight(bsdf, direction_at(cosine), 1 << 10).g;
    }
    return albedo;
}

} // namespace

TEST_CASE("plastic reflects as much of a white sky as Mitsuba's") {
    for (const PlasticOfMitsuba& plastic : kPlastics) {
        INFO("Beckmann " << plastic.is_beckmann << ", width " << plastic.width << ", ior " << plastic.ior << ", color "
                         << plastic.color << ", nonlinear " << plastic.nonlinear);
        const double albedo = albedo_under_sky(coated_as_read(plastic, plastic.color)),
                     of_black = albedo_under_sky(coated_as_read(plastic, 0));
        CHECK(albedo - of_black == doctest::Approx(plastic.albedo - plastic.of_black).epsilon(5e-3));
        // Schlick's reflectance is up to 0.01 from Fresnel's.
        CHECK(std::fabs(of_black - plastic.of_black) < 0.011);
    }
}

// The parts of its principled and principledthin that ours has, as their files are read. Values are those of PyPI's
// mitsuba 3.9.1, variant scalar_rgb: load_dict({"type": "principled", ...}).eval(BSDFContext(), si, wi) with si.wi = wo
// and si.sh_frame about +z; albedos are means of sample() at 2 10^5 points, with wo by the cosine. Its diffuse part is
// Disney's, of which the factors other than Lambert's are known. Three parts are none of ours: GTR1's coat and Disney's
// sheen, of which only the light under a sky is compared, and a thin wall that transmits through narrower microfacets
// (roughness times 0.65 eta - 0.35) than it reflects with.

namespace {

struct EvalOfMitsuba {
    Vec3 wo, wi;
    Rgb f;
};

/// Returns the BSDF that a file describes, where u runs along x.
Bsdf bsdf_as_read(const std::string& bsdf) {
    const Material material = mitsuba_material(bsdf);
    MaterialAxes axes;
    axes.stretch.anisotropy = material.specular_roughness_anisotropy;
    sin_cos(material.anisotropy_rotation, axes.stretch.along.y, axes.stretch.along.x);
    return make_bsdf(SceneView{}, material, MeshView{}, {}, 0, 0, material.base_color, axes);
}

/// Compares values with Mitsuba's times factor(wo, wi).
template <class Factor>
void compare_evals(const std::string& xml, std::span<const EvalOfMitsuba> recorded, const Factor& factor,
                   double tolerance = 1e-3) {
    CAPTURE(xml);
    const Bsdf bsdf = bsdf_as_read(xml);
    for (const EvalOfMitsuba& r : recorded) {
        CAPTURE(r.wo.z);
        CAPTURE(r.wi.z);
        const Rgb f = bsdf.eval(r.wo, r.wi), wanted = factor(r.wo, r.wi) * r.f;
        CHECK(f.r == doctest::Approx(wanted.r).epsilon(tolerance));
        CHECK(f.g == doctest::Approx(wanted.g).epsilon(tolerance));
        CHECK(f.b == doctest::Approx(wanted.b).epsilon(tolerance));
    }
}

constexpr Microfacets kQuarter = {.x = 0.25f, .y = 0.25f, .is_single = true},
                      kGlass = {.x = 0.36f, .y = 0.36f, .is_single = true};
const Vec3 kThroughA2 = {kMirrorA2.x, kMirrorA2.y, -kMirrorA2.z}, kThroughB2 = {kMirrorB2.x, kMirrorB2.y, -kMirrorB2.z},
           kThroughC2 = {kMirrorC2.x, kMirrorC2.y, -kMirrorC2.z};
const std::string kGold = rgb_of("base_color", ".9 .5 .1"), kBlack = rgb_of("base_color", "0");

float schlick_over_fresnel(Vec3 wo, Vec3 wi) {
    const float cos_h = dot(wo, normalize(wo + wi));
    return fresnel_schlick(cos_h, grey(0.04f)).g / fresnel_dielectric(cos_h, 1.5f).reflectance;
}
/// The value of Lambert's law with the albedo of Disney's diffuse reflection, over that.
float lambert_over_disney(Vec3 wo, Vec3 wi) {
    constexpr float kRoughness = 0.5f, kAlbedo = 1.0082f; // the albedo is that of a white surface
    const float o = schlick_weight(wo.z), i = schlick_weight(wi.z), cos_d = dot(wo, normalize(wo + wi));
    const float back = 2 * kRoughness * cos_d * cos_d;
    return kAlbedo / ((1 - 0.5f * o) * (1 - 0.5f * i) + back * (o + i + o * i * (back - 1)));
}

} // namespace

TEST_CASE("principled's metal, dielectric, glass and diffuse light are those of Mitsuba") {
    const EvalOfMitsuba metal[] = {{kMirrorA, kMirrorA2, {0.782464f, 0.434725f, 0.0869856f}},
                                   {kMirrorB, kMirrorB2, {0.62888f, 0.354142f, 0.0794045f}},
                                   {kMirrorC, kMirrorC2, {0.0901589f, 0.0500884f, 0.0100178f}}};
    compare_evals(bsdf_of("principled", kGold + number_of("metallic", 1)), metal,
                  [](Vec3 wo, Vec3 wi) { return correlation(kQuarter, wo, wi); });
    const EvalOfMitsuba brushed[] = {{kMirrorA, kMirrorA2, {0.504373f, 0.280222f, 0.0560706f}},
                                     {kMirrorB, kMirrorB2, {0.412379f, 0.232224f, 0.0520684f}},
                                     {kMirrorC, kMirrorC2, {0.0291449f, 0.0161916f, 0.00323837f}}};
    const Microfacets uneven = {.x = 0.6803361f, .y = 0.1904941f, .is_single = true};
    compare_evals(bsdf_of("principled", kGold + number_of("metallic", 1) + number_of("roughness", 0.6) +
                                            number_of("anisotropic", 0.8)),
                  brushed, [&](Vec3 wo, Vec3 wi) { return correlation(uneven, wo, wi); });
    const EvalOfMitsuba plain[] = {{kMirrorA, kMirrorA2, grey(0.0362953f)},
                                   {kMirrorB, kMirrorB2, grey(0.0497604f)},
                                   {kMirrorC, kMirrorC2, grey(0.00404246f)}};
    const auto reflection = [](Vec3 wo, Vec3 wi) {
        return correlation(kQuarter, wo, wi) * schlick_over_fresnel(wo, wi);
    };
    compare_evals(bsdf_of("principled", kBlack), plain, reflection);
    compare_evals(bsdf_of("principledthin", kGold + number_of("spec_trans", 1)), plain, reflection);
    const std::string clear = rgb_of("base_color", "1 .81 .49") + number_of("roughness", 0.6) + number_of("eta", 1.5);
    const EvalOfMitsuba mirrored[] = {{kMirrorA, kMirrorA2, grey(0.0221434f)},
                                      {kMirrorB, kMirrorB2, grey(0.0401567f)},
                                      {kMirrorC, kMirrorC2, grey(0.00572132f)},
                                      {kInside1, direction_at(-0.8f, 0.55f), grey(0.0310599f)},
                                      {kInside2, direction_at(-0.6f, 0.65f), grey(0.432733f)}};
    const auto of_glass = [](Vec3 wo, Vec3 wi) { return correlation(kGlass, wo, wi); };
    compare_evals(bsdf_of("principled", clear + number_of("spec_trans", 1)), mirrored, of_glass);
    const EvalOfMitsuba through[] = {{kMirrorB, kBelow, {3.67437f, 3.30693f, 2.57206f}},
                                     {kInside1, kUp1, {0.761377f, 0.685239f, 0.532964f}},
                                     {kInside2, kUp2, {0.97291f, 0.875619f, 0.681037f}}};
    compare_evals(
        bsdf_of("principled", clear + number_of("spec_trans", 1)), through,
        [&](Vec3 wo, Vec3 wi) { return (wo.z > 0 ? 2.25f : 1 / 2.25f) * of_glass(wo, wi); }, 2e-3);
    const EvalOfMitsuba diffuse[] = {{kMirrorA, kMirrorA2, {0.229201f, 0.127334f, 0.0254668f}},
                                     {kMirrorB, kMirrorB2, {0.170609f, 0.0947829f, 0.0189566f}},
                                     {kMirrorC, kMirrorC2, {0.272398f, 0.151332f, 0.0302664f}}};
    compare_evals(bsdf_of("principled", kGold + number_of("specular", 0)), diffuse, lambert_over_disney);
    const EvalOfMitsuba leaf[] = {{kMirrorA, kMirrorA2, {0.160441f, 0.0891337f, 0.0178267f}},
                                  {kMirrorB, kMirrorB2, {0.119427f, 0.0663481f, 0.0132696f}},
                                  {kMirrorC, kMirrorC2, {0.190678f, 0.105932f, 0.0211865f}}};
    compare_evals(bsdf_of("principledthin", kGold + number_of("diff_trans", 0.6)), leaf, lambert_over_disney);
    const EvalOfMitsuba behind[] = {{kMirrorA, kThroughA2, {0.0687549f, 0.0381972f, 0.00763944f}},
                                    {kMirrorB, kThroughB2, {0.0515662f, 0.0286479f, 0.00572958f}},
                                    {kMirrorC, kThroughC2, {0.0816465f, 0.0453592f, 0.00907183f}}};
    compare_evals(bsdf_of("principledthin", kGold + number_of("diff_trans", 0.6)), behind,
                  [](Vec3, Vec3) { return 1.0f; });
}

TEST_CASE("principled reflects as much of a white sky as Mitsuba's") {
    struct Case {
        std::string xml;
        double albedo; // the green channel by 2 10^5 samples
        double within;
    };
    const std::string coat = kBlack + number_of("specular", 0) + number_of("clearcoat", 1);
    const auto principled = [](const std::string& inner) { return bsdf_of("principled", inner); };
    const Case cases[] = {
        {principled(""), 0.5627, 0.008},
        {principled(number_of("roughness", 0.2) + rgb_of("base_color", ".8")), 0.8681, 0.01},
        {principled(number_of("roughness", 1) + rgb_of("base_color", ".8")), 0.8702, 0.01},
        {principled(number_of("specular", 0)), 0.5044, 0.01},
        {principled(number_of("specular", 1) + rgb_of("base_color", ".2")), 0.2964, 0.01},
        {principled(number_of("specular", 0.1) + kBlack), 0.0206, 0.002},
        {principled(number_of("eta", 1.05) + number_of("roughness", 0.3) + kBlack), 0.0083, 0.003},
        {principled(number_of("metallic", 0.5) + kGold), 0.5054, 0.01},
        {principled(number_of("metallic", 1) + kGold), 0.4488, 0.01},
        {principled(number_of("sheen", 1) + number_of("specular", 0) + kBlack), 0.0115, 0.001},
        {principled(coat), 0.0168, 0.005},
        {principled(coat + number_of("clearcoat_gloss", 1)), 0.0205, 0.002},
        {bsdf_of("principledthin"), 0.5041, 0.005},
        {bsdf_of("principledthin", kGold + number_of("diff_trans", 0.6)), 0.5029, 0.005},
        {bsdf_of("principledthin", kGold + number_of("spec_trans", 1)), 0.4949, 0.035}, // glTF's wall loses more
        {bsdf_of("principledthin", kGold + number_of("spec_trans", 0.5)), 0.4995, 0.015},
    };
    for (const Case& c : cases) {
        CAPTURE(c.xml);
        const double albedo = albedo_under_sky(bsdf_as_read(c.xml));
        CAPTURE(albedo);
        CHECK(std::fabs(albedo - c.albedo) < c.within);
    }
}
