// Fuzz targets of the readers of scenes, lights, cameras and pictures. An input is refused by an Error, or what is read
// of it is usable: a scene passes validate(), unless nothing of it can be drawn, and a picture has as many numbers as
// pixels.

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <variant>

#include <zlib.h>

#include "base/sink.h"
#include "formats/cameras/read_cameras.h"
#include "formats/gltf/read_gltf.h"
#include "formats/ies/read_ies.h"
#include "formats/mitsuba/read_serialized.h"
#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "formats/read_camera_path.h"
#include "formats/stl/read_stl.h"
#include "image/cube_lut.h"
#include "image/decode_image.h"
#include "image/read_exr.h"
#include "image/write_exr.h"
#include "image/write_hdr.h"
#include "image/write_jpeg.h"
#include "image/write_png.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/scene_text.h"

namespace pertev {
namespace {

using Bytes = std::vector<std::byte>;
using Input = std::span<const std::byte>;

/// Reads an input that has to be a file of this name.
template <class Read>
bool reads_file(Input input, std::string_view format, std::string_view name, const Read& read) {
    static const std::filesystem::path path = input_path(format, name);
    write_bytes(path, input);
    return reads([&] {
        Messages messages;
        Scene scene = read(path, FileAccess(path, {}), ReadOptions{}, messages);
        return check_scene(scene, path.string(), messages);
    });
}

std::string_view text_of(Input input) { return {reinterpret_cast<const char*>(input.data()), input.size()}; }

template <std::size_t kCount>
Bytes one_of(const std::array<std::string_view, kCount>& texts, uint32_t kind) {
    return bytes_of_text(texts[kind % kCount]);
}

constexpr std::array<std::string_view, 4> kGltf = {R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0,"rotation":[0,0,0,1]},{"camera":0,"translation":[0,0,3]}],"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],"metallicFactor":0.5},"extensions":{"KHR_materials_clearcoat":{"clearcoatFactor":0.5}}}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"extensionsUsed":["KHR_materials_clearcoat"]})",
                                                   R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"skin":0,"children":[1]},{"name":"j","scale":[1,1,1]}],"skins":[{"joints":[1]}],"animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":1,"output":0,"interpolation":"LINEAR"}]}],"meshes":[{"weights":[0.5],"primitives":[{"mode":5,"attributes":{"POSITION":0},"targets":[{"POSITION":0}]}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":0,"componentType":5126,"count":3,"type":"SCALAR","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})", R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],"extensions":{"KHR_lights_punctual":{"light":0}}}],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":3,"spot":{"outerConeAngle":0.5}}]}},"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],"materials":[{"alphaMode":"MASK","normalTexture":{"index":0,"scale":2},"pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":{"scale":[2,2]}}}}}],"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],"images":[{"uri":"data:image/png;base64,AAAA"}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"},{"bufferView":0,"componentType":5121,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})", R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"materials":[{"extensions":{"KHR_materials_pbrSpecularGlossiness":{"diffuseFactor":[1,1,1,1]},"KHR_materials_volume":{"thicknessFactor":1},"KHR_materials_transmission":{"transmissionFactor":1}}}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})"};

/// A binary file with the first text, whose buffer stays in it.
Bytes gltf_seed(uint32_t kind) {
    if (kind < kGltf.size()) return one_of(kGltf, kind);
    std::string json(kGltf[0]);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string file = "glTF";
    const auto put = [&](uint32_t value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(2);
    put(static_cast<uint32_t>(20 + json.size()));
    put(static_cast<uint32_t>(json.size()));
    file += "JSON" + json;
    return bytes_of_text(file);
}
bool read_gltf_input(Input input) {
    static const std::filesystem::path path = input_path("gltf", "input.gltf");
    return reads([&] {
        Messages messages;
        Scene scene = read_gltf(path, Bytes(input.begin(), input.end()), FileAccess(path, {}), {}, messages);
        return check_scene(scene, path.string(), messages);
    });
}

constexpr std::array<std::string_view, 3> kObj = {
    "o a\nv 0 0 0\nv 1 0 0 1 .5 .2\nv 0 1 0\nv 1 1 1\nvt 0 0\nvt 1 0\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3//1\ng b\ns "
    "1\nf -1 -2 "
    "-3 1\nnewmtl m\nKd .5 .2 .1\nKs .2 .2 .2\nNs 50\nd .5\nmap_Kd -s 2 2 a.png\nNi 1.5\nillum 7\n",
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl e\nf 1 2 3\nnewmtl e\nKe 1 2 3\nPr .5\nPm 1\nPc .2\naniso .3\nmap_Bump -bm 2 "
    "b.png\nTf .1 .2 "
    ".3\nnorm c.png\n",
    "v 1e3 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 2\nf 1 2 3 4 5\nl 1 2\nf 1 2 \\\n3\n"};
bool read_obj_input(Input input) { // the materials follow the geometry
    static const std::filesystem::path path = input_path("obj", "input.obj");
    return reads([&] {
        const std::size_t materials = std::min(text_of(input).find("newmtl"), input.size());
        Messages messages;
        Scene scene =
            read_obj(path, {input.first(materials), input.subspan(materials)}, FileAccess(path, {}), {}, messages);
        return check_scene(scene, path.string(), messages);
    });
}

constexpr std::array<std::string_view, 3> kPly = {
    "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
    "float "
    "z\nproperty uchar red\nproperty float s\nproperty float t\nelement face 2\nproperty list uchar int "
    "vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 1 1 0\n0 1 0 2 0 1\n1 1 1 3 1 1\n3 0 1 2\n4 0 1 3 2\n",
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\nelement "
    "face 1\nproperty list uchar uint vertex_indices\nend_header\nAAA<AAA<BBB<CCC<BBB<DDD<AAA<EEE<FFF<",
    "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty float y\nproperty short "
    "z\nproperty "
    "float nx\nproperty float ny\nproperty float nz\nelement tristrips 1\nproperty list int int "
    "vertex_indices\nend_header\n"};
Bytes ply_seed(uint32_t kind) {
    Bytes seed = one_of(kPly, kind);
    const auto append = [&](std::initializer_list<int> values) {
        for (const int value : values) seed.push_back(static_cast<std::byte>(value));
    };
    if (kind == 1) append({3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0});
    if (kind == 2) {
        for (int i = 0; i < 3; ++i) { // x, y, z and a normal
            append({0x3f, 0xf0 + i, 0, 0, 0, 0, 0, 0, 0x3f, 0x80 * (i % 2), 0, i, 0, 3 * i});
            append({0, 0, 0, 0, 0, 0, 0, 0, 0x3f, 0x80, 0, 0});
        }
        append({0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2});
    }
    return seed;
}

constexpr std::array<std::string_view, 1> kStl = {
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "a\nsolid "
    "b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 0 1e2\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"};
Bytes stl_seed(uint32_t kind) {
    if (kind < kStl.size()) return one_of(kStl, kind);
    Bytes seed(84 + 2 * 50);
    seed[80] = std::byte{2};
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t k = 0; k < 9; ++k) seed[84 + 50 * i + 12 + 4 * k + 3] = std::byte(0x3a + (k * k + i) % 7);
    }
    return seed;
}

constexpr std::array<std::string_view, 2> kIes = {
    "IESNA:LM-63-2002\n[TEST] a lamp\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 50\n0 45 90\n0\n100 80 0\n",
    "IESNA91\nTILT=INCLUDE\n1\n2\n0 90\n1 .5\n2 1000 .5 3 3 1 1 .1 .1 .1\n1.1 1 50\n0 90 180\n0 45 90\n1 2 3 4 5 6 7 8 "
    "9\n"};
constexpr std::array<std::string_view, 3> kCube = {
    "TITLE \"a\"\n# a table\nLUT_3D_SIZE 2\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 2 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 "
    "1\n0 1 "
    "1\n1 1 1\n",
    "LUT_3D_SIZE 2\n0 0 0\n.5 -1 0\n0 1e3 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n",
    "LUT_1D_SIZE 2\nLUT_1D_INPUT_RANGE -1 4\nLUT_3D_SIZE 2\nLUT_3D_INPUT_RANGE 0 2\n0 0 0\n2 1 3\n0 0 0\n.5 -1 0\n0 1 "
    "0\n1 1 0\n"
    "0 0 1\n1 0 1\n0 1 1\n1 1 1\n"};
constexpr std::array<std::string_view, 3> kCameras = {
    R"({"cameras":[{"name":"front","eye":[0,1,5],"target":[0,1,0],"fov":40},{"eye":[1,2,3],"lens":"fisheye"}],"up":[0,1,0]})",
    R"({"camera_angle_x":0.7,"frames":[{"file_path":"a","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})",
    R"({"fl_x":500,"fl_y":500,"cx":320,"cy":240,"w":640,"h":480,"k1":0.1,"frames":[{"file_path":"b.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,4],[0,0,0,1]]}]})"};
constexpr std::array<std::string_view, 1> kCameraPath = {
    R"({"keys":[{"time":0,"eye":[0,1,5],"target":[0,1,0],"up":[0,1,0],"fov":45},{"time":1.5,"eye":[1,1,5],"target":[0,1,0],"fov":50}]})"};

Bytes serialized_bytes(uint32_t kind) { return mitsuba_seed(kind + 6); } // after its scenes

/// A small picture whose texels differ.
Rgba8Image colors(uint32_t width, uint32_t height) {
    Rgba8Image image = {width, height, std::vector<uint8_t>(std::size_t(4) * width * height)};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<uint8_t>(i * i * 7 + i);
    return image;
}
Image numbers(uint32_t width, uint32_t height) {
    Image image = {width, height, 3, std::vector<float>(std::size_t(3) * width * height)};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.25f * static_cast<float>(i % 9);
    return image;
}
Bytes exr_seed(uint32_t kind) { return encode_exr(numbers(5 + kind, 4)); }
Bytes png_seed(uint32_t kind) { return encode_png(colors(3, 5), kind % 2 == 1); }
Bytes jpeg_seed(uint32_t kind) {
    return kind == 0 ? encode_jpeg(colors(9, 8), 80) : encode_jpeg_strips(colors(17, 16), 60, kind == 2);
}
Bytes hdr_seed(uint32_t kind) { return encode_hdr(numbers(kind == 0 ? 4u : 12u, 3)); }

bool decodes(Input input) {
    return reads([&] {
        const auto picture = decode_image(input, "input");
        const auto are_whole = [](std::size_t width, std::size_t height, std::size_t channels, std::size_t numbers) {
            if (numbers != width * height * channels) std::abort();
        };
        if (const auto* bytes = std::get_if<Rgba8Image>(&picture)) {
            are_whole(bytes->width, bytes->height, 4, bytes->pixels.size());
        } else {
            const Image& image = std::get<Image>(picture);
            are_whole(image.width, image.height, image.channels, image.pixels.size());
        }
        return true;
    });
}
bool read_exr_input(Input input) {
    const bool is_read = reads([&] {
        (void)read_exr(input, "input");
        return true;
    });
    return decodes(input) || is_read;
}
/// Decodes a PNG whose chunks have the right checksums.
bool read_png_input(Input input) {
    Bytes bytes(input.begin(), input.end());
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        std::size_t size = 0;
        for (std::size_t i = 0; i < 4; ++i) size = size << 8 | std::to_integer<std::size_t>(bytes[at + i]);
        if (size > bytes.size() - at - 12) break;
        const uLong sum = crc32(0, reinterpret_cast<const Bytef*>(&bytes[at + 4]), static_cast<uInt>(size + 4));
        for (std::size_t i = 0; i < 4; ++i) bytes[at + 8 + size + i] = static_cast<std::byte>(sum >> (24 - 8 * i));
        at += 12 + size;
    }
    return decodes(bytes);
}

} // namespace

std::span<const FuzzTarget> fuzz_targets() {
    static const FuzzTarget targets[] = {
        {"pbrt", 8, pbrt_seed, read_pbrt_input},
        {"mitsuba", 6, mitsuba_seed, read_mitsuba_input},
        {"serialized", 2, serialized_bytes,
         [](Input input) { return reads([&] { return (void)mitsuba::read_serialized(input, 0, "input"), true; }); }},
        {"gltf", 5, gltf_seed, read_gltf_input},
        {"obj", 3, [](uint32_t kind) { return one_of(kObj, kind); }, read_obj_input},
        {"ply", 3, ply_seed,
         [](Input input) {
             return reads_file(input, "ply", "input.ply", [](auto&&... with) { return read_ply(with...); });
         }},
        {"stl", 2, stl_seed,
         [](Input input) {
             return reads_file(input, "stl", "input.stl", [](auto&&... with) { return read_stl(with...); });
         }},
        {"ies", 2, [](uint32_t kind) { return one_of(kIes, kind); },
         [](Input input) { return reads([&] { return (void)parse_ies(text_of(input), "input", nobody()), true; }); }},
        {"cube", 2, [](uint32_t kind) { return one_of(kCube, kind); },
         [](Input input) { return reads([&] {
                               return (void)CubeLut::parse(input, "input")({0.2f, 2, -1}), true;
                           }); }},
        {"cameras", 3, [](uint32_t kind) { return one_of(kCameras, kind); },
         [](Input input) {
             static const std::filesystem::path path = input_path("cameras", "cameras.json");
             write_bytes(path, input);
             return reads([&] { return !read_cameras(path, 64, 48).empty(); });
         }},
        {"camera_path", 1, [](uint32_t kind) { return one_of(kCameraPath, kind); },
         [](Input input) {
             static const std::filesystem::path path = input_path("camera-path", "path.json");
             write_bytes(path, input);
             return reads([&] { return (void)read_camera_path(path), true; });
         }},
        {"exr", 2, exr_seed, read_exr_input},
        {"png", 2, png_seed, read_png_input},
        {"jpeg", 3, jpeg_seed, decodes},
        {"hdr", 2, hdr_seed, decodes}};
    return targets;
}

} // namespace pertev
