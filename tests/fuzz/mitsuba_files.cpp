// Fuzz target of the reader of Mitsuba's scenes (formats/mitsuba/read_mitsuba.h) and of its serialized meshes. An input
// is taken for the XML of a scene, or for a file of meshes if it begins like one. It is refused by an Error, or it is
// a scene that passes validate(), unless nothing of it can be drawn.

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include <zlib.h>

#include "formats/mitsuba/read_mitsuba.h"
#include "formats/mitsuba/read_serialized.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/scene_text.h"

namespace pertev {
namespace {

// Each has a shape, so that it is read.
constexpr std::array<std::string_view, 6> kTexts = {
    "<scene version=\"3.0.0\"><default name=\"n\" value=\"64\"/><integrator type=\"path\"><integer name=\"max_depth\" "
    "value=\"$n\"/></integrator><sensor type=\"thinlens\"><float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" "
    "value=\"y\"/><transform name=\"to_world\"><lookat origin=\"0,0,-5\" target=\"0,0,0\" up=\"0,1,0\"/></transform>"
    "<film type=\"hdrfilm\"><integer name=\"width\" value=\"40\"/><rfilter type=\"tent\"/></film><sampler "
    "type=\"independent\"><integer name=\"sample_count\" value=\"4\"/></sampler></sensor><shape type=\"sphere\"><float "
    "name=\"radius\" value=\"2\"/><emitter type=\"area\"><spectrum name=\"radiance\" value=\"400:1,700:2\"/></emitter>"
    "</shape></scene>",
    "<scene version=\"0.6.0\"><bsdf type=\"twosided\" id=\"a\"><bsdf type=\"roughconductor\"><string name=\"material\" "
    "value=\"Au\"/><float name=\"alphaU\" value=\".2\"/></bsdf></bsdf><alias id=\"a\" as=\"b\"/><shape type=\"cube\">"
    "<ref id=\"b\"/><transform name=\"toWorld\"><rotate x=\"1\" angle=\"30\"/><scale value=\"2\"/><matrix value=\"1 0 "
    "0 1 0 1 0 2 0 0 1 3 0 0 0 1\"/></transform></shape><shape type=\"disk\"><boolean name=\"flipNormals\" "
    "value=\"true\"/></shape></scene>",
    "<scene version=\"3.0.0\"><texture type=\"checkerboard\" id=\"t\"><rgb name=\"color0\" "
    "value=\"#ff0000\"/><transform "
    "name=\"to_uv\"><scale x=\"4\" y=\"2\"/></transform></texture><shape type=\"rectangle\"><bsdf "
    "type=\"blendbsdf\"><ref "
    "id=\"t\" name=\"weight\"/><bsdf type=\"plastic\"><boolean name=\"nonlinear\" value=\"true\"/></bsdf><bsdf "
    "type=\"mask\"><float name=\"opacity\" value=\".5\"/><bsdf type=\"diffuse\"><texture name=\"reflectance\" "
    "type=\"bitmap\"><string name=\"filename\" value=\"a.png\"/></texture></bsdf></bsdf></bsdf></shape></scene>",
    "<scene version=\"3.0.0\"><shape type=\"shapegroup\" id=\"g\"><shape type=\"cylinder\"><point name=\"p1\" x=\"1\" "
    "y=\"2\" z=\"3\"/></shape></shape><shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate "
    "x=\"1\"/></transform></shape><shape type=\"merge\"><shape type=\"sphere\"/></shape><include "
    "filename=\"b.xml\"/><shape "
    "type=\"ply\"><string name=\"filename\" value=\"c.ply\"/></shape></scene>",
    "<scene version=\"3.0.0\"><emitter type=\"constant\"><spectrum name=\"radiance\" type=\"regular\"><string "
    "name=\"values\" "
    "value=\"1,2,3\"/></spectrum></emitter><emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"20\"/></emitter>"
    "<emitter type=\"envmap\"><string name=\"filename\" value=\"s.exr\"/></emitter><emitter type=\"point\"><blackbody "
    "name=\"intensity\" temperature=\"3000K\"/></emitter><shape type=\"sphere\"><bsdf type=\"principled\"><float "
    "name=\"metallic\" value=\".5\"/></bsdf></shape></scene>",
    "<scene version=\"0.6.0\"><path value=\"x\"/><shape type=\"sphere\"><bsdf type=\"mixturebsdf\"><string "
    "name=\"weights\" "
    "value=\".5 .5\"/><bsdf type=\"dielectric\"><string name=\"intIOR\" value=\"water\"/></bsdf><bsdf "
    "type=\"coating\"><bsdf "
    "type=\"phong\"/></bsdf></bsdf></shape><shape type=\"rectangle\"><bsdf type=\"conductor\"><rgb "
    "name=\"specularReflectance\" value=\".1 .2 .3\"/><spectrum name=\"eta\" value=\"1.5\"/></bsdf></shape></scene>"};

template <class T>
void put(std::string& to, T value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A file of one serialized triangle, of version 3 or 4.
std::string serialized_seed(uint16_t version) {
    std::string content;
    put(content, uint32_t(0x1001));
    if (version == 4) content += '\0';
    put(content, uint64_t(3));
    put(content, uint64_t(1));
    for (int i = 0; i < 18; ++i) put(content, static_cast<float>(i % 5));
    for (uint32_t i = 0; i < 3; ++i) put(content, i);
    std::string file;
    put(file, uint16_t(0x041C));
    put(file, version);
    uLongf size = compressBound(content.size());
    std::string packed(size, '\0');
    compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
              content.size(), 0); // stored, so that changes reach the numbers
    file.append(packed, 0, size);
    if (version == 4) {
        put(file, uint64_t(0));
    } else {
        put(file, uint32_t(0));
    }
    put(file, uint32_t(1));
    return file;
}

} // namespace

std::vector<std::byte> mitsuba_seed(uint32_t number) {
    const uint32_t choice = number % (kTexts.size() + 2);
    if (choice < kTexts.size()) return bytes_of_text(kTexts[choice]);
    return bytes_of_text(serialized_seed(static_cast<uint16_t>(choice - kTexts.size() + 3)));
}

bool read_mitsuba_input(std::span<const std::byte> input) {
    static const std::filesystem::path path = input_path("mitsuba", "input.xml");
    return reads([&] {
        if (input.size() > 1 && input[0] == std::byte{0x1C} && input[1] == std::byte{4}) {
            (void)mitsuba::read_serialized(input, 0, "input.serialized");
            return true;
        }
        Messages messages;
        Scene scene = read_mitsuba(path, input, FileAccess(path, {}), {}, messages);
        return check_scene(scene, path.string(), messages);
    });
}

} // namespace pertev
