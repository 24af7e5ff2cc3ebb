// A finished picture's files: layers, display, metadata, and what happens when one of them cannot be written.

#include <algorithm>

#include <doctest/doctest.h>

#include "image/picture_hash.h"
#include "image/read_exr.h"
#include "image/read_image.h"
#include "image/tone_map_image.h"
#include "render/sample_layers/matte_names.h"
#include "session/degrees.h"
#include "session/session.h"
#include "session/writing/write_picture.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

RenderResult small_result(RenderSettings& settings) {
    Queue queue = Queue::make_cpu();
    settings.width = 12, settings.height = 8, settings.samples = 2;
    settings.aovs = kAovAlbedo | kAovIds;
    settings.path.light = PathLight::Direct;
    settings.path.seed = 4000000000u;
    return test::render(queue, test::make_mixed_scene(), test::mixed_scene_camera(), settings);
}

PictureRecord small_record(const RenderSettings& settings) {
    PictureRecord record;
    record.scene.scene = "mixed";
    record.camera.camera = test::mixed_scene_camera();
    record.settings = settings;
    record.device = "CPU";
    return record;
}

std::string text_of(const ExrMetadata& metadata, const std::string& name) {
    for (const auto& [key, value] : metadata) {
        if (key == name && std::holds_alternative<std::string>(value)) return std::get<std::string>(value);
    }
    return "(none)";
}

} // namespace

TEST_CASE("the facts of a picture have each name of its mattes once") {
    Scene scene;
    scene.instances.resize(3);
    scene.instances[0].name = scene.instances[2].name = "leaf", scene.instances[1].name = "bark";
    RenderSettings settings;
    settings.mattes = std::make_shared<const MatteNames>(scene);
    const PictureFacts facts = facts_of(small_record(settings), {});
    CHECK(facts.objects == std::vector<std::string>{"bark", "leaf"});
}

TEST_CASE("an EXR holds the picture, its layers and its settings") {
    RenderSettings settings;
    RenderResult result = small_result(settings);
    const std::vector<float> albedo = result.layers[0].image.pixels;
    const std::vector<PixelIds> ids = result.ids;
    const std::vector<std::string> paths = {test::scratch_folder() / "picture.exr"};
    PictureRecord record = small_record(settings);
    const WrittenPicture written = write_picture(paths, record, result);
    REQUIRE(written.files.size() == 1);
    CHECK(written.files[0].path == paths[0]);
    CHECK(written.files[0].failure.empty());
    CHECK(written.hash == picture_hash(result.picture).hex());

    const ExrFile file = read_exr(paths[0]);
    REQUIRE(file.find("albedo.G") != nullptr);
    CHECK(std::get<std::vector<float>>(file.find("albedo.G")->values)[5] == albedo[3 * 5 + 1]);
    REQUIRE(file.find("id.material") != nullptr);
    CHECK(std::get<std::vector<uint32_t>>(file.find("id.material")->values)[7] == ids[7].material);
    CHECK(text_of(file.metadata, "pertev.scene") == "mixed");
    CHECK(text_of(file.metadata, "pertev.integrator") == "direct");
    CHECK(text_of(file.metadata, "pertev.sampler") == "sobol");
    CHECK(text_of(file.metadata, "pertev.filter") == "blackman-harris");
    CHECK(text_of(file.metadata, "pertev.seed") == "4000000000");
    CHECK(text_of(file.metadata, "pertev.hash") == written.hash);
    CHECK(text_of(file.metadata, "pertev.environment") == "none");
    CHECK(text_of(file.metadata, "pertev.tone_map") == "(none)"); // no output shows it
}

TEST_CASE("a denoised picture's hash equals that of its file's channels") {
    RenderSettings settings;
    RenderResult result = small_result(settings);
    const std::vector<std::string> paths = {test::scratch_folder() / "picture.exr"};
    CHECK(write_picture(paths, small_record(settings), result).denoised_hash.empty());
    result = small_result(settings);
    result.denoised = result.picture;
    result.denoised->pixels[7] += 1;
    const WrittenPicture written = write_picture(paths, small_record(settings), result);
    CHECK(written.hash == picture_hash(result.picture).hex());
    CHECK(written.denoised_hash == picture_hash(read_image(paths[0])).hex());
    CHECK(written.denoised_hash != written.hash);
}

TEST_CASE("a PNG has the chosen display, which the metadata of its EXR name") {
    RenderSettings settings;
    RenderResult result = small_result(settings);
    const std::filesystem::path folder = test::scratch_folder();
    const std::vector<std::string> paths = {folder / "a.png", folder / "a.exr"};
    PictureRecord record = small_record(settings);
    record.display = Display{ToneMap::Aces, 1.25f};
    write_picture(paths, record, result);
    const Rgba8Image shown = tone_map_image(result.picture, ToneMap::Aces, 1.25f);
    const Image read = read_image(paths[0]); // linear
    CHECK(tone_map_image(read, ToneMap::Srgb).pixels == shown.pixels);
    const ExrMetadata metadata = read_exr(paths[1]).metadata;
    CHECK(text_of(metadata, "pertev.tone_map") == "aces");
}

TEST_CASE("a file that cannot be written is named and does not prevent others from being written") {
    RenderSettings settings;
    RenderResult result = small_result(settings);
    const std::filesystem::path folder = test::scratch_folder();
    const std::vector<std::string> paths = {folder / "no" / "such" / "folder.exr", folder / "good.exr",
                                            folder / "a.txt"};
    const WrittenPicture written = write_picture(paths, small_record(settings), result);
    REQUIRE(written.files.size() == 3);
    CHECK(written.files[0].failure.find("folder.exr") != std::string::npos);
    CHECK(written.files[1].failure.empty());
    CHECK(read_exr(paths[1]).width == 12);
    CHECK(!written.files[2].failure.empty());
    CHECK(!std::filesystem::exists(paths[0]));
}

TEST_CASE("a camera's metadata reproduces the camera") {
    CameraSource source;
    source.camera = test::mixed_scene_camera();
    source.target = to_double(Vec3{0, 0.9f, 0}); // the camera's original values
    const ExrMetadata plain = camera_metadata(source);
    CHECK(text_of(plain, "pertev.up") == "0,1,0"); // found automatically, because it was not set
    CHECK(text_of(plain, "pertev.projection") == "perspective");
    source.up = Vec3{0, 2, 0};
    source.target = DoubleVec3{1, 2, 3};
    source.camera.projection = Projection::Orthographic;
    const ExrMetadata requested = camera_metadata(source);
    CHECK(text_of(requested, "pertev.up") == "0,2,0");
    CHECK(text_of(requested, "pertev.target") == "1,2,3");
    CHECK(text_of(requested, "pertev.projection") == "orthographic");
}

TEST_CASE("metadata records how scene and camera were chosen") {
    SceneOptions options;
    options.scene = "mixed";
    options.environment = "0.5,1,0.25";
    options.environment_scale = 2;
    options.environment_rotation_deg = 30;
    options.show_back_faces = true;
    Scene scene;
    SceneSource source = source_of(options, scene);
    CHECK(source.scene == "mixed");
    CHECK(source.environment == "0.5,1,0.25");
    CHECK(source.environment_scale == 2);
    CHECK(source.environment_rotation_deg == 30);
    CHECK(!source.has_environment);
    CHECK(!source.two_sided_lights);
    CHECK(source.show_back_faces);
    options.environment = "sky.hdr";
    scene.environment.emplace();
    source = source_of(options, scene);
    CHECK(source.environment == "sky.hdr");
    CHECK(source.has_environment);

    CameraChoice choice;
    choice.camera = "1";
    choice.target = DoubleVec3{1, 2, 3};
    const CameraSource camera = source_of(choice, test::mixed_scene_camera());
    CHECK(camera.camera == test::mixed_scene_camera());
    CHECK(camera.name == "1");
    CHECK(camera.target == DoubleVec3{1, 2, 3});
    CHECK(!camera.up);
    CHECK(camera.fov_deg == 0);
    choice.fov_deg = 40.0f;
    CHECK(source_of(choice, {}).fov_deg == 40);
}

TEST_CASE("metadata of settings have the names and types of earlier versions, defaults included") {
    PictureRecord record;
    SceneSource& scene = record.scene;
    scene.scene = "mixed";
    scene.has_environment = true;
    scene.environment_scale = 2;
    scene.up_axis = "z", scene.unit = "cm", scene.animation = "go", scene.file_scene = "one", scene.ground = "on";
    scene.emitters = {"a=1W", "b=2lm"};
    scene.two_sided_lights = true;
    scene.time_s = 0.5;
    scene.shutter = Shutter{-0.25, 0.25};
    Camera& camera = record.camera.camera;
    camera.world_from_camera = look_at({0.1f, 0.9f, 3}, {0.1f, 0.9f, 1}, {0, 1, 0});
    camera.aperture_radius = 0.25f, camera.focus_distance = 2, camera.fov_y = 40 * kRadiansPerDegree;
    record.settings.filter = PixelFilter::Box;
    record.display = Display{ToneMap::Aces, 1.25f};
    const ExrMetadata expected = {{"pertev.scene", "mixed"},
                                  {"pertev.environment", "made up"},
                                  {"pertev.environment_scale", 2.0f},
                                  {"pertev.environment_rotation", 0.0f},
                                  {"pertev.up_axis", "z"},
                                  {"pertev.unit", "cm"},
                                  {"pertev.animation", "go"},
                                  {"pertev.file_scene", "one"},
                                  {"pertev.ground", "on"},
                                  {"pertev.lamp", "a=1W\nb=2lm"},
                                  {"pertev.two_sided_lights", 1},
                                  {"pertev.show_back_faces", 0},
                                  {"pertev.time", 0.5},
                                  {"pertev.shutter", "-0.25,0.25"},
                                  {"pertev.camera", ""},
                                  {"pertev.eye", "0.1,0.9,3"},
                                  {"pertev.target", "0.1,0.9,1"},
                                  {"pertev.up", "0,1,0"},
                                  {"pertev.aperture", 0.25f},
                                  {"pertev.focus", 2.0f},
                                  {"pertev.projection", "perspective"},
                                  {"pertev.fov", 40.0f},
                                  {"pertev.world_from_camera", "1,0,0 0,1,0 0,0,1 0.1,0.9,3"},
                                  {"pertev.filter_radius", 0.5f},
                                  {"pertev.seed", "0"},
                                  {"pertev.max_depth", 16},
                                  {"pertev.tone_map", "aces"},
                                  {"pertev.exposure", 1.25f}};
    const ExrMetadata metadata = settings_metadata(record);
    for (const auto& entry : expected) {
        CAPTURE(entry.first);
        const auto found = std::ranges::find(metadata, entry.first, &ExrMetadata::value_type::first);
        REQUIRE(found != metadata.end());
        CHECK(found->second == entry.second);
    }
    for (const char* absent : {"pertev.view_height", "pertev.lpe", "pertev.flat_patches", "pertev.false_color"}) {
        CAPTURE(absent);
        CHECK(std::ranges::find(metadata, absent, &ExrMetadata::value_type::first) == metadata.end());
    }
}

TEST_CASE("ids come with the names of the visible objects only, as JSON") {
    Scene scene;
    for (const char* name : {"floor", "a \"lamp\"", "unseen"}) {
        scene.instances.emplace_back().name = name;
        scene.materials.emplace_back().name = name;
    }
    SceneSource source;
    const std::vector<PixelIds> ids = {{1, 5, 0}, {1, 6, 0}, {kNoHit, kNoHit, kNoHit}, {0, 0, 1}};
    CHECK(id_metadata(source, ids).empty());
    name_ids(scene, source);
    const ExrMetadata metadata = id_metadata(source, ids);
    CHECK(text_of(metadata, "pertev.instances") == R"({"0":"floor","1":"a \"lamp\""})");
    CHECK(text_of(metadata, "pertev.materials") == R"({"0":"floor","1":"a \"lamp\""})");
    CHECK(id_metadata(source, {}).empty());
    CHECK(text_of(id_metadata(source, std::vector<PixelIds>(1, {kNoHit, kNoHit, kNoHit})), "pertev.instances") == "{}");
}
