// The table of docs/materials.md: albedo by our lobes and by the formulas of Khronos's specifications, which are not
// reciprocal or lose energy, for directions at 0, 45 and 75 degrees. They differ by at most 0.05, or a row says why.

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/statistical/bsdf_cases.h"

using namespace pertev;
using namespace pertev::test;

namespace {

constexpr double kAngles[] = {0, 45, 75};

/// Integral of f cos over the hemisphere for a direction at `angle` degrees, by midpoints in wi.
template <class Brdf>
double khronos_albedo(double angle, const Brdf& brdf, int across = 600, int around = 240) {
    const Vec3 wo = direction_at(static_cast<float>(std::cos(angle * std::numbers::pi / 180)), 0);
    double sum = 0;
    for (int i = 0; i < across; ++i)
        for (int j = 0; j < around; ++j) {
            const Vec3 wi =
                direction_at(static_cast<float>((i + 0.5) / across), static_cast<float>((j + 0.5) / around));
            sum += brdf(wo, wi) * static_cast<double>(wi.z);
        }
    return sum * 2 * std::numbers::pi / (across * around);
}

double schlick(double cosine) { return 0.04 + 0.96 * std::pow(1 - cosine, 5); }

/// D V of a roughness, as evaluate_ggx_reflection without the cosine.
double microfacets(Vec3 wo, Vec3 wi, float roughness) {
    return static_cast<double>(evaluate_ggx_reflection(wo, wi, roughness * roughness).f / wi.z);
}
double half_cosine(Vec3 wo, Vec3 wi) { return static_cast<double>(dot(wo, normalize(wo + wi))); }

MeanWeight ours(const Bsdf& bsdf, double angle, uint32_t points = 1 << 16) {
    return mean_weight(bsdf, direction_at(static_cast<float>(std::cos(angle * std::numbers::pi / 180)), 0), points);
}

/// A function of a cosine, tabulated because some formulas take long.
class CosineTable {
public:
    explicit CosineTable(const std::function<double(double)>& f, int steps = 1000) : steps_(steps) {
        for (int i = 0; i <= steps; ++i) values_.push_back(f(static_cast<double>(i) / steps));
    }
    double operator()(double cosine) const {
        const double x = std::clamp(cosine, 0.0, 1.0) * steps_;
        const int i = std::min(static_cast<int>(x), steps_ - 1);
        return values_[static_cast<std::size_t>(i)] +
               (x - i) * (values_[static_cast<std::size_t>(i + 1)] - values_[static_cast<std::size_t>(i)]);
    }

private:
    int steps_;
    std::vector<double> values_;
};

/// KHR_materials_sheen: D V with the visibility of Neubelt and Pettineo or of Charlie.
class SheenOfKhronos {
public:
    SheenOfKhronos(float roughness, bool is_charlie)
        : alpha_(static_cast<double>(roughness * roughness)), is_charlie_(is_charlie), lambda_([this](double cosine) {
              return cosine < 0.5 ? std::exp(log_of(cosine)) : std::exp(2 * log_of(0.5) - log_of(1 - cosine));
          }) {}
    double operator()(Vec3 wo, Vec3 wi) const {
        const double cosine = static_cast<double>(normalize(wo + wi).z);
        const double d = (2 + 1 / alpha_) * std::pow(1 - cosine * cosine, 0.5 / alpha_) / (2 * std::numbers::pi);
        const double o = static_cast<double>(wo.z), i = static_cast<double>(wi.z);
        return is_charlie_ ? d / ((1 + lambda_(o) + lambda_(i)) * 4 * o * i) : d / (4 * (o + i - o * i));
    }

private:
    double log_of(double x) const {
        const double square = (1 - alpha_) * (1 - alpha_);
        const auto mixed = [&](double rough, double smooth) { return rough + (smooth - rough) * square; };
        return mixed(21.5473, 25.3245) / (1 + mixed(3.82987, 3.32435) * std::pow(x, mixed(0.19823, 0.16801))) +
               mixed(-1.97760, -1.27393) * x + mixed(-4.32054, -4.85967);
    }

    double alpha_;
    bool is_charlie_;
    CosineTable lambda_; // computed from the members above
};

/// Microfacets of transmission with KHR_materials_transmission's separable masking, for wi mirrored to the side of wo.
double separable_microfacets(Vec3 wo, Vec3 wi, float roughness) {
    const double alpha = static_cast<double>(roughness * roughness), o = static_cast<double>(wo.z),
                 i = static_cast<double>(wi.z);
    const auto part = [&](double z) { return 1 / (z + std::sqrt(alpha * alpha + (1 - alpha * alpha) * z * z)); };
    return static_cast<double>(ggx_normals(normalize(wo + wi), roughness * roughness)) * part(o) * part(i);
}

/// Reflectance in one channel of a film on a base that reflects `f0` (KHR_materials_iridescence's implementation
/// notes).
double film_of_khronos(double cosine, const ThinFilm& film, double f0, int channel) {
    const auto schlick_of = [](double at_normal, double c) { return at_normal + (1 - at_normal) * std::pow(1 - c, 5); };
    const auto reflected = [](double a, double b) { return (a - b) / (a + b) * (a - b) / (a + b); };
    const double ior = static_cast<double>(film.ior), root = std::sqrt(f0 + 0.0001), base = (1 + root) / (1 - root);
    const double cosine_within = std::sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double r12 = schlick_of(reflected(ior, 1), cosine), t121 = 1 - r12;
    const double r23 = schlick_of(reflected(base, ior), cosine_within);
    const double difference = 2 * ior * 1e-6 * static_cast<double>(film.thickness) * cosine_within;
    const double shift = std::numbers::pi + (base < ior ? std::numbers::pi : 0.0);
    const double r123 = std::clamp(r12 * r23, 1e-5, 0.9999), rs = t121 * t121 * r23 / (1 - r123);
    constexpr double kToRgb[3][3] = {
        {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};
    constexpr double kValue[4] = {5.4856e-13, 4.4201e-13, 5.2481e-13, 9.7470e-14},
                     kPlace[4] = {1.6810e6, 1.7953e6, 2.2084e6, 2.2399e6},
                     kVariance[4] = {4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9};
    double sum = r12 + rs, amplitude = rs - t121;
    for (int m = 1; m <= 2; ++m) {
        amplitude *= std::sqrt(r123);
        const double phase = 2 * std::numbers::pi * m * difference;
        for (int i = 0; i < 4; ++i) { // the fourth peak is the second one of X
            const double sensitivity = kValue[i] * std::sqrt(2 * std::numbers::pi * kVariance[i]) *
                                       std::cos(kPlace[i] * phase + m * shift) *
                                       std::exp(-kVariance[i] * phase * phase) / 1.0685e-7;
            sum += 2 * amplitude * kToRgb[channel][i % 3] * sensitivity;
        }
    }
    return std::max(sum, 0.0);
}

enum class Channel { Red, Green, Blue };

// Why albedos differ by more than 0.05, and the most by which they do: Khronos's mix of base and reflection gains light
// at grazing angles, its rough lobes lose the light of further bounces, and its films reflect both polarisations alike
// (with Fresnel's reflectances its series would have 0.53 for red at 75 degrees on metal).
constexpr double kMixGains = 0.09, kOneBounce = 0.35, kUnpolarised = 0.34;

struct Row {
    float roughness;
    double ours[3], khronos[3];
    double apart = 0.05; // largest difference
};

/// Prints a row of the document's table (tools/measure_tests.py).
void print_albedos(const std::string& lobe, float roughness, const double (&here)[3], const double (&there)[3]) {
    MESSAGE(lobe, ", ", roughness, ": Pertev at 0 ", here[0], ", Pertev at 45 ", here[1], ", Pertev at 75 ", here[2],
            ", formula at 0 ", there[0], ", formula at 45 ", there[1], ", formula at 75 ", there[2]);
}

template <class Make, class Brdf>
void check(const std::string& lobe, std::initializer_list<Row> rows, const Make& make, const Brdf& brdf,
           Channel channel = Channel::Green) {
    for (const Row& row : rows) {
        double all_here[3] = {}, all_there[3] = {};
        for (int k = 0; k < 3; ++k) {
            const Bsdf bsdf = make(row.roughness);
            const bool is_slow = bsdf.layers[0].kind == LobeKind::Filmed;
            const MeanWeight mean = ours(bsdf, kAngles[k], is_slow ? 1 << 13 : 1 << 16);
            const double here = channel == Channel::Red ? mean.r : channel == Channel::Blue ? mean.b : mean.g;
            const double there =
                khronos_albedo(kAngles[k], [&](Vec3 wo, Vec3 wi) { return brdf(wo, wi, row.roughness); });
            CAPTURE(lobe);
            CAPTURE(row.roughness);
            CAPTURE(kAngles[k]);
            CHECK(here == doctest::Approx(row.ours[k]).epsilon(0.006));
            CHECK(there == doctest::Approx(row.khronos[k]).epsilon(0.006));
            CHECK(std::fabs(here - there) < row.apart);
            all_here[k] = here, all_there[k] = there;
        }
        print_albedos(lobe, row.roughness, all_here, all_there);
    }
}

} // namespace

TEST_CASE("albedos of fuzz are those of the document, near those that MaterialX's formulas give") {
    const struct {
        float roughness;
        double ours[3], materialx[3];
    } rows[] = {{0.3f, {0.001, 0.005, 0.155}, {0.002, 0.004, 0.161}},
                {1, {0.341, 0.421, 0.616}, {0.345, 0.417, 0.613}}};
    for (const auto& row : rows) {
        double all[3] = {};
        for (int k = 0; k < 3; ++k) {
            const auto cosine = static_cast<float>(std::cos(kAngles[k] * std::numbers::pi / 180));
            const double here = mean_weight(make_fuzz(Bsdf{}, grey(1), row.roughness), direction_at(cosine), 1 << 16).g;
            CHECK(here == doctest::Approx(row.ours[k]).epsilon(0.006).scale(0.1));
            CHECK(std::abs(here - row.materialx[k]) < 0.01);
            all[k] = here;
        }
        print_albedos("Zeltner's sheen (beside MaterialX)", row.roughness, all, row.materialx);
    }
}

TEST_CASE("albedos of lobes and of Khronos's formulas are those of the document") {
    constexpr double kGrey = 0.5 / std::numbers::pi;
    check(
        "dielectric on 0.5",
        {{0.3f, {0.520, 0.521, 0.601}, {0.520, 0.522, 0.675}, kMixGains},
         {1, {0.507, 0.509, 0.517}, {0.492, 0.495, 0.508}}},
        [](float r) { return make_metallic_roughness(grey(0.5f), 0, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(half_cosine(wo, wi));
            return (1 - f) * kGrey + f * microfacets(wo, wi, r);
        });
    check(
        "metal of 0.5",
        {{0.3f, {0.498, 0.498, 0.570}, {0.495, 0.494, 0.552}},
         {1, {0.266, 0.290, 0.367}, {0.153, 0.189, 0.301}, kOneBounce}},
        [](float r) { return make_metallic_roughness(grey(0.5f), 1, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            return (0.5 + 0.5 * std::pow(1 - half_cosine(wo, wi), 5)) * microfacets(wo, wi, r);
        });
    const auto widths = [](float r) { return anisotropic_widths(r * r, 0.7f, {1, 0}); };
    check(
        "brushed metal of 0.5 (anisotropy 0.7)",
        {{0.3f, {0.448, 0.446, 0.473}, {0.398, 0.394, 0.435}, kOneBounce},
         {0.6f, {0.403, 0.411, 0.452}, {0.326, 0.339, 0.405}, kOneBounce}},
        [](float r) {
            return make_reflection({.base_color = grey(0.5f), .metallic = 1, .roughness = r, .anisotropy = 0.7f});
        },
        [&](Vec3 wo, Vec3 wi, float r) {
            return (0.5 + 0.5 * std::pow(1 - half_cosine(wo, wi), 5)) *
                   static_cast<double>(widths(r).evaluate_reflection(wo, wi).f / wi.z);
        });
    check(
        "coat on 0.5",
        {{0.3f, {0.503, 0.505, 0.598}, {0.520, 0.520, 0.611}}, {1, {0.504, 0.507, 0.517}, {0.492, 0.495, 0.523}}},
        [](float r) { return make_coated(make_diffuse(grey(0.5f)), 1, r, 1.5f); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(static_cast<double>(wo.z));
            return (1 - f) * kGrey + f * microfacets(wo, wi, r);
        });
    for (const Row& row : {Row{0.3f, {0.0014, 0.0425, 0.403}, {0.0014, 0.0426, 0.404}},
                           Row{1, {0.141, 0.221, 0.389}, {0.141, 0.221, 0.389}}}) {
        const SheenOfKhronos sheen(row.roughness, false);
        check(
            "sheen of 1 alone", {row}, [](float r) { return make_sheen(Bsdf{}, grey(1), r); },
            [&](Vec3 wo, Vec3 wi, float) { return sheen(wo, wi); });
    }
}

TEST_CASE("albedos of glTF's extensions and of Khronos's formulas are those of the document") {
    const auto grey_base = [](double reflected) { return (1 - reflected) * 0.5 / std::numbers::pi; };
    check(
        "half a coloured reflection on 0.5",
        {{0.3f, {0.500, 0.501, 0.542}, {0.500, 0.501, 0.573}}, {1, {0.500, 0.500, 0.502}, {0.472, 0.475, 0.486}}},
        [](float r) {
            return make_reflection({.base_color = grey(0.5f), .roughness = r, .weight = 0.5f, .color = {4, 2, 1}});
        },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double w = std::pow(1 - half_cosine(wo, wi), 5), most = 0.5 * (0.16 + 0.84 * w);
            return grey_base(most) + 0.5 * (0.08 + 0.92 * w) * microfacets(wo, wi, r);
        });
    // In the next two, light of the far side is mirrored to that of wo, as KHR_materials_transmission mirrors its half
    // vector, and both sides are added.
    check(
        "pane of 0.5",
        {{0.3f, {0.518, 0.516, 0.589}, {0.515, 0.514, 0.567}},
         {1, {0.504, 0.507, 0.517}, {0.160, 0.188, 0.264}, kOneBounce}},
        [](float r) { return make_reflection({.base_color = grey(0.5f), .roughness = r, .through = 1}); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(half_cosine(wo, wi));
            return (1 - f) * 0.5 * separable_microfacets(wo, wi, r) + f * microfacets(wo, wi, r);
        });
    check(
        "leaf of 0.3 and 0.7",
        {{0.3f, {0.508, 0.510, 0.599}, {0.520, 0.522, 0.675}, kMixGains},
         {1, {0.505, 0.508, 0.517}, {0.492, 0.495, 0.508}}},
        [](float r) {
            return make_reflection(
                {.base_color = grey(0.3f), .roughness = r, .translucent = 0.5f, .translucent_color = grey(0.7f)});
        },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(half_cosine(wo, wi));
            return (1 - f) * (0.5 * 0.3 + 0.5 * 0.7) / std::numbers::pi + f * microfacets(wo, wi, r);
        });
    const auto back = [](Vec3 wo) { return Vec3{-wo.x, -wo.y, wo.z}; };
    check(
        "retroreflection on 0.5",
        {{0.3f, {0.520, 0.521, 0.601}, {0.520, 0.522, 0.675}, kMixGains},
         {1, {0.507, 0.509, 0.517}, {0.492, 0.495, 0.508}}},
        [](float r) { return make_reflection({.base_color = grey(0.5f), .roughness = r, .retroreflectivity = 1}); },
        [&](Vec3 wo, Vec3 wi, float r) {
            const double f = schlick(half_cosine(back(wo), wi));
            return grey_base(f) + f * microfacets(back(wo), wi, r);
        });
    check(
        "half retroreflective metal of 0.5",
        {{0.3f, {0.498, 0.498, 0.570}, {0.495, 0.494, 0.552}},
         {1, {0.266, 0.290, 0.367}, {0.153, 0.189, 0.301}, kOneBounce}},
        [](float r) {
            return make_reflection(
                {.base_color = grey(0.5f), .metallic = 1, .roughness = r, .retroreflectivity = 0.5f});
        },
        [&](Vec3 wo, Vec3 wi, float r) {
            const auto metal = [&](Vec3 o) {
                return (0.5 + 0.5 * std::pow(1 - half_cosine(o, wi), 5)) * microfacets(o, wi, r);
            };
            return 0.5 * metal(wo) + 0.5 * metal(back(wo));
        });
}

TEST_CASE("albedos of films and of Khronos's formulas are those of the document") {
    const ThinFilm film = {.weight = 1, .ior = 1.8f, .thickness = 0.4f};
    const struct {
        bool is_metal;
        Channel channel;
        const char* name;
        Row row;
    } cases[] = {
        {false, Channel::Red, "film on 0.5 (red)", {0.3f, {0.540, 0.474, 0.530}, {0.573, 0.485, 0.562}}},
        {false, Channel::Green, "film on 0.5 (green)", {0.3f, {0.519, 0.551, 0.595}, {0.539, 0.566, 0.684}, kMixGains}},
        {false, Channel::Blue, "film on 0.5 (blue)", {0.3f, {0.481, 0.478, 0.595}, {0.508, 0.495, 0.682}, kMixGains}},
        {true,
         Channel::Red,
         "film on metal of 0.5 (red)",
         {0.3f, {0.149, 0.495, 0.475}, {0.101, 0.523, 0.809}, kUnpolarised}},
        {true, Channel::Green, "film on metal of 0.5 (green)", {0.3f, {0.242, 0.160, 0.392}, {0.258, 0.141, 0.352}}},
        {true,
         Channel::Blue,
         "film on metal of 0.5 (blue)",
         {0.3f, {0.409, 0.457, 0.407}, {0.394, 0.451, 0.342}, kUnpolarised}}};
    for (const auto& c : cases) {
        std::vector<CosineTable> reflectance;
        for (int channel = 0; channel < 3; ++channel)
            reflectance.emplace_back(
                [&](double cosine) { return film_of_khronos(cosine, film, c.is_metal ? 0.5 : 0.04, channel); });
        check(
            c.name, {c.row},
            [&](float r) {
                return make_reflection(
                    {.base_color = grey(0.5f), .metallic = c.is_metal ? 1.0f : 0.0f, .roughness = r, .film = film});
            },
            [&](Vec3 wo, Vec3 wi, float r) {
                const double cosine = half_cosine(wo, wi);
                const double f[3] = {reflectance[0](cosine), reflectance[1](cosine), reflectance[2](cosine)};
                const double base = c.is_metal ? 0 : (1 - std::max({f[0], f[1], f[2]})) * 0.5 / std::numbers::pi;
                return base + f[static_cast<int>(c.channel)] * microfacets(wo, wi, r);
            },
            c.channel);
    }
}

TEST_CASE("albedos of sheen on a base and of Khronos's albedo scaling are those of the document") {
    const struct {
        bool is_charlie;
        const char* name;
        Row row;
    } cases[] = {
        {false, "sheen of 0.5 on 0.5", {0.3f, {0.473, 0.490, 0.597}, {0.473, 0.490, 0.598}}},
        {false, "sheen of 0.5 on 0.5", {1, {0.510, 0.545, 0.596}, {0.510, 0.545, 0.596}}},
        {true, "sheen of 0.5 on 0.5 (Charlie's visibility)", {0.3f, {0.473, 0.490, 0.597}, {0.482, 0.493, 0.563}}},
        {true, "sheen of 0.5 on 0.5 (Charlie's visibility)", {1, {0.510, 0.545, 0.596}, {0.507, 0.549, 0.630}}}};
    for (const auto& c : cases) {
        const SheenOfKhronos sheen(c.row.roughness, c.is_charlie);
        const CosineTable albedo(
            [&](double cosine) {
                return khronos_albedo(
                    std::acos(std::max(cosine, 1e-3)) * 180 / std::numbers::pi,
                    [&](Vec3 wo, Vec3 wi) { return sheen(wo, wi); }, 100, 40);
            },
            50);
        check(
            c.name, {c.row}, [](float r) { return make_sheen(make_diffuse(grey(0.5f)), grey(0.5f), r); },
            [&](Vec3 wo, Vec3 wi, float) {
                const double most = std::max(albedo(static_cast<double>(wo.z)), albedo(static_cast<double>(wi.z)));
                return 0.5 * sheen(wo, wi) + (1 - 0.5 * most) * 0.5 / std::numbers::pi;
            });
    }
}
