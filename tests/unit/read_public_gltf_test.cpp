// The public sample models, where PERTEV_SCENES has them: all load, with the triangle counts of its table.

#include <doctest/doctest.h>

#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "formats/gltf/read_gltf.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;

namespace {

struct Sample {
    std::string file;
    uint64_t triangles;
};

const Sample kSamples[] = {
    {"BoxTextured/BoxTextured.gltf", 12},
    {"BoxInterleaved/BoxInterleaved.glb", 12},
    {"BoxVertexColors/BoxVertexColors.glb", 12},
    {"VertexColorTest/VertexColorTest.glb", 36},
    {"Cameras/Cameras.gltf", 2},
    {"SimpleSparseAccessor/SimpleSparseAccessor.gltf", 12},
    {"SimpleSkin/SimpleSkin.gltf", 8},
    {"InterpolationTest/InterpolationTest.glb", 110},
    {"MorphPrimitivesTest/MorphPrimitivesTest.glb", 32},
    {"DamagedHelmet/DamagedHelmet.glb", 15'452},
    {"NormalTangentTest/NormalTangentTest.glb", 7'774},
    {"TextureSettingsTest/TextureSettingsTest.glb", 72},
    {"TextureTransformTest/TextureTransformTest.gltf", 18},
    {"AlphaBlendModeTest/AlphaBlendModeTest.glb", 61},
    {"MetalRoughSpheresNoTextures/MetalRoughSpheresNoTextures.glb", 1'040'409},
    {"TransmissionTest/TransmissionTest.glb",
     128'763}, // the table has 12 more: a box that two meshes share is one here
    {"AttenuationTest/AttenuationTest.glb", 232},
    {"EmissiveStrengthTest/EmissiveStrengthTest.glb", 90},
    {"SpecularTest/SpecularTest.glb", 44'828},
    {"ClearCoatTest/ClearCoatTest.glb", 37'116},
    {"SheenChair/SheenChair.gltf", 39'936},
    {"NegativeScaleTest/NegativeScaleTest.glb", 3'884},
    {"UnlitTest/UnlitTest.glb", 88},
    {"SimpleInstancing/SimpleInstancing.glb", 12},
};

std::optional<Scene> read_sample(const std::string& file, Messages& messages) {
    const auto path = test::test_scene(std::filesystem::path("gltf") / file);
    if (!path) return std::nullopt;
    return read_gltf(*path, FileAccess(*path, {}), {}, messages);
}

/// Counts like the table: each mesh with each of its materials once, however many instances show it.
uint64_t count_triangles(const Scene& scene) {
    std::set<std::pair<uint32_t, uint32_t>> parts;
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) {
        const bool is_new = parts.emplace(instance.mesh, instance.material).second;
        if (is_new) triangles += scene.meshes.at(instance.mesh).triangle_count();
    }
    return triangles;
}

} // namespace

TEST_CASE("every public glTF sample loads with the triangles of its table") {
    for (const Sample& sample : kSamples) {
        CAPTURE(sample.file);
        Messages messages;
        const auto start = std::chrono::steady_clock::now();
        const std::optional<Scene> scene = read_sample(sample.file, messages);
        if (!scene) return;
        const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
        MESSAGE(sample.file << ": " << ms.count() << " ms, " << scene->meshes.size() << " meshes, "
                            << scene->instances.size() << " instances, " << scene->images.size() << " images, "
                            << count_triangles(*scene) << " triangles");
        for (const Message& message : messages.all()) MESSAGE(message.text << " (" << message.times << ")");
        CHECK(count_triangles(*scene) == sample.triangles);
    }
}

TEST_CASE("the instancing sample shows 125 instances of one mesh") {
    Messages messages;
    const std::optional<Scene> scene = read_sample("SimpleInstancing/SimpleInstancing.glb", messages);
    if (!scene) return;
    CHECK(scene->meshes.size() == 1);
    CHECK(scene->instances.size() == 125);
}
