// Geometry compressed by Draco and pictures by WebP, nodes that are hidden, and further sets of texture coordinates.

#include <doctest/doctest.h>

#include "formats/gltf/draco.h"
#include "formats/gltf/uri.h"
#include "image/decode_image.h"
#include "image/decode_webp.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using test::GltfBuilder;

namespace read_gltf_compressed_test { // test files are compiled together

/// A square of four vertices with normals and texture coordinates, by draco_encoder 1.5.5.
const std::string kSquareByDraco =
    "RFJBQ08CAgEBAAAABAICAgAAAR//ARH/ARH/ARED/wAAAAAAAQAAAQAJAwAAAgEDCQIAAQIBAQkDAAIDAQEBAAMDATABEAMA"
    "KIKYAAAAAAD/PwAAAAAAAAAAAAAAAAAAAACAPw4FAQEAAgMBQAEADAIAAACAAoBwAAAAAP8PAAAAAAAAAAAAAAAAgD8MBgMB"
    "AQEBAUABAP8DAAD/AQAA/wJEQAo=";
/// Red, half transparent green; blue, clear (10, 20, 30): 2 x 2 pixels, lossless, by cwebp 1.2.4.
const std::string kWebp = "UklGRjoAAABXRUJQVlA4TC4AAAAvAUAAEB8gEEiS2B91DSEBQfX/L4EAwYj/SwIBQjrlAm9ZqoSSAAFQlJGI/gcD";

std::vector<std::byte> bytes_of(const std::string& base64) {
    return *gltf::decode_data_uri("data:application/octet-stream;base64," + base64);
}

/// A document with the square of `stream`, whose accessors have `count` vertices.
std::string square(const std::vector<std::byte>& stream, int count = 4) {
    GltfBuilder builder;
    builder.add_view_of_bytes(stream);
    const auto accessor = [&](const std::string& type, int component, int elements) {
        builder.add_accessor("\"componentType\":" + std::to_string(component) + ",\"type\":\"" + type +
                             "\",\"count\":" + std::to_string(elements));
    };
    accessor("VEC3", 5126, count);
    accessor("VEC2", 5126, count);
    accessor("VEC3", 5126, count);
    accessor("SCALAR", 5123, 6);
    return builder.json(
        R"("extensionsRequired":["KHR_draco_mesh_compression"],"meshes":[{"primitives":[{"attributes":{"POSITION":0,)"
        R"("TEXCOORD_0":1,"NORMAL":2},"indices":3,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,)"
        R"("attributes":{"POSITION":0,"TEXCOORD_0":1,"NORMAL":2}}}}]}],"nodes":[{"mesh":0}])");
}

std::string sheet(const std::string& members) {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    for (float i = 0; i < 4; ++i) builder.add("VEC2", std::vector<float>{i, i, i, i, i, i});
    return builder.json(members);
}

const std::string kImageOfWebp = R"("images":[{"uri":"data:image/webp;base64,)" + kWebp + R"("}])";

} // namespace read_gltf_compressed_test

using namespace read_gltf_compressed_test;

TEST_CASE("Draco's geometry is that of its accessors") {
    if (!gltf::has_draco()) return;
    Messages messages;
    const Scene scene = test::read_gltf_text(square(bytes_of(kSquareByDraco)), messages);
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    REQUIRE(mesh.positions.size() == 4);
    CHECK(mesh.indices.size() == 6);
    for (std::size_t i = 0; i < 4; ++i) { // x and y are u and v in the file that was compressed
        CHECK(mesh.positions[i].x == doctest::Approx(mesh.uv[0].at(i).x).epsilon(1e-3));
        CHECK(mesh.normals.at(i).z == doctest::Approx(1).epsilon(1e-3));
    }
    float area = 0;
    for (std::size_t i = 0; i < 6; i += 3) {
        const auto corner = [&](std::size_t k) { return mesh.positions[mesh.indices[i + k]]; };
        area += 0.5f * cross(corner(1) - corner(0), corner(2) - corner(0)).z;
    }
    CHECK(area == doctest::Approx(1).epsilon(1e-3));
    CHECK(messages.left_out().empty());
}

TEST_CASE("a damaged Draco stream, or one that does not fit its accessors, is left out with the reason") {
    if (!gltf::has_draco()) return;
    const std::vector<std::byte> whole = bytes_of(kSquareByDraco);
    for (const std::size_t size : {std::size_t(5), whole.size() / 2}) {
        const std::vector<std::byte> torn(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        CHECK(test::gltf_fault(square(torn)).find("KHR_draco_mesh_compression") != std::string::npos);
    }
    CHECK(test::gltf_fault(square(whole, 5)).find("4 vertices") != std::string::npos);
    for (std::size_t at = 0; at < whole.size(); ++at) { // whatever a damaged byte does, it ends in a message or a mesh
        for (const int change : {1, 0x80, 0xff}) {
            std::vector<std::byte> damaged = whole;
            damaged[at] ^= std::byte(change);
            test::gltf_fault(square(damaged));
        }
    }
}

TEST_CASE("WebP textures are read, with their alpha") {
    if (!has_webp()) return;
    const auto picture = std::get<Rgba8Image>(decode_image(bytes_of(kWebp), "a.webp"));
    CHECK(picture.width == 2);
    CHECK(picture.pixels == std::vector<uint8_t>{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255, 10, 20, 30, 0});
    Messages messages;
    const Scene scene = test::read_gltf_text(
        sheet(kImageOfWebp +
              R"(,"extensionsRequired":["EXT_texture_webp"],"textures":[{"extensions":{"EXT_texture_webp":)"
              R"({"source":0}}}],"materials":[{"emissiveTexture":{"index":0}}],"meshes":[{"primitives":[)"
              R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"nodes":[{"mesh":0}])"),
        messages);
    REQUIRE(scene.images.size() == 1);
    CHECK(scene.images[0].rgba8.pixels == picture.pixels);
    CHECK(messages.left_out().empty());
}

TEST_CASE("a torn WebP file is an error that names it") {
    if (!has_webp()) return;
    const std::vector<std::byte> whole = bytes_of(kWebp);
    for (std::size_t size = 12; size < whole.size() - 8; ++size) {
        const std::vector<std::byte> torn(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        const auto error = test::thrown_error([&] { decode_image(torn, "a.webp"); });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::BadInput);
        CHECK(test::says(error, "a.webp"));
    }
}

TEST_CASE("a texture with a fallback beside a kind that is not read uses it without a warning") {
    for (const char* extension : {"KHR_texture_basisu", "MSFT_texture_dds", "EXT_texture_avif"}) {
        Messages messages;
        const Scene scene = test::read_gltf_text(
            sheet(
                R"("images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4)"
                R"(z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"},{"uri":"a.dds"}],"extensionsUsed":[")" +
                std::string(extension) + R"("],"textures":[{"source":0,"extensions":{")" + extension +
                R"(":{"source":1}}}],"materials":[{"emissiveTexture":{"index":0}}],"meshes":[{"primitives":[)"
                R"({"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"nodes":[{"mesh":0}])"),
            messages);
        CHECK(scene.images.size() == 1);
        CHECK(messages.left_out().empty());
    }
}

TEST_CASE("KHR_node_visibility hides meshes and lights of a node and of all below it") {
    const std::string lights = R"("extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},)";
    const std::string light = R"("KHR_lights_punctual":{"light":0})";
    const auto read = [&](const std::string& visible) {
        Messages messages;
        Scene scene = test::read_gltf_text(
            sheet(lights +
                  R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"cameras":[{"type":"perspective",)"
                  R"("perspective":{"yfov":1,"znear":1}}],"nodes":[{"mesh":0},{"children":[2,3],"extensions":)"
                  R"({"KHR_node_visibility":{)" +
                  visible + R"(}}},{"mesh":0,"extensions":{"KHR_node_visibility":{"visible":true},)" + light +
                  R"(}},{"camera":0}])"),
            messages);
        CHECK(messages.left_out().size() == (visible == R"("visible":3)" ? 1 : 0));
        return scene;
    };
    const Scene hidden = read(R"("visible":false)");
    CHECK(hidden.instances.size() == 1);
    CHECK(hidden.lights.empty());
    CHECK(hidden.cameras.size() == 1); // it only looks
    for (const char* visible : {R"("visible":true)", "", R"("visible":3)"}) {
        CHECK(read(visible).instances.size() == 2);
        CHECK(read(visible).lights.size() == 1);
    }
}

TEST_CASE("a material may use any two sets of texture coordinates, whatever their numbers") {
    if (!has_webp()) return; // for the picture
    const auto read = [&](const std::string& material, const std::string& attributes, Messages& messages) {
        return test::read_gltf_text(sheet(kImageOfWebp + R"(,"textures":[{"source":0}],"materials":[{)" + material +
                                          R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,)" + attributes +
                                          R"(},"material":0}]}],"nodes":[{"mesh":0}])"),
                                    messages);
    };
    const std::string all = R"("TEXCOORD_0":1,"TEXCOORD_1":2,"TEXCOORD_2":3,"TEXCOORD_3":4)";
    const std::string two = R"("emissiveTexture":{"index":0,"texCoord":3},"normalTexture":{"index":0,"texCoord":1})";
    Messages messages;
    const Scene scene = read(two, all, messages);
    const Material& material = scene.materials.at(0);
    CHECK(messages.left_out().empty());
    const auto coordinate = [&](const TextureRef& ref) { return scene.meshes.at(0).uv.at(ref.uv_set).at(0).x; };
    CHECK(coordinate(material.emission_texture) == 3); // set i has coordinates of i
    CHECK(coordinate(material.normal_texture) == 1);

    const std::string four = two + R"(,"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"texCoord":2},)"
                                   R"("metallicRoughnessTexture":{"index":0}})";
    const Scene of_four = read(four, all, messages);
    CHECK(messages.left_out().empty());
    const Material& with_four = of_four.materials.at(0);
    const auto set_of = [&](const TextureRef& ref) { return of_four.meshes.at(0).uv.at(ref.uv_set).at(0).x; };
    CHECK(set_of(with_four.emission_texture) == 3);
    CHECK(set_of(with_four.normal_texture) == 1);
    CHECK(set_of(with_four.base_color_texture) == 2);
    CHECK(set_of(with_four.metallic_texture) == 0);
    const Scene five = read(four + R"(,"extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":1,)"
                                   R"("clearcoatTexture":{"index":0,"texCoord":4}}})",
                            all, messages);
    CHECK(messages.left_out().size() == 1);
    std::size_t left = 0;
    visit_textures(five.materials.at(0), [&](const TextureRef& ref, const char*) { left += ref.has_image(); });
    CHECK(left == 5 - 1 + 1); // metal and roughness are one texture in two slots

    Messages lacking; // a set that the mesh does not have
    const Scene without = read(two, R"("TEXCOORD_0":1,"TEXCOORD_1":2)", lacking);
    CHECK(without.meshes.size() >= 1);
    CHECK(test::has_warning(lacking, {"TEXCOORD_3"}));
    CHECK(without.materials.at(0).emission_texture.uv_set < 2);
}

TEST_CASE("a file of version 2.1 is read without a warning, and a later one with") {
    const auto left_out = [](const std::string& least) {
        GltfBuilder builder;
        builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        std::string json =
            builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}])");
        const std::string version = R"("version":"2.0")";
        json.replace(json.find(version), version.size(), R"("version":"2.1","minVersion":")" + least + '"');
        Messages messages;
        CHECK(test::read_gltf_text(json, messages).instances.size() == 1);
        return messages.left_out().size();
    };
    CHECK(left_out("2.1") == 0);
    CHECK(left_out("2.2") == 1);
}

TEST_CASE("author and licence are those of XMP, or of the asset's extras") {
    const auto suggested = [](const std::string& asset, const std::string& members) {
        GltfBuilder builder;
        builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        std::string json =
            builder.json(members + R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}])");
        const std::string version = R"("version":"2.0")";
        json.replace(json.find(version), version.size(), version + asset);
        Messages messages;
        std::string found;
        for (const SuggestedSetting& setting : test::read_gltf_text(json, messages).suggested) {
            found += setting.name + "=" + setting.text + ";";
        }
        return found + std::to_string(messages.left_out().size());
    };
    const std::string packets = R"("extensions":{"KHR_xmp_json_ld":{"packets":[{"dc:creator":{"@list":["Ada","Bob"]},)"
                                R"("dc:rights":{"@type":"rdf:Alt","rdf:_1":{"@language":"en","@value":"CC BY 4.0"}}},)"
                                R"({"dc:creator":"Eve"}]}},)";
    const auto packet = [](const std::string& index) {
        return R"(,"extensions":{"KHR_xmp_json_ld":{"packet":)" + index + "}}";
    };
    CHECK(suggested(packet("0"), packets) == "author=Ada, Bob;license=CC BY 4.0;0");
    CHECK(suggested(packet("1") + R"(,"extras":{"author":"Ann","license":"mine"})", packets) ==
          "author=Eve;license=mine;0");
    CHECK(suggested(R"(,"extras":{"author":"Ann","license":"CC0"})", "") == "author=Ann;license=CC0;0");
    CHECK(suggested(packet("2"), packets) == "1");
    CHECK(suggested("", packets) == "0");
    CHECK(suggested(R"(,"extras":3)", "") == "0");
    CHECK(suggested(R"(,"extras":{"author":[[[[[["deep"]]]]]]})", "") == "0");
}
