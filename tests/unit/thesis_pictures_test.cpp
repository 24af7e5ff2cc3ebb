// Pictures of the thesis's chapters 2 to 4: scenes and pictures agree with their captions.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>

#include "image/tone_map.h"
#include "lab/thesis_pictures.h"
#include "lab/thesis_recipes.h"
#include "lab/thesis_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("the point light of figure 3.3 has the downward intensity of the area light of figure 3.4") {
    const Scene hard = make_thesis_scene(ThesisScene::PointLight), soft = make_thesis_scene(ThesisScene::Box);
    const auto emitter = std::ranges::find(soft.instances, "light", &Instance::name);
    REQUIRE(emitter != soft.instances.end());
    CHECK(hard.instances[static_cast<std::size_t>(emitter - soft.instances.begin())].is_hidden);
    CHECK_FALSE(emitter->is_hidden);
    CHECK(soft.lights.empty());
    REQUIRE(hard.lights.size() == 1);
    const Mesh& mesh = soft.meshes[emitter->mesh];
    float area = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const Vec3 a = mesh.positions[mesh.indices[i]];
        area += 0.5f * length(cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a));
    }
    const Rgb emission = soft.materials[emitter->material].emission;
    CHECK(hard.lights[0].intensity.r == doctest::Approx(static_cast<double>(area * emission.r)).epsilon(1e-4));
    CHECK(hard.lights[0].intensity.b == doctest::Approx(static_cast<double>(area * emission.b)).epsilon(1e-4));
    CHECK(hard.lights[0].position.y == doctest::Approx(static_cast<double>(mesh.positions[0].y - 0.01f)));
}

TEST_CASE("the ball of figure 3.8 is a mirror that stands on the floor") {
    const Scene scene = make_thesis_scene(ThesisScene::MirrorBall);
    const auto ball = std::ranges::find(scene.instances, "mirror sphere", &Instance::name);
    REQUIRE(ball != scene.instances.end());
    CHECK(std::ranges::find(scene.instances, "short block", &Instance::name) == scene.instances.end());
    CHECK(scene.materials[ball->material].metallic == 1);
    CHECK(scene.materials[ball->material].roughness == 0);
    Bounds3 bounds;
    for (const Vec3 p : scene.meshes[ball->mesh].positions) bounds.extend(p);
    CHECK(bounds.lo.y == doctest::Approx(0.0).epsilon(1e-6));
    CHECK(bounds.size().x == doctest::Approx(0.2).epsilon(1e-4));
    // Normals point out, as the winding does.
    const Mesh& mesh = scene.meshes[ball->mesh];
    const Vec3 a = mesh.positions[mesh.indices[3]], b = mesh.positions[mesh.indices[4]],
               c = mesh.positions[mesh.indices[5]];
    CHECK(dot(cross(b - a, c - a), mesh.normals[mesh.indices[3]]) > 0);
}

namespace {

RenderSettings small_picture(uint32_t width, uint32_t height, uint32_t samples) {
    RenderSettings settings;
    settings.width = width, settings.height = height, settings.samples = samples;
    return settings;
}

/// Every picture, at a small size.
std::vector<ThesisPicture> all_pictures(Queue& queue, PathBody body) {
    RenderSettings settings = small_picture(64, 48, 2);
    settings.body = body;
    if (body == PathBody::Wavefront) settings.batch = 500;
    ThesisPictures pictures(queue, settings);
    std::vector<ThesisPicture> made;
    for (const std::string& name : thesis_picture_names()) made.push_back(pictures.make(name));
    return made;
}

/// The pictures of the CPU's loop, computed once.
const std::vector<ThesisPicture>& pictures_in_loop() {
    static const std::vector<ThesisPicture> made = [] {
        Queue cpu = Queue::make_cpu();
        return all_pictures(cpu, PathBody::Loop);
    }();
    return made;
}

/// Mean of green over the pixels in [x0, x1) x [y0, y1), fractions of the picture's width and height.
double mean_green(const Rgba8Image& image, double x0 = 0, double y0 = 0, double x1 = 1, double y1 = 1) {
    const auto at = [](double share, uint32_t size) { return static_cast<uint32_t>(share * size); };
    double sum = 0, count = 0;
    for (uint32_t y = at(y0, image.height); y < at(y1, image.height); ++y) {
        for (uint32_t x = at(x0, image.width); x < at(x1, image.width); ++x) {
            sum += image.pixels[4 * (std::size_t(y) * image.width + x) + 1];
            ++count;
        }
    }
    return sum / count;
}

/// Returns the mean difference of the channels, in steps of 255.
double distance_of(const Rgba8Image& a, const Rgba8Image& b) {
    REQUIRE(a.pixels.size() == b.pixels.size());
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int(a.pixels[i]) - int(b.pixels[i]));
    return sum / static_cast<double>(a.pixels.size());
}

} // namespace

TEST_CASE("pictures of the thesis differ, none is black, and each has a description") {
    const std::vector<ThesisPicture>& pictures = pictures_in_loop();
    const std::vector<std::string> names = thesis_picture_names();
    REQUIRE(pictures.size() == names.size());
    std::set<std::vector<uint8_t>> seen;
    std::set<std::string> places;
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const ThesisPicture& picture = pictures[i];
        CAPTURE(picture.name);
        CHECK(picture.name == names[i]);
        CHECK(picture.file() == names[i] + (names[i].starts_with("figure-4.1") ? ".svg" : ".png"));
        CHECK(picture.shows.ends_with('.'));
        CHECK_FALSE(picture.interrupted);
        places.insert(picture.place);
        if (!picture.svg.empty()) continue;
        CHECK((picture.image.width == 64 || picture.image.width == 32)); // panels have half of this size
        const auto lit = std::ranges::count_if(picture.image.pixels, [](uint8_t c) { return c > 60 && c < 255; });
        CHECK(lit > picture.image.width * picture.image.height / 8);
        CHECK(seen.insert(picture.image.pixels).second);
    }
    for (const char* place : {"Figure 3.3", "Figure 3.4", "Figure 3.6", "Figure 3.7", "Figure 3.8", "Figure 3.9",
                              "Figure 3.10", "Figure 4.1"}) {
        CHECK(places.contains(place));
    }
}

TEST_CASE("pictures of the thesis have the same bytes in the wavefront and on a GPU") {
    Queue queue = test::requested_queue();
    const std::vector<ThesisPicture>& in_loop = pictures_in_loop();
    const std::vector<ThesisPicture> at_once = all_pictures(queue, PathBody::Wavefront);
    for (std::size_t i = 0; i < in_loop.size(); ++i) {
        CAPTURE(in_loop[i].name);
        CHECK(in_loop[i].image.pixels == at_once[i].image.pixels);
        CHECK(in_loop[i].svg == at_once[i].svg);
    }
}

TEST_CASE("patches cover as many pixels in small pictures as in full ones, where their side is 8 cm") {
    const auto is = [](uint32_t panel_height, float patch_size, uint32_t steps, uint32_t photons) {
        const ThesisDetail detail = thesis_detail(panel_height);
        return detail.patch_size == patch_size && detail.early_steps == steps && detail.photons == photons;
    };
    CHECK(is(384, 0.08f, 200, 65536)); // the size for 1024x768
    CHECK(is(1080, 0.08f, 200, 65536));
    CHECK(is(192, 0.16f, 50, 16384));
    for (const uint32_t height : {96u, 6u, 1u}) CHECK(is(height, 0.32f, 12, 4096));
    const auto command = [](const char* name) {
        const auto& all = pictures_in_loop();
        return std::ranges::find(all, name, &ThesisPicture::name)->command;
    };
    const auto has = [&](const char* name, const char* settings) {
        return command(name).find(settings) != std::string::npos;
    };
    CHECK(has("figure-3.7b", " `patch_size=0.32` `subdivisions=0` `solver=southwell` `steps=12` `flat_patches` `size"));
    CHECK(has("figure-3.7c", " `patch_size=0.32` `subdivisions=0` `flat_patches` `size"));
    CHECK(has("figure-3.7d", " `patch_size=0.32` `subdivisions=1` `size"));
    CHECK(has("figure-3.9b", " `gather=direct` `photons=16384` `size"));
    CHECK(has("figure-3.10b", " `gather=direct` `photons=4096` `size"));
}

TEST_CASE("the panels of figure 3.7 converge to the smooth solution") {
    Queue queue = test::requested_queue();
    ThesisPictures pictures(queue, small_picture(192, 144, 8));
    const auto panel = [&](const char* name) { return pictures.make(name).image; };
    const Rgba8Image dark = panel("figure-3.7a"), ambient = panel("figure-3.7b"), flat = panel("figure-3.7c"),
                     smooth = panel("figure-3.7d");
    // Light is added everywhere except on emitters and the background.
    std::size_t brighter = 0, darker = 0;
    for (std::size_t i = 0; i < dark.pixels.size(); ++i) {
        brighter += ambient.pixels[i] > dark.pixels[i] ? 1 : 0;
        darker += ambient.pixels[i] < dark.pixels[i] ? 1 : 0;
    }
    CHECK(brighter > dark.pixels.size() / 4);
    CHECK(darker == 0);
    CHECK(distance_of(dark, smooth) > 1.5 * distance_of(ambient, smooth));
    CHECK(distance_of(ambient, smooth) > 1.5 * distance_of(flat, smooth));
    CHECK(distance_of(flat, smooth) > 0.2);
}

TEST_CASE("the photons of figure 3.9 lie on surfaces, and the map blurs what final gathering shows") {
    Queue queue = test::requested_queue();
    ThesisPictures pictures(queue, small_picture(256, 192, 8));
    const ThesisPicture dots = pictures.make("figure-3.9a"), map = pictures.make("figure-3.9b"),
                        gathered = pictures.make("figure-3.9c");
    // There is no surface next to the square box.
    CHECK(mean_green(dots.image, 0, 0, 0.1, 1) == 0);
    std::size_t lit = 0;
    for (std::size_t i = 1; i < dots.image.pixels.size(); i += 4) lit += dots.image.pixels[i] > 20 ? 1 : 0;
    CHECK(lit > dots.image.pixels.size() / 4 / 20);
    CHECK(lit < dots.image.pixels.size() / 4 / 2); // the photons are dots; the box is three quarters of the picture
    // Both have equal light in total.
    CHECK(mean_green(map.image) == doctest::Approx(mean_green(gathered.image)).epsilon(0.05));
    CHECK(map.image.pixels != gathered.image.pixels);
}

TEST_CASE("the caustic of figure 3.10 is more than three times as bright as its surroundings") {
    Queue queue = test::requested_queue();
    ThesisPictures pictures(queue, small_picture(256, 192, 16));
    const ThesisPicture dots = pictures.make("figure-3.10a"), shown = pictures.make("figure-3.10b");
    CHECK(shown.stats.samples == 16);
    CHECK(dots.stats.samples == 1);
    // Returns the light that is displayed with this value, by the display curve.
    const auto light_of_byte = [](double byte) {
        float light = 1e-4f;
        while (light < 100 && 255 * tone_map(grey(light), ToneMap::Agx).g < static_cast<float>(byte)) light *= 1.01f;
        return static_cast<double>(light);
    };
    const auto light_in = [&](double x0, double y0, double x1, double y1) {
        return light_of_byte(mean_green(shown.image, x0, y0, x1, y1));
    };
    const double spot = light_in(0.43, 0.65, 0.48, 0.69);
    for (const double shade : {light_in(0.33, 0.68, 0.37, 0.72), light_in(0.40, 0.72, 0.46, 0.75)}) {
        CHECK(spot > 3 * shade);
    }
    // Photons are dense in the caustic.
    CHECK(mean_green(dots.image, 0.42, 0.64, 0.49, 0.70) > 2 * mean_green(dots.image, 0.05, 0.75, 0.35, 0.95));
}

TEST_CASE("shadows are hard under a point light and soft under an area light, and indirect light shows neither") {
    Queue queue = test::requested_queue();
    const RenderSettings settings = small_picture(96, 72, 64);
    ThesisPictures pictures(queue, settings);
    // The shares of neighbours in a row whose brightness differs by a factor of at least 1.5, and of white pixels.
    const auto look_at_picture = [&](const char* number) {
        const ThesisPicture picture = pictures.make(number);
        const auto& pixels = picture.image.pixels;
        int steps = 0, white = 0;
        for (uint32_t y = 0; y < settings.height; ++y) {
            for (uint32_t x = 0; x + 1 < settings.width; ++x) {
                const int a = pixels[4 * (y * settings.width + x) + 1],
                          b = pixels[4 * (y * settings.width + x + 1) + 1];
                steps += std::max(a, b) > std::min(a, b) + 40 ? 1 : 0;
                white += a > 250 ? 1 : 0;
            }
        }
        return std::pair(steps, white);
    };
    const auto [hard_steps, hard_white] = look_at_picture("figure-3.3");
    const auto [soft_steps, soft_white] = look_at_picture("figure-3.4");
    const auto [indirect_steps, indirect_white] = look_at_picture("figure-3.6");
    CHECK(hard_steps > 1.3 * soft_steps);
    CHECK(soft_steps > 1.3 * indirect_steps);
    CHECK(soft_white > indirect_white);
}
