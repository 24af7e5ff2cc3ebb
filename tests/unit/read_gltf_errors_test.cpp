// Errors in a glTF file are reported with the file, the location and the correct form.

#include <doctest/doctest.h>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "formats/gltf/read_gltf.h"
#include "formats/gltf/uri.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;

namespace {

std::string document(const std::string& members) { return R"({"asset":{"version":"2.0"},)" + members + "}"; }

/// A primitive over accessor 0, which has these members, in a buffer of 36 bytes, with index accessor 1.
std::string with_accessor(const std::string& members, const std::string& attributes = R"("POSITION":0)") {
    return document(
        R"("buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":0,"byteLength":36,)"
        R"("byteStride":8}],"accessors":[{)" +
        members +
        R"(},{"bufferView":0,"componentType":5121,"type":"SCALAR","count":36}],)"
        R"("meshes":[{"primitives":[{"attributes":{)" +
        attributes + R"(}}]}],"nodes":[{"mesh":0}])");
}

/// Message about a GLB file: the Error, or the first warning.
std::string glb_fault(std::vector<std::byte> bytes) {
    const auto path = test::scratch_folder() / "model.glb";
    write_file_atomically(path, bytes);
    Messages messages;
    std::string text;
    try {
        read_gltf(path, FileAccess(path, {}), {}, messages);
        if (!messages.all().empty()) text = messages.all().front().text;
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::BadInput);
        text = error.what();
    }
    return text.substr(std::min(text.size(), text.find("model.glb")));
}

/// A triangle whose buffer has these members beside those of `data()`, which fill 36 bytes.
std::string with_buffer(const std::string& members) {
    return document("\"buffers\":[{" + members +
                    R"(}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,)"
                    R"("componentType":5126,"type":"VEC3","count":3}],"meshes":[{"primitives":[{"attributes":)"
                    R"({"POSITION":0}}]}],"nodes":[{"mesh":0}])");
}

} // namespace

TEST_CASE("an unsupported extension is left out, required or not, with a warning that names its location") {
    CHECK(test::gltf_fault(
              document(R"("extensionsUsed":["KHR_x"],"extensionsRequired":["KHR_texture_transform","KHR_x"])"))
              .starts_with("model.gltf: /extensionsRequired/1: "));
    Messages messages;
    test::read_gltf_text(document(R"("extensionsUsed":["KHR_lights_punctual","KHR_materials_scatter"])"), messages);
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].is_left_out);
    CHECK(test::has_warning(messages, {"model.gltf: /extensionsUsed/1", "KHR_materials_scatter"}));
}

TEST_CASE("a scene that requires an unknown extension is read without it") {
    Messages messages;
    const std::string text = with_accessor(R"("bufferView":0,"type":"VEC3","componentType":5126,"count":3)");
    const Scene scene = test::read_gltf_text(
        R"({"extensionsUsed":["KHR_x"],"extensionsRequired":["KHR_x"],)" + text.substr(1), messages);
    CHECK(scene.instances.size() == 1);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("files that are not glTF 2 are refused, and files without a version are read as glTF 2") {
    CHECK(test::gltf_fault("{]").starts_with("model.gltf: not valid JSON: "));
    CHECK(test::gltf_fault("") == "model.gltf: the file is empty; expected a glTF 2.0 document");
    CHECK(test::gltf_fault("[]").starts_with("model.gltf: /: "));
    CHECK(test::gltf_fault(R"({"asset":{"version":"1.0"}})").starts_with("model.gltf: /asset/version: "));
    CHECK(test::gltf_fault(R"({"asset":{"version":"2.1","minVersion":"2.2"}})")
              .starts_with("model.gltf: /asset/minVersion: "));
    CHECK(test::gltf_fault(document("\"extras\":" + std::string(2000, '[') + std::string(2000, ']'))) ==
          "model.gltf: JSON nested more than 1024 levels deep; expected a glTF 2.0 document");
    for (const std::string text : {"{}", R"({"asset":null})", R"({"asset":{"version":"two"}})"}) {
        CAPTURE(text);
        Messages messages;
        test::read_gltf_text(text, messages);
        CHECK(test::has_warning(messages, {"model.gltf: /", "read as", "2.0"}));
        CHECK(messages.left_out().empty());
    }
}

TEST_CASE("invalid JSON is an error with the line, the column and the expected text") {
    const auto read = [](const std::string& text) {
        const std::string error = test::gltf_fault(text), start = "model.gltf: not valid JSON: ";
        CHECK(error.starts_with(start));
        return error.substr(std::min(start.size(), error.size()));
    };
    CHECK(read("{]") == "line 1, column 2 (byte 1 of the file): expected a name in quotes or }");
    CHECK(read("{\"asset\":{\"version\":\"2.0\"},\n\"nodes\":[\n {\"mesh\":0,}\n]}") ==
          "line 3, column 12 (byte 49 of the file): expected a name in quotes");
    CHECK(read("\xef\xbb\xbf{\n\"\xc3\xa9\" 1}") ==
          "line 2, column 5 (byte 10 of the file): expected a colon after the name");
    CHECK(read("{\"a\":[1 2]}") == "line 1, column 9 (byte 8 of the file): expected a comma or ]");
    CHECK(read("{\"a\":[1,2}") == "line 1, column 10 (byte 9 of the file): expected a comma or ]");
    CHECK(read("{\"a\":[1,]}") == "line 1, column 9 (byte 8 of the file): expected a value");
    CHECK(read("{\"a\":{}") == "line 1, column 8 (byte 7 of the file): expected a comma or }");
    CHECK(read("{} {}") == "line 1, column 4 (byte 3 of the file): expected nothing after the end of the document");
    CHECK(read("{\"a\":\"\\\"}") ==
          "line 1, column 6 (byte 5 of the file): expected a quotation mark that ends this string");
    for (const char* value :
         {"01", "1.", "-", "1e999x", "tru", "<html>", "99999999999999999999.", "\"\\q\"", "\"\n\""}) {
        CAPTURE(value);
        CHECK(read(std::string("{\"a\": ") + value + "}")
                  .starts_with("line 1, column 7 (byte 6 of the file): expected a value ("));
    }
}

TEST_CASE("an error for a damaged GLB container names the first faulty byte") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::vector<std::byte> good = builder.glb(R"("nodes":[])");
    CHECK(glb_fault(good).empty());
    for (std::size_t size = 0; size < good.size(); ++size) {
        CAPTURE(size);
        CHECK(!glb_fault({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}).empty());
    }
    const auto with_byte = [&](std::size_t at, int value) {
        std::vector<std::byte> bad = good;
        bad[at] = static_cast<std::byte>(value);
        return glb_fault(bad);
    };
    CHECK(with_byte(0, 'x').starts_with("model.glb: byte 0: "));
    CHECK(with_byte(4, 1).starts_with("model.glb: byte 4: "));
    CHECK(with_byte(15, 0x7f).starts_with("model.glb: byte 12: the chunk states ")); // the end of the JSON is known
    CHECK(with_byte(20, '[').starts_with("model.glb: not valid JSON: "));
    CHECK(with_byte(16, 'X').starts_with("model.glb: byte 12: "));
}

TEST_CASE("an accessor beyond its data is an error before anything is allocated") {
    const auto read = [](const std::string& members) { return test::gltf_fault(with_accessor(members)); };
    const std::string vec3 = R"("type":"VEC3","componentType":5126,)";
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":3").empty());
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":4").starts_with("model.gltf: /accessors/0: "));
    CHECK(read("\"bufferView\":0,\"byteOffset\":4," + vec3 + "\"count\":3").starts_with("model.gltf: /accessors/0: "));
    CHECK(read("\"bufferView\":0,\"byteOffset\":9007199254740992," + vec3 + "\"count\":1")
              .starts_with("model.gltf: /accessors/0: 1 elements of 12 bytes"));
    // 9007199254740992 * 12 wraps round in 64 bits if multiplied often enough; the check must not multiply.
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":9007199254740992").starts_with("model.gltf: /accessors/0: "));
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":4294967295").starts_with("model.gltf: /accessors/0: "));
    CHECK(read(vec3 + "\"count\":4000000000").find("4000000000") != std::string::npos);
    CHECK(read("\"bufferView\":1," + vec3 + "\"count\":1").starts_with("model.gltf: /accessors/0: "));
    CHECK(read("\"bufferView\":2," + vec3 + "\"count\":1").starts_with("model.gltf: /accessors/0/bufferView: "));
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":-1").starts_with("model.gltf: /accessors/0/count: "));
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":1.5").starts_with("model.gltf: /accessors/0/count: "));
    CHECK(read("\"bufferView\":0," + vec3 + "\"count\":3.0").empty());
    CHECK(read(R"("bufferView":0,"componentType":5130,"type":"VEC3","count":1)")
              .starts_with("model.gltf: /accessors/0/componentType: "));
}

TEST_CASE("an attribute of the wrong type or length is an error with the attribute's pointer") {
    const std::string vec3 = R"("bufferView":0,"type":"VEC3","componentType":5126,"count":3)";
    const std::string place = "model.gltf: /meshes/0/primitives/0/attributes/";
    CHECK(test::gltf_fault(with_accessor(vec3, R"("POSITION":1)")) ==
          place + "POSITION: the accessor's type is SCALAR; expected VEC3");
    CHECK(test::gltf_fault(with_accessor(vec3, R"("POSITION":0,"COLOR_0":1)")) ==
          place + "COLOR_0: the accessor's type is SCALAR; expected VEC3 or VEC4");
    CHECK(test::gltf_fault(with_accessor(vec3, R"("POSITION":7)")) ==
          place + "POSITION: 7; expected an index into \"accessors\", which has 2 elements");
    CHECK(test::gltf_fault(with_accessor(vec3, R"("POSITION":"0")")) ==
          place + "POSITION: a string; expected a whole number");
}

TEST_CASE("a triangle with an index beyond the vertices is left out with its location and value") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<uint32_t>{0, 1, 4294967295u});
    CHECK(test::gltf_fault(
              builder.json(
                  R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}])"))
              .starts_with("model.gltf: /meshes/0/primitives/0/indices: "));
}

TEST_CASE("elements that use a missing, short, badly encoded or outside buffer are left out") {
    const auto read = [](const std::string& members) { return test::gltf_fault(with_buffer(members)); };
    CHECK(read(R"("byteLength":36,"uri":"data:;base64,AAAA")").starts_with("model.gltf: /bufferViews/0: "));
    CHECK(read(R"("byteLength":36,"uri":"data:;base64,A*AA")").starts_with("model.gltf: /buffers/0/uri: "));
    CHECK(read(R"("byteLength":36,"uri":"none.bin")").starts_with("model.gltf: /buffers/0/uri: "));
    std::string up; // leads to the root from any depth
    for (int i = 0; i < 30; ++i) up += "../";
    CHECK(read(R"("byteLength":36,"uri":")" + up + "etc/passwd\"").find("`allow_path=") != std::string::npos);
    CHECK(read(R"("byteLength":36,"uri":"http://example.org/a.bin")").starts_with("model.gltf: /buffers/0/uri: "));
    CHECK(read(R"("byteLength":36)").starts_with("model.gltf: /bufferViews/0/buffer: "));
    CHECK(test::gltf_fault(with_accessor(R"("bufferView":0,"componentType":5126,"type":"VEC3","count":3)")).empty());
}

TEST_CASE("a small file that expands without bound is refused") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC3", std::vector<float>(3 * 20'000));
    std::string nodes = "{\"mesh\":0}";
    for (int i = 0; i < 2'000; ++i) {
        nodes += R"(,{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1}}}})";
    }
    const std::string error = test::gltf_fault(
        builder.json(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[)" + nodes + "]"));
    CHECK(error.starts_with("model.gltf: "));
}

TEST_CASE("a file used by many buffers is read once") {
    const auto folder = test::scratch_folder();
    write_file_atomically(folder / "big.bin", std::vector<std::byte>(std::size_t(8) << 20));
    std::string buffers = R"({"byteLength":4,"uri":"big.bin"})";
    for (int i = 0; i < 20'000; ++i) buffers += R"(,{"byteLength":4,"uri":"./big.bin"})"; // 160 GB if read each time
    const std::string text = document("\"buffers\":[" + buffers + "]");
    write_file_atomically(folder / "model.gltf", std::as_bytes(std::span(text)));
    Messages messages;
    CHECK(read_gltf(folder / "model.gltf", FileAccess(folder / "model.gltf", {}), {}, messages).meshes.empty());
}

TEST_CASE("base64 and percent encoding are decoded, even in file names") {
    const auto decoded = [](const std::string& text, const std::string& start = "data:text/plain;base64,") {
        std::string out;
        const auto bytes = gltf::decode_data_uri(start + text);
        if (!bytes) return std::string("refused");
        for (const std::byte b : *bytes) out += static_cast<char>(b);
        return out;
    };
    CHECK(decoded("") == "");
    CHECK(decoded("Zg==") == "f");
    CHECK(decoded("Zm8=") == "fo");
    CHECK(decoded("Zm9v") == "foo");
    CHECK(decoded("Zm9vYg") == "foob"); // without padding
    CHECK(decoded("Zm9vY") == "refused");
    CHECK(decoded("Zm=v") == "refused");
    CHECK(decoded("Zm=vYg") == "refused");
    CHECK(decoded("Zg===") == "refused");
    CHECK(decoded("Zm9v*") == "refused");
    CHECK(decoded("Zm\r\n9v Yg=\n=\n") == "foob"); // with line breaks
    CHECK(decoded("Zm9vYg%3D%3D%0A") == "foob");
    CHECK(decoded("Zm9v%2") == "refused");
    CHECK(decoded("%89PNG%00 a+b", "data:image/png,") == std::string("\x89PNG\0 a+b", 9));
    CHECK(decoded("%8", "data:,") == "refused");
    CHECK(!gltf::decode_data_uri("data:text/plain;base64"));
    CHECK(gltf::decode_path_uri("a%20b/%C3%A9.png") == "a b/\xc3\xa9.png");
    CHECK(gltf::decode_path_uri("a%2") == "a%2");
    CHECK(gltf::decode_path_uri("a%zz%20") == "a%zz ");
    CHECK(gltf::decode_path_uri("100%.png") == "100%.png");
    CHECK(!gltf::decode_path_uri("a%00b"));
    CHECK(!gltf::decode_path_uri("http://a/b.png"));
    CHECK(gltf::decode_path_uri("file:///a/b%20c.png") == "/a/b c.png");
    CHECK(gltf::decode_path_uri("FILE:///C:/a/b.png") == "C:/a/b.png");
    CHECK(gltf::decode_path_uri("file://host/a.png") == "/a.png");
    CHECK(gltf::decode_path_uri("file:a.png") == "a.png");
    CHECK(gltf::decode_path_uri("C:/a") == "C:/a");
    CHECK(gltf::decode_path_uri("C:\\a\\b.png") == "C:\\a\\b.png");
    CHECK(decoded("Zm9v", "DATA:text/plain;BASE64,") == "foo");
    CHECK(gltf::decode_path_uri("1a/b:c.png") == "1a/b:c.png");
}
