// Mixtures of unlike materials (formats/described/mix_surfaces.h). What a BSDF scatters once is linear in it, so the
// picture of a mixture under direct light is that of its parts, each with its share.

#include <array>
#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/read_scene.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "tests/support/compare_pictures.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

constexpr uint32_t kCell = 10, kRenders = 8;

const std::string kParts =
    "MakeNamedMaterial \"red\" \"string type\" \"diffuse\" \"rgb reflectance\" [.8 .2 .1]\n"
    "MakeNamedMaterial \"plastic\" \"string type\" \"coateddiffuse\" \"rgb reflectance\" [.1 .3 .8] \"float "
    "roughness\" .2\n"
    "MakeNamedMaterial \"gold\" \"string type\" \"conductor\" \"float roughness\" .2\n"
    "MakeNamedMaterial \"coated\" \"string type\" \"coatedconductor\" \"float conductor.roughness\" .2 \"float "
    "interface.roughness\" .3\n"
    "MakeNamedMaterial \"bare\" \"string type\" \"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" "
    "\"metal-Cu-k\" \"float roughness\" .2\n"
    "MakeNamedMaterial \"leaf\" \"string type\" \"diffusetransmission\" \"rgb reflectance\" [.1 .4 .1] \"rgb "
    "transmittance\" [.3 .5 .1]\n"
    "MakeNamedMaterial \"glass\" \"string type\" \"dielectric\" \"float roughness\" .3\n"
    "Texture \"third\" \"float\" \"checkerboard\" \"float tex1\" .3 \"float tex2\" .3\n"
    "MakeNamedMaterial \"even\" \"string type\" \"mix\" \"string materials\" [\"red\" \"gold\"]\n";

/// A mixture as a material of the file, and the shares of its parts.
struct Mixture {
    std::string text;
    std::array<const char*, 3> parts;
    std::array<double, 3> shares;
};
std::string mix(const char* first, const char* second, const char* amount) {
    return fmt::format("Material \"mix\" \"string materials\" [\"{}\" \"{}\"] {}", first, second, amount);
}
const std::vector<Mixture>& mixtures() {
    static const std::vector<Mixture> all = {
        {mix("plastic", "gold", "\"float amount\" .3"), {"plastic", "gold", "gold"}, {0.7, 0.3, 0}},
        {mix("red", "plastic", "\"texture amount\" \"third\""), {"red", "plastic", "red"}, {0.7, 0.3, 0}},
        {mix("even", "plastic", "\"texture amount\" \"third\""), {"red", "gold", "plastic"}, {0.35, 0.35, 0.3}},
        {mix("coated", "bare", "\"float amount\" .6"), {"coated", "bare", "bare"}, {0.4, 0.6, 0}},
        {mix("leaf", "red", "\"float amount\" .75"), {"leaf", "red", "red"}, {0.25, 0.75, 0}},
        {mix("glass", "leaf", "\"float amount\" .3"), {"glass", "leaf", "leaf"}, {0.7, 0.3, 0}},
    };
    return all;
}

/// A row of spheres, of which number i has the statement material(i), under a sun and an even sky.
template <class Material>
test::PictureEstimate row_of_spheres(const Material& material, uint32_t seed) {
    const std::size_t count = mixtures().size();
    std::string text = fmt::format(
        "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"orthographic\" \"float screenwindow\" [{} {} -1 1] WorldBegin {}"
        "LightSource \"infinite\" \"rgb L\" [.5 .5 .5] LightSource \"distant\" \"point3 from\" [1 2 -2]\n",
        -static_cast<double>(count), count, kParts);
    for (std::size_t i = 0; i < count; ++i)
        text += fmt::format("AttributeBegin {} Translate {} 0 0 Shape \"sphere\" \"float radius\" .9 AttributeEnd\n",
                            material(i), 2.0 * static_cast<double>(i) + 1 - static_cast<double>(count));
    Messages messages;
    const Scene scene = read_scene(test::write_text(test::scratch_folder() / "row.pbrt", text), {}, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    RenderSettings settings;
    settings.width = kCell * static_cast<uint32_t>(count), settings.height = kCell;
    settings.samples = 16;
    settings.path.max_depth = 1;
    Queue queue = test::requested_queue();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    return test::estimate_picture(queue, prepared, scene.cameras.front(), settings, kRenders, seed);
}

} // namespace

TEST_CASE("the picture of a mixture is that of its parts, each with its share") {
    const std::vector<Mixture>& all = mixtures();
    const test::PictureEstimate mixed = row_of_spheres([&](std::size_t i) { return all[i].text; }, 100);
    test::PictureEstimate sum = mixed, wrong = mixed;
    for (test::PictureEstimate* const estimate : {&sum, &wrong}) {
        estimate->mean.assign(mixed.mean.size(), 0);
        estimate->variance_of_mean.assign(mixed.mean.size(), 0);
    }
    const std::size_t values = mixed.pixel_values(), row = 3 * kCell * all.size();
    for (std::size_t k = 0; k < 3; ++k) {
        const test::PictureEstimate part =
            row_of_spheres([&](std::size_t i) { return fmt::format("NamedMaterial \"{}\"", all[i].parts[k]); },
                           200 + 50 * static_cast<uint32_t>(k));
        for (std::size_t j = 0; j < values; ++j) {
            const double share = all[j % row / (std::size_t(3) * kCell)].shares[k];
            const double other = k == 0 ? share - 0.03 : k == 1 ? share + 0.03 : share;
            sum.mean[j] += share * part.mean[j];
            wrong.mean[j] += other * part.mean[j];
            sum.variance_of_mean[j] += share * share * part.variance_of_mean[j];
            sum.mean[values + j % 3] += 3 * share * part.mean[j] / static_cast<double>(values);
            wrong.mean[values + j % 3] += 3 * other * part.mean[j] / static_cast<double>(values);
            sum.variance_of_mean[values + j % 3] += 9 * share * share * part.variance_of_mean[j] /
                                                    (static_cast<double>(values) * static_cast<double>(values));
        }
    }
    wrong.variance_of_mean = sum.variance_of_mean;
    CHECK(test::p_value(mixed, sum) > 1e-3);
    CHECK(test::p_value(mixed, wrong) < 1e-3); // the test notices shares that are 0.03 off
}

TEST_CASE("no light leaks between the surfaces of a mixture") {
    // A closed sphere around a point light has one diffuse material, or two that scatter alike and differ in kind.
    const auto picture = [](const char* material, uint32_t seed) {
        Messages messages;
        const std::string text =
            fmt::format("LookAt 0 0 0 0 0 1 0 1 0 Camera \"perspective\" \"float fov\" 90 WorldBegin\n"
                        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [.8 .8 .8]\n"
                        "MakeNamedMaterial \"b\" \"string type\" \"matte\" \"rgb Kd\" [.8 .8 .8] \"float sigma\" .001\n"
                        "LightSource \"point\" \"point3 from\" [.3 .4 -.2] {} Scale 1 1.5 1 Shape \"sphere\"\n",
                        material);
        const Scene scene = read_scene(test::write_text(test::scratch_folder() / "ball.pbrt", text), {}, messages);
        CHECK(messages.left_out() == std::vector<std::string>{});
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.samples = 32;
        settings.path.max_depth = 30;
        Queue queue = test::requested_queue();
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        return test::estimate_picture(queue, prepared, scene.cameras.front(), settings, kRenders, seed);
    };
    const test::PictureEstimate one = picture("NamedMaterial \"a\"", 1);
    const test::PictureEstimate two = picture("Material \"mix\" \"string materials\" [\"a\" \"b\"]", 50);
    CHECK(test::p_value(one, two) > 1e-3);
    const std::size_t total = one.pixel_values();
    CHECK(two.mean[total] == doctest::Approx(one.mean[total]).epsilon(0.01));
}

TEST_CASE("photon maps have the light of surfaces of stochastic alpha") {
    // A room is lit by a point light and shows what its surfaces send each other. The ball in it is blended, or diffuse
    // and of metal, which keeps no photons, or diffuse beneath metal, or of two diffuse surfaces. So few photons have
    // an error of 2 %; a ball whose photons count by the wrong chance makes more.
    for (const char* ball :
         {R"(NamedMaterial "a" Shape "sphere" "float radius" .5 "float alpha" .4)",
          R"(Material "mix" "string materials" ["a" "gold"] "float amount" .6 Shape "sphere" "float radius" .5)",
          R"(Material "mix" "string materials" ["gold" "a"] "texture amount" "some" Shape "sphere" "float radius" .5)",
          R"(Material "mix" "string materials" ["a" "b"] "float amount" .6 Shape "sphere" "float radius" .5)"}) {
        Messages messages;
        const std::string text =
            fmt::format(R"(LookAt 0 0 -.95 0 0 0 0 1 0 Camera "perspective" "float fov" 50 WorldBegin
                        MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [.8 .8 .8]
                        MakeNamedMaterial "b" "string type" "matte" "rgb Kd" [.8 .8 .8] "float sigma" .001
                        MakeNamedMaterial "gold" "string type" "conductor" "float roughness" .3
                        Texture "some" "float" "checkerboard" "float tex1" .4 "float tex2" .4
                        LightSource "point" "point3 from" [0 .72 -.2]
                        AttributeBegin {} AttributeEnd
                        NamedMaterial "a" ReverseOrientation Shape "sphere" "float radius" 1
                        )",
                        ball);
        const Scene scene = read_scene(test::write_text(test::scratch_folder() / "met.pbrt", text), {}, messages);
        CHECK(messages.left_out() == std::vector<std::string>{});
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = test::requested_queue();
        const auto mean_by = [&](IntegratorKind integrator, uint32_t samples) {
            RenderSettings settings;
            settings.width = settings.height = 12;
            settings.samples = samples;
            settings.path.max_depth = 4;
            settings.integrator = integrator;
            settings.photon_map.edit().photons = 5000;
            settings.photon_map.edit().radius = 0.1f;
            settings.photon_map.edit().gather = PhotonGather::Direct;
            return test::mean_of(render_picture(queue, prepared, scene.cameras.front(), settings).picture);
        };
        CAPTURE(std::string(ball));
        CHECK(std::abs(mean_by(IntegratorKind::PhotonMap, 16) / mean_by(IntegratorKind::Path, 256) - 1) < 0.06);
    }
}
