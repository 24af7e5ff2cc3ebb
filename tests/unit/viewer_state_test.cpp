// Settings that a page may change (view_state.h), messages to it (panel_text.h), colours of layers (layer_colors.h),
// and the bytes of pictures (frame_header.h, packer.h).

#include <filesystem>

#include <doctest/doctest.h>

#include <simdjson.h>

#include "apps/viewer/file_name.h"
#include "apps/viewer/frame_header.h"
#include "apps/viewer/layer_colors.h"
#include "apps/viewer/packer.h"
#include "apps/viewer/panel_text.h"
#include "apps/viewer/view_state.h"
#include "device_scene/ray_queue.h"
#include "settings/picture_flags.h"
#include "settings/setting_table.h"
#include "tests/support/options.h"

using namespace pertev;

TEST_CASE("every setting accepts and returns its choices and bounds, and refuses other values") {
    for (const ViewSetting& setting : view_settings()) {
        CAPTURE(setting.name);
        ViewState state;
        if (setting.kind == ViewSetting::Kind::Choice) {
            REQUIRE(setting.choices.size() > 1);
            CHECK_FALSE(set_view_setting(state, setting.name, "no such choice").empty());
            CHECK_FALSE(set_view_setting(state, setting.name, 1.0).empty());
            for (const std::string& choice : setting.choices) {
                CAPTURE(choice);
                if (set_view_setting(state, setting.name, choice).empty()) {
                    CHECK(std::get<std::string>(setting.get(state)) == choice);
                }
            }
            CHECK(std::get<std::string>(setting.get(state)) != "");
        } else {
            for (const double value : {setting.low, setting.high}) {
                CHECK(set_view_setting(state, setting.name, value) == "");
                CHECK(std::get<double>(setting.get(state)) == doctest::Approx(value));
            }
            const SettingValue before = setting.get(state);
            CHECK_FALSE(set_view_setting(state, setting.name, setting.high + 1).empty());
            CHECK_FALSE(set_view_setting(state, setting.name, setting.low - 1).empty());
            CHECK_FALSE(set_view_setting(state, setting.name, "1").empty());
            CHECK(setting.get(state) == before);
        }
    }
    ViewState state;
    CHECK_FALSE(set_view_setting(state, "nothing", 1.0).empty());
    CHECK_FALSE(set_view_setting(state, "max_depth", 1.5).empty());
}

TEST_CASE("accumulation restarts for another view or light, but not for changes that only affect the display") {
    std::string names;
    for (const ViewSetting& setting : view_settings()) {
        CAPTURE(setting.name);
        CHECK(std::string(setting.hint) != "");
        const ViewState before;
        ViewState after;
        if (setting.kind == ViewSetting::Kind::Choice) {
            for (const std::string& choice : setting.choices) set_view_setting(after, setting.name, choice);
        } else {
            set_view_setting(after, setting.name, setting.low);
        }
        if (restarts(before, after)) names += std::string(setting.name) + ' ';
        CHECK_FALSE(restarts(after, after));
        const std::string name = setting.name;
        CHECK(is_shown_otherwise(before, after) == (name == "exposure" || name == "tone_map"));
    }
    CHECK(names == "layer integrator max_depth mode fov focus structure traversal rta ");
    ViewState round; // the lens of this view is a pinhole
    CHECK(set_view_setting(round, "aperture", 0.1) == "");
    CHECK(restarts({}, round));
}

TEST_CASE("fixing the exposure keeps its value, and metering resets the stops") {
    ViewState state;
    state.finds_exposure = true;
    state.found_stops = 2;
    CHECK(set_view_setting(state, "exposure", 0.5) == "");
    CHECK(set_view_setting(state, "exposed", "fixed") == "");
    CHECK(state.display.exposure_stops == 2.5f);
    CHECK(set_view_setting(state, "exposed", "fixed") == "");
    CHECK(state.display.exposure_stops == 2.5f);
    CHECK(set_view_setting(state, "exposed", "auto") == "");
    CHECK(state.display.exposure_stops == 0);
}

TEST_CASE("frames in motion have a smaller depth until a depth is chosen for both") {
    ViewState state;
    state.options.render.frame_depth = kMovingDepth;
    CHECK(state.options.render.path.max_depth > kMovingDepth);
    CHECK(find_setting("moving_depth")->otherwise ==
          fmt::format("max_depth; in the viewer {}, unless max_depth is given", kMovingDepth));
    CHECK(set_view_setting(state, "moving_depth", 2.0) == "");
    CHECK(state.options.render.frame_depth == 2);
    CHECK(state.options.render.path.max_depth ==
          ViewState{}.options.render.path.max_depth); // the picture at rest is unchanged
    CHECK(set_view_setting(state, "max_depth", 9.0) == "");
    CHECK(state.options.render.frame_depth == 9);
    CHECK(state.options.render.path.max_depth == 9);
}

TEST_CASE("compatible structures and traversals are chosen together for all kinds of rays") {
    ViewState state;
    CHECK(set_view_setting(state, "structure", "octree") == "");
    CHECK(state.options.render.tracers->camera.traversal == TraversalKind::Octree);
    CHECK(state.options.render.tracers->shadow == state.options.render.tracers->camera);
    CHECK(set_view_setting(state, "traversal", "while-while") == "");
    CHECK(builder_of(state.options.render.tracers->camera.structure).has_value());
    CHECK(set_view_setting(state, "structure", "sbvh") == "");
    CHECK(state.options.render.tracers->bounce.traversal == TraversalKind::WhileWhile);
    CHECK(set_view_setting(state, "rta", "off") == "");
    CHECK_FALSE(state.options.render.tracers->camera.options.rta);
}

TEST_CASE("messages to the page are JSON") {
    Scene scene;
    scene.cameras.push_back({.name = "a \"name\""});
    scene.meshes.resize(1);
    scene.instances.push_back({.name = "<b>", .mesh = 0, .material = 0});
    ViewerStart start;
    start.scene = &scene;
    start.record.scene.scene = "/home/a user/scene\n.gltf";
    start.about = {{"animation", "a \"walk\""}};
    start.record.scene.left_out = {"/home/a user/scene\n.gltf: /home/a user/b.png"};
    ShownFrame frame;
    frame.hash = "0123";
    frame.stages = {{"render", 1.5}};
    ViewNumbers numbers;
    numbers.frame = &frame;
    numbers.flags = "--eye '1'";
    const CameraPath path = {{{.time_s = 0.5, .eye = {1, 2, 3}, .fov_deg = 40}, {.time_s = 2}}};
    numbers.path = &path;
    const PickedPoint point;
    for (const std::string& text : {welcome_text(start), state_text(start.view, numbers), state_text(start.view, {}),
                                    notice_text("error", "\"quoted\""), picked_text(scene, &point, 0.5f, 0.5f),
                                    picked_text(scene, nullptr, 0, 0)}) {
        simdjson::dom::parser parser;
        std::string_view type;
        CHECK_MESSAGE(parser.parse(text)["type"].get_string().get(type) == simdjson::SUCCESS, text);
        CHECK_MESSAGE(text.find("a user") == std::string::npos, text); // no message contains the file's folder
    }
}

TEST_CASE("the flags of a picture are its settings that differ from the defaults, and those of the view") {
    PictureOptions options;
    CHECK(picture_flags(options, "--eye 0,1,2") == "--eye 0,1,2");
    for (const auto& [name, text] : {std::pair("environment", "a b.hdr"),
                                     {"eye", "3,4,5"},
                                     {"exposure", "1.5"},
                                     {"transparent", "true"},
                                     {"size", "64x48"},
                                     {"threads", "2"},
                                     {"integrator", "path"},
                                     {"max_depth", "3"}}) {
        const std::string value = text;
        set_value(options, *find_setting(name), {&value, 1});
    }
    const std::string flags = picture_flags(options, "--eye 0,1,2 --size 32x32");
    CHECK(flags.ends_with(" --eye 0,1,2 --size 32x32")); // the flags of the view are not repeated
    for (const char* shown : {"--environment 'a b.hdr' ", "--exposure 1.5 ", "--transparent --", "--max-depth 3 "})
        CHECK_MESSAGE(flags.find(shown) != std::string::npos, flags);
    for (const char* hidden :
         {"3,4,5", "64x48", "--threads", "--integrator"}) // a default value, and a setting that is not kept
        CHECK_MESSAGE(flags.find(hidden) == std::string::npos, flags);
}

TEST_CASE("clients get file names, never paths") {
    CHECK(file_name("/a/b c/d.gltf") == "d.gltf");
    CHECK(file_name("d.gltf") == "d.gltf");
    CHECK(file_name("../d.gltf") == "d.gltf");
    CHECK(file_name("cornell-box") == "cornell-box");
    CHECK(file_name("a/") == "a/");
    CHECK(without_folders("/a/b/d.gltf: no such texture: /a/b/e.png", "/a/b/d.gltf") ==
          "d.gltf: no such texture: e.png");
    CHECK(without_folders("d.gltf: /x", "d.gltf") == "d.gltf: /x");
    CHECK(without_folders("a/d.gltf: in data/e.png", "a/d.gltf") == "d.gltf: in data/e.png");
    CHECK(without_folders("b/a: files", "b/a/d.gltf") == "a: files");
    const auto outer = std::filesystem::canonical(test::scratch_folder());
    const std::string folder = (outer / "a b").string();
    std::filesystem::create_directories(folder + "/scene/textures");
    const std::string scene = folder + "/scene/d.gltf";
    CHECK(without_folders(scene + ": /nodes/0: " + folder + "/scene/textures/e.png", scene) ==
          "d.gltf: /nodes/0: textures/e.png");
    CHECK(without_folders("\"" + folder + "/other/e.png\"", scene) == "\"other/e.png\""); // the folder does not exist
    CHECK(without_folders("`allow_path=" + folder + "/scene`", scene) == "`allow_path=scene`");
    CHECK(without_folders(folder + "/scene: (" + folder + "/e.png," + folder + ")", scene).find(outer.string()) ==
          std::string::npos);
    CHECK(without_folders("/tmp is full", scene) == "tmp is full");
}

TEST_CASE("layers are displayed in their described colours") {
    const Image normal = {2, 1, 3, {0, 0, 1, 0, 0, 0}};
    CHECK(show_normal(normal).pixels == std::vector<uint8_t>{128, 128, 255, 255, 0, 0, 0, 255});
    const Image depth = {3, 1, 1, {1, 10, 0}};
    const Rgba8Image far = show_depth(depth);
    CHECK(far.pixels[0] > far.pixels[4]); // near surfaces are bright
    CHECK(far.pixels[8] == 0);
    float full = 0;
    const Rgba8Image motion = show_motion({2, 1, 2, {0, 0, -8, 4}}, full);
    CHECK(full == 8);
    CHECK(motion.pixels == std::vector<uint8_t>{128, 128, 128, 255, 0, 191, 159, 255});
    const Rgba8Image deviation = show_deviation({3, 1, 1, {0.1f, 2, 1e4f}}, full);
    CHECK(full == 2);
    CHECK(deviation.pixels[0] < deviation.pixels[4]);
    CHECK(deviation.pixels[4] == deviation.pixels[8]); // unknown values are bright
    const PixelIds ids[] = {{0, 0, 0}, {1, 0, 0}, {0, 5, 0}, {kNoHit, 0, 0}};
    const Rgba8Image instances = show_ids(ids, 4, 1, IdKind::Instance);
    const auto color = [&](std::size_t i) {
        return std::vector(&instances.pixels[4 * i], &instances.pixels[4 * i] + 3);
    };
    CHECK(color(0) == color(2));
    CHECK(color(0) != color(1));
    CHECK(color(3) == std::vector<uint8_t>{0, 0, 0});
    std::vector<RayWork> work(300, {50, 1});
    work[0] = {0, 9};
    uint32_t most = 0;
    const Rgba8Image heat = show_work(work, 300, 1, WorkKind::Nodes, most);
    CHECK(most == 50);
    CHECK(heat.pixels[4] > heat.pixels[0]);
}

TEST_CASE("a frame's header has its numbers at the offsets that the page reads") {
    const FrameHeader header = {.kind = PictureKind::Piece,
                                .flags = 1,
                                .frame = 0x01020304,
                                .input = 5,
                                .samples = 6,
                                .width = 0x0708,
                                .height = 9,
                                .full_width = 10,
                                .full_height = 11,
                                .offset = 12,
                                .total = 13};
    const auto bytes = bytes_of(header);
    CHECK(bytes[0] == 1);
    CHECK(bytes[1] == 2);
    CHECK(bytes[2] == 1);
    CHECK(bytes[4] == 4);
    CHECK(bytes[7] == 1);
    CHECK(bytes[8] == 5);
    CHECK(bytes[12] == 6);
    CHECK(bytes[16] == 8);
    CHECK(bytes[17] == 7);
    CHECK(bytes[22] == 11);
    CHECK(bytes[24] == 12);
    CHECK(bytes[28] == 13);
}

TEST_CASE("a reduced picture has the means of its pixels") {
    Rgba8Image picture = {4, 3, std::vector<uint8_t>(48, 255)};
    for (std::size_t i = 0; i < 12; ++i) picture.pixels[4 * i] = static_cast<uint8_t>(10 * i);
    const Rgba8Image half = shrunk(picture, 2);
    CHECK(half.width == 2);
    CHECK(half.height == 1);
    CHECK(half.pixels[0] == (0 + 10 + 40 + 50) / 4);
    CHECK(half.pixels[3] == 255);
    CHECK(shrunk(picture, 1).pixels == picture.pixels);
    CHECK(shrunk(picture, 16).width == 1);
}
