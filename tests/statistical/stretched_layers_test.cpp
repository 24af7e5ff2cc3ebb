// Anisotropy of coats, thin walls and reflections that send light back (shading/lobes/microfacets.h), and a coat's
// colour from a texture: each beside a BSDF or a picture that has the same light in another way.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <string>

#include "scene/tangents/make_tangents.h"
#include "tests/statistical/bsdf_cases.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

Vec3 turned(Vec3 w, float angle) {
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

/// Returns BSDFs whose highlights lie along the tangent at `angle` radians from x.
std::array<Bsdf, 4> stretched_along(float angle) {
    const Vec2 along = {std::cos(angle), std::sin(angle)};
    ReflectionParameters pane = {.base_color = grey(0.8f), .roughness = 0.4f, .through = 1, .anisotropy = 0.8f};
    pane.along = along;
    ReflectionParameters beads = {.base_color = grey(0.8f), .metallic = 1, .roughness = 0.4f, .anisotropy = 0.8f};
    beads.along = along;
    beads.retroreflectivity = 1;
    const Vec3 bent = turned(normalize(Vec3{0.2f, 0, 1}), angle);
    return {make_coated(make_diffuse(grey(0)), 1, 0.4f, 1.5f, {0, 0, 1}, grey(1), {along, 0.8f}),
            make_coated(make_diffuse(grey(0)), 1, 0.4f, 1.5f, bent, grey(1), {along, 0.8f}), make_reflection(pane),
            make_reflection(beads)};
}

/// A square of 2 m in the plane y = 0 whose texture coordinate u grows along x, and v towards -z.
Mesh square_with_coordinates() {
    Mesh mesh = sheet({0, 0, 0}, {1, 0, 0}, {0, 0, -1});
    mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return mesh;
}

/// A picture of the square under light from one direction, from another direction.
Image lit_square(const Material& material, const std::vector<TextureImage>& images) {
    Scene scene;
    scene.images = images;
    test::add(scene, square_with_coordinates(), material);
    Light sun;
    sun.kind = LightKind::Directional;
    sun.direction = normalize(Vec3{-0.3f, -1, -0.2f});
    sun.intensity = grey(3);
    scene.lights.push_back(sun);
    make_tangents(scene);
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.samples = 16;
    settings.path.max_depth = 1;
    Camera camera;
    camera.world_from_camera = look_at({-0.1f, 1, 0.3f}, {0, 0, 0}, {0, 0, -1});
    Queue queue = requested_queue();
    return test::render(queue, scene, camera, settings).picture;
}

TextureRef nearest_image(int32_t image) {
    TextureRef ref;
    ref.image = image;
    ref.filter = TextureFilter::Nearest;
    return ref;
}

} // namespace

TEST_CASE("layers are stretched along their tangent, and turn with it") {
    const Vec3 wo = direction_at(0.8f, 0.03f);
    const std::array<Bsdf, 4> straight = stretched_along(0);
    for (const float angle : {0.5f, 1.6f, 3.0f, 4.2f, 6.0f}) {
        const std::array<Bsdf, 4> all = stretched_along(angle);
        for (std::size_t k = 0; k < all.size(); ++k) {
            for (const float z : {-0.9f, -0.6f, 0.3f, 0.7f, 0.95f}) {
                for (const float turn : {0.1f, 0.35f, 0.5f, 0.8f}) {
                    const Vec3 wi = direction_at(z, turn);
                    const BsdfValue expected = straight[k].evaluate(wo, wi);
                    const BsdfValue found = all[k].evaluate(turned(wo, angle), turned(wi, angle));
                    INFO("layer " << k << ", angle " << angle << ", wi " << z << " " << turn);
                    CHECK(found.f.g == doctest::Approx(expected.f.g).epsilon(3e-3));
                    CHECK(found.pdf == doctest::Approx(expected.pdf).epsilon(3e-3));
                }
            }
        }
    }
    // Seen from above, light spreads along the tangent and not across.
    const Vec3 above = direction_at(1);
    for (const std::size_t k : {0, 2, 3}) {
        const float side = k == 2 ? -1.0f : 1.0f;
        const float wide = straight[k].eval(above, direction_at(0.75f * side, 0)).g;
        const float narrow = straight[k].eval(above, direction_at(0.75f * side, 0.25f)).g;
        INFO("layer " << k << ": " << wide << " along, " << narrow << " across");
        CHECK(wide > 2 * narrow);
    }
}

TEST_CASE("a stretched reflection that sends all light back is the reflection seen from the mirrored direction") {
    ReflectionParameters p = {.base_color = {0.9f, 0.5f, 0.1f}, .metallic = 1, .roughness = 0.5f, .anisotropy = 0.6f};
    p.along = {0.6f, 0.8f};
    const Bsdf plain = make_reflection(p);
    p.retroreflectivity = 1;
    const Bsdf back = make_reflection(p);
    for (const float z : {0.2f, 0.5f, 0.9f}) {
        const Vec3 wo = direction_at(z, 0.15f), wi = direction_at(0.7f, 0.3f);
        const Rgb expected = plain.eval({-wo.x, -wo.y, wo.z}, wi), found = back.eval(wo, wi);
        CHECK(found.r == doctest::Approx(expected.r).epsilon(1e-4));
        CHECK(found.b == doctest::Approx(expected.b).epsilon(1e-4));
    }
}

TEST_CASE("a thin wall of even microfacets transmits the mirror image of what GGX reflects") {
    const float alpha = alpha_from_roughness(0.5f);
    const Bsdf pane = make_reflection({.base_color = grey(1), .roughness = 0.5f, .weight = 0, .through = 1});
    for (const float z : {0.2f, 0.5f, 0.9f}) {
        const Vec3 wo = direction_at(0.7f, 0.6f), wi = direction_at(z, 0.2f);
        const float lost = metal_lost(wo.z, alpha) * metal_lost(z, alpha) / metal_average_lost(alpha);
        const float expected = evaluate_ggx_reflection(wo, wi, alpha).f + z * kInvPi * lost;
        CHECK(pane.eval(wo, {wi.x, wi.y, -z}).g == doctest::Approx(expected).epsilon(1e-4));
    }
}

TEST_CASE("stretched white metal returns all light at every angle and azimuth, GGX's and Beckmann's") {
    for (const bool is_beckmann : {false, true})
        for (const float roughness : {0.1f, 0.3f, 0.6f})
            for (const float anisotropy : {0.3f, 0.6f, 0.95f}) {
                const Bsdf metal = make_reflection({.base_color = grey(1),
                                                    .metallic = 1,
                                                    .roughness = roughness,
                                                    .anisotropy = anisotropy,
                                                    .is_beckmann = is_beckmann});
                for (const float cosine : {0.003f, 0.03f, 0.1f, 0.35f, 0.65f, 0.95f})
                    for (const float turn : {0.0f, 0.2f, 0.25f}) {
                        const double light = mean_weight(metal, direction_at(cosine, turn), 1 << 12).g;
                        INFO("Beckmann " << is_beckmann << ", roughness " << roughness << ", anisotropy " << anisotropy
                                         << ", cosine " << cosine << ", turn " << turn << ", light " << light);
                        CHECK(light > 0.988);
                        CHECK(light < 1.0015);
                    }
            }
}

TEST_CASE("stretched glass returns nearly all light from outside, and most from inside") {
    // An even surface of the same mean width loses less: with its loss 47 % were lost from outside, 86 % from inside.
    const struct {
        float side;
        double least, mean;
    } rows[] = {{1, 0.89, 0.985}, {-1, 0.51, 0.955}};
    for (const auto& row : rows) {
        double sum = 0;
        int count = 0;
        for (const float ior : {1.1f, 1.5f, 2.4f})
            for (const float roughness : {0.1f, 0.3f, 0.6f})
                for (const float anisotropy : {0.3f, 0.6f, 0.95f}) {
                    const Bsdf glass = make_reflection({.base_color = grey(1),
                                                        .roughness = roughness,
                                                        .ior = ior,
                                                        .solid = 1,
                                                        .anisotropy = anisotropy});
                    for (const float cosine : {0.003f, 0.03f, 0.1f, 0.35f, 0.65f, 0.95f})
                        for (const float turn : {0.0f, 0.1f, 0.25f}) {
                            const double light = mean_weight(glass, direction_at(row.side * cosine, turn), 1 << 10).g;
                            INFO("index " << ior << ", roughness " << roughness << ", anisotropy " << anisotropy
                                          << ", cosine " << row.side * cosine << ", turn " << turn << ", light "
                                          << light);
                            CHECK(light > row.least);
                            CHECK(light < 1.012); // the points err by up to 1 %
                            sum += light;
                            ++count;
                        }
                }
        INFO("side " << row.side << ", mean " << sum / count);
        CHECK(sum > row.mean * count);
    }
}

TEST_CASE("a coat's anisotropy, its rotation and its texture act in pictures as those of a reflection do") {
    std::vector<TextureImage> images(1);
    images[0].rgba8 = {2, 1, {255, 128, 255, 255, 60, 200, 128, 255}}; // along the tangent, and turned and weaker
    for (const bool has_map : {false, true}) {
        for (const float rotation : {0.0f, 1.1f}) {
            Material reflection = {{.kind = MaterialKind::MetallicRoughness, .base_color = grey(0)}, "reflection"};
            reflection.roughness = 0.35f;
            reflection.specular_roughness_anisotropy = 0.8f;
            reflection.anisotropy_rotation = rotation;
            Material coat = {{.kind = MaterialKind::MetallicRoughness, .base_color = grey(0)}, "coat"};
            coat.specular_weight = 0;
            coat.coat_weight = 1;
            coat.coat_roughness = 0.35f;
            coat.coat_roughness_anisotropy = 0.8f;
            coat.coat_anisotropy_rotation = rotation;
            if (has_map) reflection.anisotropy_texture = coat.coat_anisotropy_texture = nearest_image(0);
            const Image expected = lit_square(reflection, images), found = lit_square(coat, images);
            double most = 0;
            for (const float value : expected.pixels) most = std::fmax(most, static_cast<double>(value));
            CHECK(most > 0.01);
            CAPTURE(has_map);
            CAPTURE(rotation);
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < found.pixels.size(); ++i) {
                const double difference = static_cast<double>(found.pixels[i] - expected.pixels[i]);
                if (!(std::fabs(difference) <= 5e-3 * most)) ++wrong;
            }
            CHECK(wrong == 0);
            coat.coat_anisotropy_rotation = rotation + 0.5f;
            const double turned_mean = test::mean_of(lit_square(coat, images)), mean = test::mean_of(found);
            CHECK(std::fabs(turned_mean - mean) > 0.02 * mean);
        }
    }
}

TEST_CASE("a coat's colour is multiplied by its texture, also above what glows") {
    std::vector<TextureImage> images(1);
    images[0].rgba8 = {1, 1, {255, 128, 64, 255}};
    for (const bool glows : {false, true}) {
        Material plain = white(glows ? 0 : 0.8f);
        if (glows) plain.emission = grey(1);
        plain.coat_weight = 0.9f;
        plain.coat_roughness = 0.4f;
        Material with_map = plain;
        with_map.coat_color = {0.9f, 0.8f, 1};
        with_map.coat_color_texture = nearest_image(0);
        plain.coat_color = {0.9f, 0.8f * 128 / 255, 64.0f / 255};
        const Image expected = lit_square(plain, images), found = lit_square(with_map, images);
        CAPTURE(glows);
        CHECK(test::mean_of(expected) > 0.05);
        for (std::size_t i = 0; i < found.pixels.size(); ++i)
            CHECK(found.pixels[i] == doctest::Approx(expected.pixels[i]).epsilon(1e-3));
    }
}
