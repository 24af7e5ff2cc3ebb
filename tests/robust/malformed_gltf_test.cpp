// Malformed glTF files cause an Error that names the file, or a scene, within seconds.

#include <doctest/doctest.h>

#include <span>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/read_file.h"
#include "formats/gltf/read_gltf.h"
#include "scene/pose/posed_scene.h"
#include "scene/validate/validate.h"
#include "tests/support/cpu_seconds.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

/// Tests that every number is finite at some times of a valid scene, or that there is an Error.
void play(Scene scene) {
    PosedScene posed(std::move(scene));
    for (const double time_s : {-1.0, 0.25, 1.0, 1e300}) {
        if (test::thrown_error([&] { posed.set_time(time_s); })) continue;
        const Scene& now = posed.scene();
        bool finite = true;
        for (const Mesh& mesh : now.meshes) {
            for (const Vec3 p : mesh.positions) finite = finite && is_finite(p);
            for (const Vec3 n : mesh.normals) finite = finite && is_finite(n);
        }
        for (const Instance& instance : now.instances) finite = finite && !is_singular(instance.world_from_local);
        for (const Camera& camera : now.cameras) finite = finite && !is_singular(camera.world_from_camera);
        for (const Light& light : now.lights)
            finite = finite && is_finite(light.position) && is_finite(light.intensity);
        CHECK(finite);
    }
}

/// Returns the text of the Error; "" if there is a scene, which is then played. `messages` receives the messages.
std::string read_outcome(const fs::path& path, std::vector<std::byte> bytes, Messages& messages) {
    std::optional<Scene> scene;
    try {
        scene = read_gltf(path, std::move(bytes), FileAccess(path, {}), {}, messages);
        validate(*scene, path.string(), messages);
    } catch (const Error& error) {
        return error.what();
    }
    play(*std::move(scene));
    return "";
}

/// A document that uses most of the format.
std::string rich_document() {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    builder.add("SCALAR", std::vector<uint16_t>{0, 1, 2, 3});
    builder.add("VEC4", std::vector<uint8_t>{0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
    builder.add("VEC4", std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    builder.add("VEC2", std::vector<uint16_t>{0, 1, 2, 3, 4, 5, 6, 7}, ",\"normalized\":true");
    builder.add_view(std::vector<uint8_t>{1, 3});
    builder.add_view(std::vector<float>{1, 2, 3, 4, 5, 6});
    builder.add_accessor(R"("componentType":5126,"type":"VEC3","count":4,"sparse":{"count":2,"indices":)"
                         R"({"bufferView":5,"componentType":5121},"values":{"bufferView":6}})");
    builder.add("SCALAR", std::vector<float>{0, 2});                                          // 6
    builder.add("VEC4", std::vector<float>{0, 0, 0, 1, 0, 1, 0, 0});                          // 7
    builder.add("SCALAR", std::vector<float>{0.5f, 0, 0, 0, 1, 0}, ",\"name\":\"a spline\""); // 8
    return builder.json(
        R"("extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot",)"
        R"("spot":{"innerConeAngle":0.1}}]}},"meshes":[{"weights":[1],"primitives":[{"mode":5,"indices":1,"material":0,)"
        R"("attributes":{"POSITION":0,"TEXCOORD_0":4,"JOINTS_0":2,"WEIGHTS_0":3},"targets":[{"POSITION":5}]}]}],)"
        R"("materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
        R"({"rotation":1}}}},"alphaMode":"MASK"}],"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],)"
        R"("images":[{"bufferView":4}],"skins":[{"joints":[1,2]}],"cameras":[{"type":"perspective","perspective":)"
        R"({"yfov":1}}],"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"skin":0},{"children":[2],)"
        R"("extensions":{"KHR_lights_punctual":{"light":0}}},{"camera":0,"rotation":[0,0,0,1],"scale":[1,2,3]}],)"
        R"("animations":[{"samplers":[{"input":6,"output":7},{"input":6,"output":8,"interpolation":"CUBICSPLINE"}],)"
        R"("channels":[{"sampler":0,"target":{"node":2,"path":"rotation"}},)"
        R"({"sampler":1,"target":{"node":0,"path":"weights"}},{"sampler":1,"target":{"path":"pointer","extensions":)"
        R"({"KHR_animation_pointer":{"pointer":"/cameras/0/perspective/yfov"}}}}]}])");
}

} // namespace

TEST_CASE("every public malformed glTF file causes an Error that names it, or a scene, within 5 s") {
    const auto folder = test::test_scene("malformed/gltf");
    if (!folder) return;
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(*folder)) {
        const fs::path path = entry.path();
        if (path.extension() != ".gltf" && path.extension() != ".glb") continue;
        CAPTURE(path.string());
        const double start = test::cpu_seconds();
        Messages messages;
        const std::string outcome = read_outcome(path, read_file(path), messages);
        const double seconds = test::cpu_seconds() - start;
        MESSAGE(path.filename().string() << ": " << (outcome.empty() ? "a scene" : outcome));
        if (!outcome.empty()) CHECK(outcome.find(path.filename().string()) != std::string::npos);
        CHECK(seconds < test::allowed_seconds(5));
        ++files;
    }
    CHECK(files >= 20);
}

TEST_CASE("no change of a single number in a document crashes the reader") {
    const std::string good = rich_document();
    const fs::path path = test::scratch_folder() / "model.gltf";
    const auto is_complete = [&](const std::string& text) {
        const auto bytes = std::as_bytes(std::span(text));
        Messages messages;
        return read_outcome(path, {bytes.begin(), bytes.end()}, messages).empty() &&
               messages.left_out().size() <= 1; // its image
    };
    REQUIRE(is_complete(good));
    const std::vector<std::string> others = {"-1",    "7",  "4294967295", "9007199254740991", "1e300", "1e999", "null",
                                             "\"x\"", "[]", "{}"};
    int faults = 0;
    for (std::size_t at = 1; at < good.size(); ++at) {
        const bool is_number =
            good[at] >= '0' && good[at] <= '9' && (good[at - 1] == ':' || good[at - 1] == '[' || good[at - 1] == ',');
        if (!is_number) continue;
        const std::size_t end = good.find_first_not_of("0123456789.", at);
        for (const std::string& other : others) {
            faults += is_complete(good.substr(0, at) + other + good.substr(end)) ? 0 : 1;
        }
    }
    CHECK(faults > 300); // most of these changes are invalid
}

TEST_CASE("a document truncated anywhere is an Error") {
    const std::string good = rich_document();
    const fs::path path = test::scratch_folder() / "model.gltf";
    for (std::size_t size = 0; size < good.size(); size += 31) {
        const auto bytes = std::as_bytes(std::span(good).first(size));
        Messages messages;
        CHECK(!read_outcome(path, {bytes.begin(), bytes.end()}, messages).empty());
    }
}
