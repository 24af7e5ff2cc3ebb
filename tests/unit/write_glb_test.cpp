// Scenes written as glTF and read again: the same materials, the same picture to the bit, and a warning for all that is
// lost.

#include <doctest/doctest.h>

#include <functional>

#include "base/write_file_atomically.h"
#include "formats/gltf_writer/write_glb.h"
#include "formats/read_scene.h"
#include "image/picture_hash.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Scene written_and_read(const Scene& scene, Messages& lost) {
    const std::filesystem::path file = test::scratch_folder() / "written.glb";
    write_glb(file, scene, lost);
    Messages reading;
    Scene read = read_scene(file, {}, reading);
    CHECK_MESSAGE(reading.left_out().empty(), (reading.left_out().empty() ? "" : reading.left_out().front()));
    return read;
}

/// The scene of all kinds of surfaces and lights, without what glTF lacks.
Scene scene_of_gltf() {
    Scene scene = test::make_mixed_scene();
    scene.environment.reset();
    for (Material& material : scene.materials) {
        if (material.kind == MaterialKind::Conductor) {
            material.kind = MaterialKind::MetallicRoughness;
            material.metallic = 1;
        }
        if (material.is_emitter()) material.double_sided = material.two_sided_emission;
    }
    return scene;
}

/// A triangle with a material of two images, a red and a grey one of 2 x 1 texels.
Scene triangle_to_write(const Material& material) {
    Scene scene;
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.tangents.assign(3, {1, 0, 0, 1});
    for (auto& uv : mesh.uv) uv = {{0, 0}, {1, 0}, {0, 1}};
    mesh.indices = {0, 1, 2};
    for (const uint8_t green : {uint8_t{0}, uint8_t{90}}) {
        TextureImage& image = scene.images.emplace_back();
        image.rgba8 = {2, 1, {100, green, 30, 255, 200, green, 60, 128}};
    }
    scene.materials = {material};
    scene.instances.push_back({.name = "triangle"});
    return scene;
}

/// Compares all numbers, choices and texture slots; images by their texels.
void check_same_material(const Scene& a, const Scene& b) {
    Material of_a = a.materials.at(0), of_b = b.materials.at(0);
    std::vector<float> numbers;
    std::vector<TextureRef> textures;
    visit_parameters(
        of_a, [&](float& value, const char*, float, float) { numbers.push_back(value); },
        [&](TextureRef& texture, const char*) { textures.push_back(texture); });
    std::size_t number = 0, texture = 0;
    visit_parameters(
        of_b,
        [&](float& value, const char* name, float, float) {
            CHECK_MESSAGE(value == numbers[number], name);
            ++number;
        },
        [&](TextureRef& other, const char* name) {
            const TextureRef& one = textures[texture++];
            CHECK_MESSAGE(one.has_image() == other.has_image(), name);
            if (!one.has_image() || !other.has_image()) return;
            CHECK_MESSAGE((one.channel == other.channel && one.is_srgb == other.is_srgb), name);
            CHECK_MESSAGE((one.wrap_s == other.wrap_s && one.filter == other.filter && one.m00 == other.m00 &&
                           one.m02 == other.m02 && one.m11 == other.m11),
                          name);
            const auto& of_one = a.images[static_cast<std::size_t>(one.image)].rgba8.pixels;
            CHECK_MESSAGE(of_one == b.images[static_cast<std::size_t>(other.image)].rgba8.pixels, name);
        });
    CHECK(of_a.kind == of_b.kind);
    CHECK(of_a.alpha_mode == of_b.alpha_mode);
    CHECK(of_a.double_sided == of_b.double_sided);
    CHECK(of_a.thin_walled == of_b.thin_walled);
}

Material glossy_of_gltf() {
    Material material;
    material.kind = MaterialKind::MetallicRoughness;
    material.base_color = {0.25f, 0.5f, 0.75f};
    material.metallic = 0.3f;
    material.roughness = 0.4f;
    return material;
}

} // namespace

TEST_CASE("a scene written as glTF renders to the same bytes") {
    Queue queue = Queue::make_cpu();
    RenderSettings settings;
    settings.width = 24, settings.height = 16, settings.samples = 3;
    Messages lost;
    Scene scene = scene_of_gltf();
    scene.cameras = {test::mixed_scene_camera()};
    Scene read = written_and_read(scene, lost);
    read.bakes_small_meshes = scene.bakes_small_meshes;
    CHECK_MESSAGE(lost.left_out().empty(), (lost.left_out().empty() ? "" : lost.left_out().front()));
    const auto hash_of = [&](const Scene& of, const Camera& camera) {
        return picture_hash(test::render(queue, of, camera, settings).picture);
    };
    const Camera camera = test::mixed_scene_camera();
    CHECK(hash_of(read, camera) == hash_of(scene, camera));
    REQUIRE(read.cameras.size() == 1);
    CHECK(read.cameras[0].fov_y == camera.fov_y);
    CHECK(read.cameras[0].world_from_camera == camera.world_from_camera);
    const Scene again = written_and_read(read, lost);
    CHECK(again.cameras[0].name == read.cameras[0].name);
    CHECK(encode_glb(again, lost).size() == encode_glb(read, lost).size());
    CHECK(encode_glb(again, lost) == encode_glb(read, lost));
    REQUIRE(read.lights.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(read.lights[i].position == scene.lights[i].position);
        CHECK(read.lights[i].intensity == scene.lights[i].intensity);
        if (parts_of(read.lights[i].kind).direction) CHECK(read.lights[i].direction == scene.lights[i].direction);
    }
    REQUIRE(read.instances.size() == scene.instances.size());
    for (std::size_t i = 0; i < read.instances.size(); ++i) {
        CAPTURE(i);
        CHECK(read.instances[i].world_from_local == scene.instances[i].world_from_local);
        const Mesh &a = read.meshes[read.instances[i].mesh], &b = scene.meshes[scene.instances[i].mesh];
        CHECK(a.positions == b.positions);
        CHECK(a.normals == b.normals);
        CHECK(a.indices == b.indices);
        CHECK(a.uv == b.uv);
        Scene of_a, of_b;
        of_a.images = read.images, of_b.images = scene.images;
        of_a.materials = {read.materials[read.instances[i].material]};
        of_b.materials = {scene.materials[scene.instances[i].material]};
        check_same_material(of_b, of_a);
    }
    CHECK(read.lights[1].cos_inner == scene.lights[1].cos_inner);
    CHECK(read.lights[1].cos_outer == scene.lights[1].cos_outer);
    CHECK(read.meshes.size() == 5); // instances share them as before

    const Scene box = read_scene("cornell-box", {}, lost);
    const Scene other = written_and_read(box, lost);
    REQUIRE(other.cameras.size() == box.cameras.size());
    CHECK(hash_of(other, other.cameras.at(0)) == hash_of(box, box.cameras.at(0)));
}

TEST_CASE("every layer of a material that glTF has is written and read again") {
    const TextureRef color = {.image = 0, .is_srgb = true, .m00 = 2, .m02 = 0.25f};
    const auto slot = [](uint8_t channel) {
        return TextureRef{
            .image = 1, .wrap_s = Wrap::ClampToEdge, .filter = TextureFilter::Nearest, .channel = channel};
    };
    const std::pair<const char*, std::function<void(Material&)>> changes[] = {
        {"plain", [](Material&) {}},
        {"textures",
         [&](Material& m) {
             m.base_color_texture = m.emission_texture = color;
             m.emission = {3, 0.5f, 0};
             m.metallic_texture = slot(2), m.roughness_texture = slot(1);
             m.normal_texture = slot(0), m.normal_scale = 0.5f;
             m.two_sided_emission = true;
         }},
        {"mask", [](Material& m) { m.alpha_mode = AlphaMode::Mask, m.alpha_cutoff = 0.25f, m.double_sided = false; }},
        {"blend", [](Material& m) { m.alpha_mode = AlphaMode::Blend, m.alpha = 0.25f; }},
        {"coat",
         [&](Material& m) {
             m.coat_weight = 0.5f, m.coat_roughness = 0.25f;
             m.coat_texture = slot(0), m.coat_roughness_texture = slot(1);
         }},
        {"sheen",
         [&](Material& m) {
             m.fuzz_weight = 1, m.fuzz_color = {0.5f, 0.25f, 1}, m.fuzz_roughness = 0.75f;
             m.fuzz_roughness_texture = slot(3);
         }},
        {"thin glass", [&](Material& m) { m.transmission_weight = 0.75f, m.transmission_texture = slot(0); }},
        {"solid",
         [](Material& m) {
             m.transmission_weight = 0.75f, m.thin_walled = false, m.ior = 1.25f;
             m.transmission_depth = 0.5f, m.transmission_color = {0.5f, 1, 0.25f};
             m.transmission_dispersion_scale = 0.5f;
         }},
        {"glass",
         [](Material& m) {
             m.kind = MaterialKind::Dielectric, m.metallic = 0, m.roughness = 0, m.ior = 1.75f;
             m.transmission_depth = 2, m.transmission_color = {0.5f, 1, 0.25f};
         }},
        {"reflection",
         [&](Material& m) {
             m.specular_weight = 0.5f, m.specular_color = {0.5f, 1, 2};
             m.specular_texture = slot(3), m.specular_color_texture = color;
         }},
        {"film",
         [&](Material& m) {
             m.thin_film_weight = 0.5f, m.thin_film_ior = 1.5f, m.thin_film_thickness_nm = 300;
             m.thin_film_texture = slot(0), m.thin_film_thickness_texture = slot(1);
         }},
        {"brushed", [](Material& m) { m.specular_roughness_anisotropy = 0.5f, m.anisotropy_rotation = 0.25f; }},
        {"leaf",
         [&](Material& m) {
             m.diffuse_transmission_weight = 0.5f, m.diffuse_transmission_color = {0.5f, 1, 0.25f};
             m.diffuse_transmission_texture = slot(3), m.diffuse_transmission_color_texture = color;
         }},
        {"retroreflector", [](Material& m) { m.specular_retroreflectivity = 0.5f; }},
        {"matte", [](Material& m) { m.kind = MaterialKind::Diffuse, m.metallic = 0; }},
        {"unlit", [](Material& m) { m.kind = MaterialKind::Unlit, m.metallic = 0; }}};
    for (const auto& [name, change] : changes) {
        CAPTURE(name);
        Material material = glossy_of_gltf();
        change(material);
        const Scene scene = triangle_to_write(material);
        Messages lost;
        const Scene read = written_and_read(scene, lost);
        CHECK_MESSAGE(lost.left_out().empty(), (lost.left_out().empty() ? "" : lost.left_out().front()));
        check_same_material(scene, read);
    }
}

TEST_CASE("textures in other channels or encodings than glTF's are written again for their slots") {
    Material material = glossy_of_gltf();
    material.roughness_texture = {.image = 1, .channel = 0};
    material.metallic_texture = {.image = 0, .channel = 2};
    material.alpha_mode = AlphaMode::Mask;
    material.alpha_texture = {.image = 0, .channel = 3};
    Messages lost;
    const Scene read = written_and_read(triangle_to_write(material), lost);
    CHECK(lost.left_out().empty());
    const Material& of = read.materials.at(0);
    const auto texel = [&](const TextureRef& texture, std::size_t at, std::size_t channel) {
        return int{read.images.at(static_cast<std::size_t>(texture.image)).rgba8.pixels.at(4 * at + channel)};
    };
    CHECK(texel(of.roughness_texture, 0, of.roughness_texture.channel) == 100);
    CHECK(texel(of.metallic_texture, 1, of.metallic_texture.channel) == 60);
    CHECK(texel(of.base_color_texture, 1, 3) == 128);
    CHECK(texel(of.base_color_texture, 1, 0) == 255);

    material.base_color_texture = {.image = 0, .is_srgb = false};
    material.alpha_texture = {.image = 1, .channel = 3, .m00 = 2};
    const Scene other = written_and_read(triangle_to_write(material), lost);
    REQUIRE(lost.left_out().size() == 2);
    CHECK(other.images[static_cast<std::size_t>(other.materials[0].base_color_texture.image)].rgba8.pixels[0] == 168);
}

TEST_CASE("a scene far from its file's origin is written where the file has it") {
    Scene scene = triangle_to_write({});
    scene.origin_in_file = {1e7, -3, 0.5};
    Messages lost;
    const Scene read = written_and_read(scene, lost);
    const DoubleVec3 at = read.origin_in_file + to_double(read.instances.at(0).world_from_local.translation);
    CHECK(at.x == 1e7);
    CHECK(at.y == -3);
    CHECK(at.z == 0.5);
}

TEST_CASE("media of a scene and of its materials are named where they are lost") {
    Material cloud;
    cloud.make_clear_boundary();
    cloud.medium.sigma_s = {1, 1, 1};
    Scene scene = triangle_to_write(cloud);
    scene.medium.sigma_a = {0.5f, 0, 0};
    Messages lost;
    encode_glb(scene, lost);
    CHECK(lost.left_out().size() == 3);
}

TEST_CASE("what glTF lacks is named with its material, camera or scene") {
    Scene scene = test::make_mixed_scene();
    scene.materials[1].base_diffuse_roughness = 0.5f;
    scene.cameras = {test::mixed_scene_camera()};
    scene.cameras[0].name = "front";
    scene.cameras[0].aperture_radius = 0.1f;
    scene.suggested = {{"spp", "64"}};
    scene.variants = {"blue", "green"};
    scene.file_scenes = {"one", "two"};
    Messages lost;
    written_and_read(scene, lost);
    std::string all;
    for (const std::string& text : lost.left_out()) all += text + '\n';
    for (const char* part : {"gold: ", "refraction", "red: ", "roughness of its diffuse", "lamp: ", "front: ",
                             "aperture", "environment", "spp=64", "variants of materials", "other scenes"}) {
        CHECK_MESSAGE(all.find(part) != std::string::npos, part, " in ", all);
    }
    CHECK(lost.left_out().size() == 8);
}
