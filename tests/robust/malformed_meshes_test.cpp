#include <doctest/doctest.h>

#include <random>

#include "base/read_file.h"
#include "formats/read_scene.h"
#include "tests/support/cpu_seconds.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

/// Tests that reading ends within five processor seconds with a scene or an Error that names the file or one that it
/// refers to.
void check_survives(const fs::path& path) {
    CAPTURE(path.string());
    const double start = test::cpu_seconds();
    Messages messages;
    const auto error = test::thrown_error([&] {
        const Scene scene = read_scene(path, {}, messages);
        CHECK(!scene.instances.empty());
    });
    if (error) CHECK(test::says(error, path.parent_path().string()));
    CHECK(test::cpu_seconds() - start < test::allowed_seconds(5));
}

std::string bytes_of(const fs::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const std::string kSmallObj = "mtllib a.mtl\nv 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0.5\nvt 0 0\nvt 1e0 0.5\nvn 0 0 1\n"
                              "usemtl m\nf 1/1/1 2/2/1 3//1 4\nf -1 -2 -3\ng x\nusemtl n\nf 4 3 2\n";
const std::string kSmallMtl =
    "newmtl m\nKd 1 0 0\nKs .1 .1 .1\nNs 30\nmap_Kd -s 1 1 -o 0.1 t.png\nmap_d t.png\nillum 4\n"
    "newmtl n\nPc 1\nmap_Ps t.png\nPr 0.2\nTf 1 1 1\nd 0.5\nNi 1.5\nmap_Bump -bm 2 t.png\n";
const std::string kSmallPly = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                              "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                              "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
                              "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n4 0 1 2 3\n3 0 1 2\n";

const std::string kSmallStl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\n"
                              "endloop\nendfacet\nendsolid a\n";

const std::string kSmallPbrt =
    "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40 WorldBegin\n"
    "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" Material \"matte\" \"texture Kd\" \"t\"\n"
    "AttributeBegin Rotate 30 0 1 0 AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] Shape \"disk\" AttributeEnd\n"
    "ObjectBegin \"o\" Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n"
    "Shape \"plymesh\" \"string filename\" \"a.ply\" ObjectEnd ObjectInstance \"o\" Include \"a.pbrt\"\n";

/// Changes, doubles or removes a few bytes, like a fuzzer.
std::string damaged(std::string text, std::mt19937& random) {
    const auto below = [&](std::size_t n) { return random() % std::max<std::size_t>(n, 1); };
    for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
        const std::size_t at = below(text.size());
        switch (below(4)) {
        case 0:
            text[at] = static_cast<char>(random());
            break;
        case 1:
            text.erase(at, 1 + below(8));
            break;
        case 2:
            text.insert(at, text.substr(below(text.size()), 1 + below(24)));
            break;
        case 3:
            text.insert(at, std::to_string(random() % 2 ? random() : -1));
            break;
        }
        if (text.empty()) text = " ";
    }
    return text;
}

} // namespace

TEST_CASE("every malformed public mesh causes an error or a scene") {
    for (const char* folder : {"malformed/obj", "malformed/ply", "malformed/scene"}) {
        const auto path = test::test_scene(folder);
        if (!path) continue;
        for (const auto& entry : fs::directory_iterator(*path)) check_survives(entry.path());
    }
}

TEST_CASE("damaged OBJ, MTL, PLY, STL and pbrt files cause an error or a scene") {
    std::mt19937 random(7);
    const fs::path folder = test::scratch_folder();
    const uint64_t rounds = test::effort(1500, 60'000);
    const std::string binary_stl = std::string(80, ' ') + std::string("\3\0\0\0", 4) + std::string(3 * 50, '\1');
    for (uint64_t round = 0; round < rounds; ++round) {
        CAPTURE(round);
        test::write_text(folder / "a.mtl", round % 3 == 0 ? damaged(kSmallMtl, random) : kSmallMtl);
        check_survives(test::write_text(folder / "a.obj", round % 3 == 1 ? damaged(kSmallObj, random) : kSmallObj));
        check_survives(test::write_text(folder / "a.ply", damaged(kSmallPly, random)));
        check_survives(test::write_text(folder / "a.stl", damaged(kSmallStl, random)));
        check_survives(test::write_text(folder / "b.stl", damaged(binary_stl, random)));
        if (round % 4 == 0) check_survives(test::write_text(folder / "b.pbrt", damaged(kSmallPbrt, random)));
    }
}

TEST_CASE("a damaged binary PLY causes an error or a scene") {
    const auto path = test::test_scene("malformed/ply/truncated_binary.ply");
    if (!path) return;
    std::mt19937 random(11);
    const std::string whole = bytes_of(*path);
    const fs::path folder = test::scratch_folder();
    for (uint64_t round = 0; round < test::effort(200, 5000); ++round) {
        CAPTURE(round);
        check_survives(test::write_text(folder / "a.ply", damaged(whole, random)));
    }
}

TEST_CASE("adversarial files are read quickly: many materials, many missing textures, one endless line") {
    const fs::path folder = test::scratch_folder();
    std::string obj = "mtllib many.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", mtl;
    for (int i = 0; i < 50'000; ++i) {
        const std::string name = std::to_string(i);
        obj += "usemtl " + name + "\nf 1 2 3\n";
        mtl += "newmtl " + name + "\nmap_Kd " + name + ".png\n";
        if (i % 2 == 0) obj += "usemtl unknown" + name + "\nf 1 2 3\n";
    }
    test::write_text(folder / "many.mtl", mtl);
    check_survives(test::write_text(folder / "many.obj", obj));

    std::string face = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.1 0.1 0\nf";
    for (int i = 0; i < 500'000; ++i) face += " " + std::to_string(1 + (i * 7 + i / 3) % 4);
    check_survives(test::write_text(folder / "face.obj", face));
    check_survives(test::write_text(folder / "joined.obj", "v 0 0 0\nf " + std::string(2'000'000, '\\') + "\n"));
    std::string joined = "v 0 0 0\nf ";
    for (int i = 0; i < 500'000; ++i) joined += "\\\n";
    check_survives(test::write_text(folder / "lines.obj", joined));
}
