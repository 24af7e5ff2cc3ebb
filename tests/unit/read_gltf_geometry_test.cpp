// Attributes, indices, topologies, sparse and compressed accessors of glTF primitives.

#include <doctest/doctest.h>

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "formats/gltf/meshopt_attributes.h"
#include "formats/gltf/read_gltf.h"
#include "formats/gltf/uri.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

const std::vector<float> kCorners = {0, 0, 0, 1, 0, 0, 0, 1, 0};
const std::vector<float> kFivePoints = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};

/// One node that shows one mesh with this primitive.
std::string one_primitive(const std::string& primitive) {
    return "\"meshes\":[{\"name\":\"m\",\"primitives\":[{" + primitive + "}]}],\"nodes\":[{\"mesh\":0}]";
}

std::string attribute(const std::string& name, int accessor) { return "\"" + name + "\":" + std::to_string(accessor); }

Scene read_primitive(const GltfBuilder& builder, const std::string& primitive) {
    return test::read_gltf_text(builder.json(one_primitive(primitive)));
}

std::vector<uint32_t> read_topology(int mode) {
    GltfBuilder builder;
    const int positions = builder.add("VEC3", kFivePoints);
    const Scene scene = read_primitive(builder, "\"mode\":" + std::to_string(mode) + ",\"attributes\":{" +
                                                    attribute("POSITION", positions) + "}");
    return scene.meshes.at(0).indices;
}

} // namespace

TEST_CASE("a glTF triangle is read with its positions, indices and the default material") {
    GltfBuilder builder;
    const int positions = builder.add("VEC3", kCorners);
    const int indices = builder.add("SCALAR", std::vector<uint16_t>{2, 0, 1});
    const Scene scene = read_primitive(builder, "\"indices\":" + std::to_string(indices) + ",\"attributes\":{" +
                                                    attribute("POSITION", positions) + "}");
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.name == "m");
    CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.indices == std::vector<uint32_t>{2, 0, 1});
    CHECK(mesh.normals.empty());
    REQUIRE(scene.instances.size() == 1);
    CHECK(scene.instances[0].world_from_local == Transform());
    const Material& material = scene.materials.at(scene.instances[0].material);
    CHECK(material.kind == MaterialKind::MetallicRoughness);
    CHECK(material.base_color == Rgb{1, 1, 1});
    CHECK(material.metallic == 1.0f);
    CHECK(material.roughness == 1.0f);
}

TEST_CASE("a GLB file is read like the same document with its data in base64") {
    GltfBuilder builder;
    const std::string members =
        one_primitive("\"attributes\":{" + attribute("POSITION", builder.add("VEC3", kCorners)) + "}");
    const auto path = test::scratch_folder() / "model.glb";
    write_file_atomically(path, builder.glb(members));
    Messages messages;
    const Scene from_glb = read_gltf(path, FileAccess(path, {}), {}, messages);
    const Scene from_text = test::read_gltf_text(builder.json(members));
    CHECK(from_glb.meshes.at(0).positions == from_text.meshes.at(0).positions);
    CHECK(from_glb.meshes.at(0).indices == from_text.meshes.at(0).indices);
    CHECK(messages.all().empty());
}

TEST_CASE("a buffer in the file's folder is found by a percent-encoded name") {
    const auto folder = test::scratch_folder();
    write_file_atomically(folder / "a b.bin", std::as_bytes(std::span(kCorners)));
    const std::string text =
        R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"a%20b.bin"}],"bufferViews":[{"buffer":0,)"
        R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],)" +
        one_primitive("\"attributes\":{\"POSITION\":0}") + "}";
    write_file_atomically(folder / "model.gltf", std::as_bytes(std::span(text)));
    Messages messages;
    const Scene scene = read_gltf(folder / "model.gltf", FileAccess(folder / "model.gltf", {}), {}, messages);
    CHECK(scene.meshes.at(0).positions.at(1) == Vec3{1, 0, 0});
}

TEST_CASE("strips and fans become triangles with the specified winding") {
    CHECK(read_topology(4) == std::vector<uint32_t>{0, 1, 2}); // two corners are left over
    CHECK(read_topology(5) == std::vector<uint32_t>{0, 1, 2, 1, 3, 2, 2, 3, 4});
    CHECK(read_topology(6) == std::vector<uint32_t>{1, 2, 0, 2, 3, 0, 3, 4, 0});
}

TEST_CASE("points and lines are left out with a warning, and the rest of the mesh is read") {
    GltfBuilder builder;
    const std::string positions = "\"attributes\":{" + attribute("POSITION", builder.add("VEC3", kCorners)) + "}";
    Messages messages;
    const Scene scene = test::read_gltf_text(
        builder.json(one_primitive("\"mode\":0," + positions + "},{\"mode\":3," + positions + "},{" + positions)),
        messages);
    CHECK(scene.meshes.size() == 1);
    CHECK(scene.instances.size() == 1);
    CHECK(test::has_warning(messages, {"model.gltf", "points or lines"}));
}

TEST_CASE("all attributes are read") {
    GltfBuilder builder;
    const std::string attributes =
        attribute("POSITION", builder.add("VEC3", kCorners)) + "," +
        attribute("NORMAL", builder.add("VEC3", std::vector<float>{0, 0, 1, 0, 0, 1, 0, 1, 0})) + "," +
        attribute("TANGENT", builder.add("VEC4", std::vector<float>{1, 0, 0, 1, 0, 1, 0, -1, 0, 0, 1, -1})) + "," +
        attribute("TEXCOORD_0", builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1})) + "," +
        attribute("TEXCOORD_1", builder.add("VEC2", std::vector<float>{5, 6, 7, 8, 9, 10})) + "," +
        attribute("COLOR_0", builder.add("VEC3", std::vector<float>{1, 0, 0, 0, 0.5f, 0, 0, 0, 1}));
    const Mesh mesh = read_primitive(builder, "\"attributes\":{" + attributes + "}").meshes.at(0);
    CHECK(mesh.normals == std::vector<Vec3>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}});
    CHECK(mesh.tangents == std::vector<Vec4>{{1, 0, 0, 1}, {0, 1, 0, -1}, {0, 0, 1, -1}});
    CHECK(mesh.uv[0] == std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}});
    CHECK(mesh.uv[1] == std::vector<Vec2>{{5, 6}, {7, 8}, {9, 10}});
    CHECK(mesh.colors == std::vector<Vec4>{{1, 0, 0, 1}, {0, 0.5f, 0, 1}, {0, 0, 1, 1}});

    Messages messages;
    const Scene bare =
        test::read_gltf_text(builder.json(one_primitive("\"attributes\":{" + attributes + "}")), messages, true);
    CHECK(bare.meshes.at(0).normals.size() == 3);
    CHECK(bare.meshes.at(0).uv[0].empty());
    CHECK(bare.meshes.at(0).colors.empty());
    CHECK(bare.materials.at(0).kind == MaterialKind::Diffuse);
}

TEST_CASE("normalised integers are scaled by section 3.11, and plain integers keep their values") {
    GltfBuilder builder;
    const std::string normalized = ",\"normalized\":true";
    const std::string attributes =
        attribute("POSITION", builder.add("VEC3", std::vector<int16_t>{-7, 0, 0, 300, 0, 0, 0, 20, 0})) + "," +
        attribute("NORMAL", builder.add("VEC3", std::vector<int8_t>{127, 0, 0, 0, -128, 0, 0, 0, -127}, normalized)) +
        "," +
        attribute("TEXCOORD_0", builder.add("VEC2", std::vector<uint16_t>{0, 65535, 13107, 0, 1, 2}, normalized)) +
        "," +
        attribute("COLOR_0",
                  builder.add("VEC4", std::vector<uint8_t>{255, 0, 51, 255, 0, 0, 0, 0, 1, 2, 3, 4}, normalized));
    const Mesh mesh = read_primitive(builder, "\"attributes\":{" + attributes + "}").meshes.at(0);
    CHECK(mesh.positions == std::vector<Vec3>{{-7, 0, 0}, {300, 0, 0}, {0, 20, 0}});
    CHECK(mesh.normals == std::vector<Vec3>{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}});
    CHECK(mesh.uv[0] == std::vector<Vec2>{{0, 1}, {0.2f, 0}, {1 / 65535.0f, 2 / 65535.0f}});
    CHECK(mesh.colors[0] == Vec4{1, 0, 0.2f, 1});
    CHECK(mesh.colors[2] == Vec4{1 / 255.0f, 2 / 255.0f, 3 / 255.0f, 4 / 255.0f});
}

TEST_CASE("interleaved attributes are read with the buffer view's stride") {
    GltfBuilder builder;
    std::vector<float> interleaved; // position, uv
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) interleaved.push_back(kCorners[static_cast<std::size_t>(3 * i + k)]);
        interleaved.push_back(static_cast<float>(10 * i));
        interleaved.push_back(static_cast<float>(10 * i + 1));
    }
    const std::string view = "\"bufferView\":" + std::to_string(builder.add_view(interleaved, ",\"byteStride\":20")) +
                             ",\"componentType\":5126,\"count\":3";
    const int positions = builder.add_accessor(view + ",\"type\":\"VEC3\"");
    const int uv = builder.add_accessor(view + ",\"type\":\"VEC2\",\"byteOffset\":12");
    const Mesh mesh = read_primitive(builder, "\"attributes\":{" + attribute("POSITION", positions) + "," +
                                                  attribute("TEXCOORD_0", uv) + "}")
                          .meshes.at(0);
    CHECK(mesh.positions == std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    CHECK(mesh.uv[0] == std::vector<Vec2>{{0, 1}, {10, 11}, {20, 21}});
}

TEST_CASE("a sparse accessor overrides its base, or zeros where it has none") {
    GltfBuilder builder;
    const int base = builder.add_view(kCorners);
    const int indices = builder.add_view(std::vector<uint8_t>{1, 2});
    const int values = builder.add_view(std::vector<float>{4, 5, 6, 7, 8, 9});
    const std::string sparse = "\"componentType\":5126,\"type\":\"VEC3\",\"count\":3,\"sparse\":{\"count\":2,"
                               "\"indices\":{\"bufferView\":" +
                               std::to_string(indices) +
                               ",\"componentType\":5121},\"values\":{\"bufferView\":" + std::to_string(values) + "}}";
    const int over_base = builder.add_accessor("\"bufferView\":" + std::to_string(base) + "," + sparse);
    const int over_zeros = builder.add_accessor(sparse);
    const auto read = [&](int accessor) {
        return read_primitive(builder, "\"attributes\":{" + attribute("POSITION", accessor) + "}")
            .meshes.at(0)
            .positions;
    };
    CHECK(read(over_base) == std::vector<Vec3>{{0, 0, 0}, {4, 5, 6}, {7, 8, 9}});
    CHECK(read(over_zeros) == std::vector<Vec3>{{0, 0, 0}, {4, 5, 6}, {7, 8, 9}});
    const int one_index = builder.add_view(std::vector<uint8_t>{0, 3});
    const int outside = builder.add_accessor(
        "\"componentType\":5126,\"type\":\"VEC3\",\"count\":3,\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":" +
        std::to_string(one_index) + ",\"componentType\":5121},\"values\":{\"bufferView\":" + std::to_string(values) +
        "}}");
    const std::string error =
        test::gltf_fault(builder.json(one_primitive("\"attributes\":{" + attribute("POSITION", outside) + "}")));
    CHECK(error.starts_with("model.gltf: /accessors/2/sparse/indices: "));
}

TEST_CASE("primitives with the same data share one mesh, whatever their material") {
    GltfBuilder builder;
    const std::string part = "\"attributes\":{" + attribute("POSITION", builder.add("VEC3", kCorners)) + "}";
    const Scene scene =
        test::read_gltf_text(builder.json("\"materials\":[{},{\"name\":\"b\"}]," +
                                          one_primitive("\"material\":0," + part + "},{\"material\":1," + part)));
    CHECK(scene.meshes.size() == 1);
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.materials.at(scene.instances[1].material).name == "b");
}

TEST_CASE("buffer views compressed with EXT_meshopt_compression are decoded, including filters") {
    std::vector<Vec3> grid;
    std::vector<uint32_t> triangles;
    for (uint32_t y = 0; y < 20; ++y) {
        for (uint32_t x = 0; x < 20; ++x) {
            grid.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y) / 16});
            if (x == 19 || y == 19) continue;
            const uint32_t at = y * 20 + x;
            triangles.insert(triangles.end(), {at, at + 1, at + 20, at + 1, at + 21, at + 20});
        }
    }
    std::vector<Vec4> directions(grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const Vec3 d = normalize(Vec3{grid[i].x - 9, grid[i].y - 9, 5});
        directions[i] = {d.x, d.y, d.z, 0};
    }
    std::vector<int8_t> octahedral(4 * grid.size());
    meshopt_encodeFilterOct(octahedral.data(), grid.size(), 4, 8, &directions[0].x);

    const auto encode_vertices = [&](const auto& vertices, std::size_t stride) {
        std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(grid.size(), stride));
        bytes.resize(meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), vertices.data(), grid.size(), stride));
        return bytes;
    };
    std::vector<unsigned char> index_bytes(meshopt_encodeIndexBufferBound(triangles.size(), grid.size()));
    index_bytes.resize(
        meshopt_encodeIndexBuffer(index_bytes.data(), index_bytes.size(), triangles.data(), triangles.size()));

    GltfBuilder builder;
    const auto add = [&](int view, const char* type, std::size_t count, const std::string& members) {
        return builder.add_accessor("\"bufferView\":" + std::to_string(view) + ",\"type\":\"" + type +
                                    "\",\"count\":" + std::to_string(count) + members);
    };
    const int position_view =
        builder.add_compressed_view(encode_vertices(grid, 12), 12, grid.size(), ",\"mode\":\"ATTRIBUTES\"");
    const int normal_view = builder.add_compressed_view(encode_vertices(octahedral, 4), 4, grid.size(),
                                                        ",\"mode\":\"ATTRIBUTES\",\"filter\":\"OCTAHEDRAL\"");
    const int index_view = builder.add_compressed_view(index_bytes, 4, triangles.size(), ",\"mode\":\"TRIANGLES\"");
    const int positions = add(position_view, "VEC3", grid.size(), ",\"componentType\":5126");
    const int normals = add(normal_view, "VEC3", grid.size(), ",\"componentType\":5120,\"normalized\":true");
    const int indices = add(index_view, "SCALAR", triangles.size(), ",\"componentType\":5125");
    Mesh mesh = read_primitive(builder, "\"indices\":" + std::to_string(indices) + ",\"attributes\":{" +
                                            attribute("POSITION", positions) + "," + attribute("NORMAL", normals) + "}")
                    .meshes.at(0);
    CHECK(mesh.positions == grid);
    REQUIRE(mesh.indices.size() == triangles.size());
    for (std::size_t i = 0; i < triangles.size(); i += 3) { // the codec may turn a triangle, not flip or move it
        const auto first = mesh.indices.begin() + static_cast<std::ptrdiff_t>(i);
        std::rotate(first, std::find(first, first + 3, triangles[i]), first + 3);
    }
    CHECK(mesh.indices == triangles);
    REQUIRE(mesh.normals.size() == grid.size());
    for (std::size_t i = 0; i < grid.size(); ++i) {
        CHECK(length(mesh.normals[i] - Vec3{directions[i].x, directions[i].y, directions[i].z}) < 0.02f);
    }
}

TEST_CASE("KHR_meshopt_compression's attributes of version 1, and its colours, are decoded; damaged ones are errors") {
    // By meshoptimizer 1.3: 20 points (i, i i / 4, 7) at level 2, with 2-byte deltas, and at level 3, with XOR.
    const char* const streams[] = {
        "oToyqgAAAICAQEBAQCAgICAgICAgEBAQAQYAfwEEDgD///8A/wDf4JCQaHhETFQ8MjY6PiAkJAI6CACAfAAAAAAAAAAAAAAAAAAAAAAAAADg"
        "QAEAAA==",
        "oWgyqgEGAAcPAg/49MTyYuJi8PAYPA8AHgEDAQQOAP///wD/AN/gkJBoeERMVDwyNjo+ICQkAjoIAIB8AAAAAAAAAAAAAAAAAAAAAAAAAOBA"
        "UgAA"};
    // Colours (i, 19 - i, 19 / 4, 19 / 2 or 19) / 19 of 8 bits.
    const char* const colors =
        "ofUCBVdXVXVXVVcPAAUFBwUCDuzs7s7uzuwPAA4ODgwAExMTExMTExMTExURExMTExMVEQB+fX59fn1+fX59fn1+"
        "fX59fn1+AAAAAAAAAAAAAAAAAAAAAAAAAI/gb8AA";
    const auto bytes_of = [](const std::string& base64) {
        const std::vector<std::byte> bytes = *gltf::decode_data_uri("data:application/octet-stream;base64," + base64);
        const auto* const first = reinterpret_cast<const unsigned char*>(bytes.data());
        return std::vector<unsigned char>(first, first + bytes.size());
    };
    for (const char* const stream : streams) {
        GltfBuilder builder;
        builder.add_compressed_view(bytes_of(stream), 12, 20, ",\"mode\":\"ATTRIBUTES\"", "KHR");
        builder.add_compressed_view(bytes_of(colors), 4, 20, ",\"mode\":\"ATTRIBUTES\",\"filter\":\"COLOR\"", "KHR");
        builder.add_accessor("\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":20");
        builder.add_accessor(
            "\"bufferView\":1,\"componentType\":5121,\"normalized\":true,\"type\":\"VEC4\",\"count\":20");
        const Mesh mesh =
            read_primitive(builder, "\"mode\":5,\"attributes\":{\"POSITION\":0,\"COLOR_0\":1}").meshes.at(0);
        REQUIRE(mesh.positions.size() == 20);
        REQUIRE(mesh.colors.size() == 20);
        for (std::size_t i = 0; i < 20; ++i) {
            const auto x = static_cast<float>(i);
            CHECK(mesh.positions[i] == Vec3{x, x * x / 4, 7});
            const Vec4 expected = {x / 19, 1 - x / 19, 0.25f, i % 2 == 0 ? 0.5f : 1};
            const Vec4 read = mesh.colors[i];
            CHECK(length(Vec3{read.x, read.y, read.z} - Vec3{expected.x, expected.y, expected.z}) < 0.01f);
            CHECK(std::abs(read.w - expected.w) < 0.006f);
        }
    }
    std::vector<unsigned char> stream = bytes_of(streams[0]);
    std::vector<std::byte> to(20 * 12);
    const auto is_good = [&] { return gltf::decode_meshopt_attributes(std::as_bytes(std::span(stream)), 12, to); };
    CHECK(is_good());
    for (const std::size_t size : {std::size_t(1), std::size_t(20), stream.size() - 1}) {
        const std::vector<unsigned char> whole = stream;
        stream.resize(size);
        CHECK_FALSE(is_good());
        stream = whole;
    }
    stream.back() = 3; // there is no such mode
    CHECK_FALSE(is_good());
    stream.back() = 0;
    stream.insert(stream.begin() + 30, 0); // a byte too many
    CHECK_FALSE(is_good());
}

TEST_CASE("damaged or impossible compressed buffer views are errors that name the view") {
    const auto read = [](std::size_t stride, std::size_t count, const std::string& members) {
        GltfBuilder builder;
        builder.add_compressed_view(std::vector<unsigned char>(64, 0x55), stride, count, members);
        builder.add_accessor("\"bufferView\":0,\"componentType\":5126,\"type\":\"VEC3\",\"count\":3");
        return test::gltf_fault(builder.json(one_primitive("\"attributes\":{\"POSITION\":0}")));
    };
    const std::string place = "model.gltf: /bufferViews/0/extensions/EXT_meshopt_compression: ";
    CHECK(read(12, 3, ",\"mode\":\"ATTRIBUTES\"") == place + "the compressed data is damaged");
    CHECK(read(12, 4'000'000'000, ",\"mode\":\"ATTRIBUTES\"") ==
          place + "64 compressed bytes cannot hold 4000000000 elements of 12 bytes");
    CHECK(read(10, 3, ",\"mode\":\"ATTRIBUTES\"") == place + "byteStride 10 is not allowed for ATTRIBUTES");
    CHECK(read(2, 4, ",\"mode\":\"TRIANGLES\"") == place + "count is not a multiple of 3");
    CHECK(read(4, 3, ",\"mode\":\"INDICES\",\"filter\":\"OCTAHEDRAL\"") ==
          place + "filter \"OCTAHEDRAL\" is not allowed for INDICES of 4 bytes");
    CHECK(read(4, 3, ",\"mode\":\"ZIP\"") == place + "mode \"ZIP\"; expected ATTRIBUTES, TRIANGLES or INDICES");
}
