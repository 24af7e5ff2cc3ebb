// Files with null members, unbounded numbers, unusual padding or names from another machine are read, as other viewers
// do. Unsupported parts are left out with a warning.

#include <cstring>
#include <filesystem>
#include <limits>
#include <span>

#include <doctest/doctest.h>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "formats/gltf/draco.h"
#include "formats/gltf/read_gltf.h"
#include "formats/gltf/uri.h"
#include "image/decode_webp.h"
#include "scene/validate/validate.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;
using test::GltfBuilder;

namespace read_gltf_left_out_test { // test files are compiled together

GltfBuilder triangle() {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    return builder;
}

constexpr const char* kMesh = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)";

std::string triangle_with(const std::string& members) { return triangle().json(kMesh + members); }

Light emitter(const std::string& members) {
    const Scene scene = test::read_gltf_text(
        triangle_with(R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point",)" + members +
                      R"(}]}},"nodes":[{"extensions":{"KHR_lights_punctual":{"light":0}}}])"));
    return scene.lights.at(0);
}

/// Returns the messages of reading and validation. The text of an Error comes last.
std::vector<std::string> left_out_of(const std::string& json) {
    Messages messages;
    std::vector<std::string> texts;
    std::string error;
    try {
        Scene scene = test::read_gltf_text(json, messages);
        validate(scene, "model.gltf", messages);
    } catch (const Error& fault) {
        error = fault.what();
    }
    texts = messages.left_out();
    if (!error.empty()) texts.push_back("error: " + error);
    return texts;
}

Scene read_glb(std::vector<std::byte> bytes, Messages& messages) {
    const auto path = test::scratch_folder() / "model.glb";
    write_file_atomically(path, bytes);
    return read_gltf(path, FileAccess(path, {}), {}, messages);
}

uint32_t u32_at(const std::vector<std::byte>& bytes, std::size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

void set_u32(std::vector<std::byte>& bytes, std::size_t at, std::size_t value) {
    const auto number = static_cast<uint32_t>(value);
    std::memcpy(bytes.data() + at, &number, sizeof number);
}

TEST_CASE("a member that is null counts as absent") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        triangle_with(
            R"("extensionsUsed":null,"extensionsRequired":null,"animations":null,"skins":null,"scene":null,)"
            R"("extensions":null,"cameras":[null],"materials":[{"name":null,"pbrMetallicRoughness":null,)"
            R"("normalTexture":null,"alphaMode":null,"alphaCutoff":null,"extensions":null}],"nodes":[)"
            R"({"mesh":0,"name":null,"camera":null,"skin":null,"children":null,"matrix":null,)"
            R"("translation":null,"rotation":null,"weights":null,"extensions":{"KHR_lights_punctual":null}}])"),
        messages);
    CHECK(scene.instances.size() == 1);
    CHECK(scene.nodes.at(0).parent == kNoNode);
    CHECK(messages.all().empty());
}

TEST_CASE("a null element is read as an empty object") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        triangle_with(R"("nodes":[null,{"mesh":0,"children":[null,0]}],"animations":[{"channels":[null]},null])"),
        messages);
    CHECK(scene.instances.size() == 1);
    CHECK(scene.nodes[0].parent == 1);
    CHECK(messages.left_out().size() == 2); // the child and the channel
}

TEST_CASE("a number beyond the largest float becomes the largest, and a range of that size is unlimited") {
    for (const std::string range : {"3.40282347E+38", "3.4028234663852886e+38", "1.7976931348623157e+308"}) {
        const Light light = emitter("\"range\":" + range);
        CHECK(light.range == std::numeric_limits<float>::max());
    }
    const Light bright = emitter(R"("intensity":1e300,"color":[1,2,0])");
    CHECK(is_finite(bright.intensity));
    CHECK(bright.intensity.b == 0);
}

TEST_CASE("numbers beyond 64 bits or doubles, and substitutes for them, affect only themselves") {
    const std::string whole = "340282346638528859811704183484516925440"; // C#'s largest float
    for (const std::string& range : {whole, std::string("1e400"), std::string("Infinity")}) {
        CAPTURE(range);
        const Light light =
            emitter("\"range\":" + range + ",\"intensity\":7,\"extras\":[123456789012345678901234567890,-1e999]");
        CHECK(light.range == std::numeric_limits<float>::max());
        CHECK(light.intensity == grey(7));
    }
    CHECK(emitter("\"range\":NaN,\"intensity\":7").range == 0);
    CHECK(emitter("\"range\":-1e400").range == 0);
    CHECK(emitter("\"range\":-1").intensity == grey(1));
    CHECK(emitter("\"range\":\"far\",\"intensity\":3").intensity == grey(3));
    CHECK(emitter("\"intensity\":-2,\"range\":5").range == 5);
    CHECK(emitter("\"color\":[1,-1,2],\"intensity\":2").intensity == Rgb{2, 0, 4});
    CHECK(emitter("\"color\":[1,1],\"intensity\":2").intensity == grey(2));
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0},
                ",\"min\":[NaN,0,0],\"max\":[-Infinity,1.#QNAN,0]");
    Messages messages;
    CHECK(
        test::read_gltf_text(builder.json(std::string(kMesh) + R"("nodes":[{"mesh":0}])"), messages).instances.size() ==
        1);
    CHECK(messages.all().size() == 1);
    CHECK(messages.left_out().empty());
}

TEST_CASE("texts that are not valid Unicode are read with U+FFFD, and zero bytes after a document are padding") {
    for (const auto& [name, read] : {std::pair("K\xfc"
                                               "che",
                                               "K\xef\xbf\xbd"
                                               "che"),
                                     {"\\ud800", "\xef\xbf\xbd"},
                                     {"a\tb", "a\tb"},
                                     {"\\udc00\\ud83d\\ude00", "\xef\xbf\xbd\xf0\x9f\x98\x80"}}) {
        CAPTURE(name);
        Messages messages;
        const Scene scene = test::read_gltf_text(
            triangle_with(R"("nodes":[{"mesh":0,"name":")" + std::string(name) + "\"}]"), messages);
        CHECK(scene.nodes.at(0).name == read);
        CHECK(messages.all().size() == 1);
    }
    const std::string text = triangle_with(R"("nodes":[{"mesh":0}])");
    CHECK(test::read_gltf_text(text + std::string(3, '\0')).instances.size() == 1);
}

TEST_CASE("a version that is a number, and extensions that are not an object, are tolerated") {
    std::string text = triangle_with(R"("nodes":[{"mesh":0}],"extensions":{"KHR_lights_punctual":[]})");
    text.replace(text.find("\"2.0\""), 5, "2.0");
    Messages messages;
    CHECK(test::read_gltf_text(text, messages).instances.size() == 1);
    CHECK(messages.all().size() == 1);
}

TEST_CASE("an unsupported and unlisted extension is reported once") {
    const std::vector<std::string> left_out = left_out_of(triangle().json(
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0,"extras":)"
        R"({"extensions":{"EXT_private":{}}}},{"extensions":{"EXT_none":null}}],"materials":[{"extensions":)"
        R"({"KHR_materials_scatter":{"scatter":1},"KHR_materials_ior":{}}},{"extensions":)"
        R"({"KHR_materials_scatter":{}}}])"));
    REQUIRE(left_out.size() == 1);
    CHECK(left_out[0].find("model.gltf: /materials/0/extensions/KHR_materials_scatter: ") != std::string::npos);
}

TEST_CASE("a node keeps the readable parts of its transform") {
    const auto pose = [](const std::string& members) {
        return std::get<NodePose>(
            test::read_gltf_text(triangle_with(R"("nodes":[{"mesh":0,)" + members + "}]")).nodes.at(0).pose);
    };
    const NodePose turned = pose(R"("translation":[1,2,3],"rotation":[0,0,0,0],"scale":[2,2,2])");
    CHECK(turned.translation == DoubleVec3{1, 2, 3});
    CHECK(turned.rotation == std::array<double, 4>{0, 0, 0, 1});
    CHECK(turned.scale == DoubleVec3{2, 2, 2});
    CHECK(pose(R"("translation":[1,2],"scale":[2,2,2])").scale == DoubleVec3{2, 2, 2});
    CHECK(pose(R"("matrix":[1,2],"scale":[2,2,2])").scale == DoubleVec3{2, 2, 2});
}

TEST_CASE("a camera keeps its readable properties") {
    const auto camera = [](const std::string& members) {
        return test::read_gltf_text(triangle_with(R"("cameras":[{"type":"perspective","perspective":{)" + members +
                                                  R"(}}],"nodes":[{"mesh":0},{"camera":0}])"))
            .cameras.at(0);
    };
    CHECK(camera(R"("yfov":1,"aspectRatio":0)").fov_y == 1);
    CHECK(camera(R"("yfov":1,"aspectRatio":0)").aspect == 0);
    CHECK(camera(R"("yfov":45,"aspectRatio":2)").aspect == 2);
    CHECK(camera(R"("yfov":45)").fov_y == Camera().fov_y);
}

TEST_CASE("a skin without weights, or with matrices that are not finite, is left out and the mesh is kept") {
    GltfBuilder builder = triangle();
    builder.add("VEC4", std::vector<uint16_t>(12));
    builder.add("VEC4", std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    std::vector<float> matrix(16);
    matrix[0] = matrix[5] = matrix[10] = matrix[15] = 1;
    matrix[13] = std::numeric_limits<float>::quiet_NaN();
    builder.add("MAT4", matrix);
    const auto positions = [&](const std::string& weights, const std::string& matrices) {
        Messages messages;
        Scene scene = test::read_gltf_text(
            builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"JOINTS_0":1)" + weights +
                         R"(}}]}],"skins":[{"joints":[1])" + matrices + R"(}],"nodes":[{"mesh":0,"skin":0},{}])"),
            messages);
        validate(scene, "model.gltf", messages);
        CHECK(messages.left_out().size() == 1);
        return scene.meshes.at(0).positions;
    };
    const std::vector<Vec3> as_in_file = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    CHECK(positions("", "") == as_in_file);
    CHECK(positions(R"(,"WEIGHTS_0":2)", R"(,"inverseBindMatrices":3)") == as_in_file);
}

TEST_CASE("triangles beyond all limits are left out, and the others are kept") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1e30f, 0});
    Messages messages;
    Scene scene = test::read_gltf_text(builder.json(std::string(kMesh) + R"("nodes":[{"mesh":0}])"), messages);
    validate(scene, "model.gltf", messages);
    CHECK(scene.meshes.at(0).triangle_count() == 1);
    CHECK(messages.left_out().size() == 1);
    CHECK(length(bounds_of(scene).size()) < 2);
}

TEST_CASE("primitives beyond all limits are left out, and the rest is kept") {
    Messages messages;
    Scene scene = test::read_gltf_text(
        triangle_with(R"("cameras":[{"type":"perspective","perspective":{"yfov":1}}],"nodes":[{"mesh":0},)"
                      R"({"mesh":0,"translation":[1e300,0,0]},{"camera":0,"translation":[0,-1e39,0]},)"
                      R"({"mesh":0,"scale":[1e300,1,1],"children":[4]},{"mesh":0,"scale":[1e300,1,1]}])"),
        messages);
    validate(scene, "model.gltf", messages);
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.instances[0].node == 0);
    CHECK(scene.cameras.empty());
    CHECK(messages.left_out().size() == 4);
}

TEST_CASE("a GLB's JSON may be padded with zero bytes, and its header may give a wrong length") {
    const std::vector<std::byte> good = triangle().glb(std::string(kMesh) + R"("nodes":[{"mesh":0}])");
    Messages silent;
    CHECK(read_glb(good, silent).instances.size() == 1);
    CHECK(silent.all().empty());

    std::vector<std::byte> padded = good;
    padded.insert(padded.begin() + 20 + u32_at(good, 12), 4, std::byte{});
    set_u32(padded, 8, padded.size());
    set_u32(padded, 12, u32_at(good, 12) + 4);
    CHECK(read_glb(padded, silent).instances.size() == 1);
    CHECK(silent.all().empty());

    const std::size_t json_end = 20 + u32_at(good, 12);
    for (const std::size_t length : {good.size() + 4, std::size_t(0), good.size() - 4, json_end}) {
        CAPTURE(length);
        std::vector<std::byte> wrong = good;
        set_u32(wrong, 8, length);
        Messages messages;
        CHECK(read_glb(wrong, messages).instances.size() == 1);
        CHECK(messages.left_out().empty());
    }
    for (const int off : {-4, -1, 1, 4, 8, 1 << 24}) { // the error of the JSON's length; the contents determine its end
        CAPTURE(off);
        std::vector<std::byte> wrong = good;
        set_u32(wrong, 12, u32_at(good, 12) + static_cast<uint32_t>(off));
        Messages messages;
        CHECK(read_glb(wrong, messages).instances.size() == 1);
        CHECK(messages.left_out().empty());
        CHECK(messages.all().size() == 1);
    }
    std::vector<std::byte> short_binary = good;
    set_u32(short_binary, json_end, 10);
    CHECK(read_glb(short_binary, silent).instances.size() == 1);
    CHECK(silent.left_out().empty());
    std::vector<std::byte> cut_off(good.begin(), good.end() - 4);
    Messages messages;
    CHECK(read_glb(cut_off, messages).instances.empty());
    CHECK(test::has_warning(messages, {"model.glb: byte", "truncated", "left out"}));
}

TEST_CASE("a primitive with only compressed data is left out, with the command that converts the file") {
    if (gltf::has_draco()) return;
    const std::string draco = R"("extensionsRequired":["KHR_draco_mesh_compression"],)"
                              R"("accessors":[{"componentType":5126,"type":"VEC3","count":3}],)";
    const std::string compressed =
        R"({"attributes":{"POSITION":0},"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{}}}})";
    const std::string command = "gltf-transform/cli copy \"model.gltf\" \"model-converted.gltf\"";
    const std::vector<std::string> left_out =
        left_out_of(R"({"asset":{"version":"2.0"},)" + draco + R"("meshes":[{"primitives":[)" + compressed +
                    R"(]}],"nodes":[{"mesh":0}]})");
    REQUIRE(left_out.size() == 2);
    CHECK(
        left_out[0].find("model.gltf: /meshes/0/primitives/0: a primitive compressed by KHR_draco_mesh_compression") !=
        std::string::npos);
    CHECK(left_out[0].find(command) != std::string::npos);
    CHECK(left_out[1].starts_with("error: "));
    CHECK(left_out[1].find(command) != std::string::npos);

    // It is not needed next to uncompressed data.
    CHECK(left_out_of(triangle().json(R"("extensionsUsed":["KHR_draco_mesh_compression"],"meshes":[{"primitives":[)" +
                                      compressed + R"(]}],"nodes":[{"mesh":0}])"))
              .empty());
}

TEST_CASE("a texture with only an unsupported image is left out, with the command that converts the file") {
    for (const auto& [extension, command] :
         {std::pair("KHR_texture_basisu", "cli ktxdecompress "), std::pair("MSFT_texture_dds", "magick ")}) {
        CAPTURE(extension);
        const std::vector<std::string> left_out = left_out_of(triangle().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"materials":[)"
            R"({"emissiveTexture":{"index":0}}],"textures":[{"extensions":{")" +
            std::string(extension) + R"(":{"source":0}}}],"images":[{"uri":"a.ktx2"}])"));
        REQUIRE(left_out.size() == 1);
        CHECK(left_out[0].find("/textures/0") != std::string::npos);
        CHECK(left_out[0].find(command) != std::string::npos);
    }
}

TEST_CASE("an image of an unsupported format is left out with the command, wherever it is stored") {
    const std::string webp = "UklGRiQAAABXRUJQVlA4IAAAAAA=", ktx = "q0tUWCAyMLsNChoKAAAAAA==";
    for (const auto& [bytes, command] : {std::pair(webp, "cli png "), {ktx, "cli ktxdecompress "}}) {
        const std::vector<std::string> left_out = left_out_of(triangle().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"materials":[)"
            R"({"emissiveTexture":{"index":0}}],"textures":[{"source":0}],"images":[{"uri":"data:;base64,)" +
            bytes + "\"}]"));
        REQUIRE(left_out.size() == 1);
        if (bytes == webp && has_webp()) continue; // it is damaged
        CHECK(left_out[0].find(command) != std::string::npos);
    }
}

TEST_CASE("an image's name may be absolute, of another system, a file: URI or contain a percent sign") {
    const auto folder = test::scratch_folder();
    const std::string png =
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
    const auto read = [&](const std::string& uri, Messages& messages) {
        const auto path = folder / "model.gltf";
        const std::string text = triangle().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"materials":[)"
            R"({"emissiveTexture":{"index":0}}],"textures":[{"source":0}],"images":[{"uri":")" +
            uri + "\"}]");
        write_file_atomically(path, std::as_bytes(std::span(text)));
        return read_gltf(path, FileAccess(path, {}), {}, messages);
    };
    const std::optional<std::vector<std::byte>> picture = gltf::decode_data_uri("data:;base64," + png);
    for (const char* name : {"a.png", "100%.png", "b%20c.png"}) write_file_atomically(folder / name, *picture);
    for (const std::string& uri :
         std::vector<std::string>{"file:///C:/model/a.png", "C:\\\\model\\\\a.png", "/model/a.png", "100%.png",
                                  "100%25.png", "b%20c.png", "DATA:image/png;base64," + png}) {
        CAPTURE(uri);
        Messages messages;
        CHECK(read(uri, messages).images.size() == 1);
        CHECK(messages.left_out().empty());
    }
    for (const std::string uri :
         {"file:///C:/model/gone.png", "C:\\\\model\\\\gone.png", "gone%.png", "http://a/b.png"}) {
        CAPTURE(uri);
        Messages messages;
        const Scene scene = read(uri, messages);
        CHECK(scene.instances.size() == 1);
        CHECK(scene.images.empty());
        CHECK(messages.left_out().size() == 1);
        CHECK(test::has_warning(messages, {"model.gltf: /images/0/uri"}));
    }
}

TEST_CASE("an attribute that cannot be read is left out, and the primitive is kept") {
    GltfBuilder builder = triangle();
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0});
    Messages messages;
    const Scene scene = test::read_gltf_text(
        builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1,"NORMAL":9}},)"
                     R"({"attributes":{"POSITION":9}}]}],"nodes":[{"mesh":0}])"),
        messages);
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.meshes[0].uv[0].empty());
    CHECK(scene.meshes[0].normals.empty());
    CHECK(messages.left_out().size() == 3);
}

TEST_CASE("only the unreadable property of a material is left out") {
    Messages messages;
    const Scene scene = test::read_gltf_text(
        triangle().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],)"
            R"("materials":[{"alphaMode":"GLASS","emissiveFactor":[1,2],"pbrMetallicRoughness":)"
            R"({"baseColorFactor":[0.25,0.5,1,1],"baseColorTexture":{"index":5}},"doubleSided":true}])"),
        messages);
    const Material& material = scene.materials.at(0);
    CHECK(material.base_color == Rgb{0.25f, 0.5f, 1});
    CHECK(material.alpha_mode == AlphaMode::Opaque);
    CHECK(material.double_sided);
    CHECK(messages.left_out().size() == 3);

    const Scene other = test::read_gltf_text(
        triangle().json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],"materials":[)"
            R"({"alphaMode":"BLEND","alphaCutoff":"high","pbrMetallicRoughness":{"baseColorFactor":[1,0,0],)"
            R"("metallicFactor":[],"roughnessFactor":0.25}}])"),
        messages);
    CHECK(other.materials.at(0).roughness == 0.25f);
    CHECK(other.materials.at(0).base_color == grey(1));
    CHECK(other.materials.at(0).alpha_mode == AlphaMode::Blend);
}

} // namespace read_gltf_left_out_test
