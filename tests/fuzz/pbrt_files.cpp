// Fuzz target of the reader of pbrt's scenes (formats/pbrt/read_pbrt.h). An input is taken for the text of a scene. It
// is refused by an Error, or it is a scene that passes validate(), unless nothing of it can be drawn.

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "formats/pbrt/read_pbrt.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/scene_text.h"

namespace pertev {
namespace {

// Each has a shape, so that it is read.
constexpr std::array<std::string_view, 8> kTexts = {
    "LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40 \"float lensradius\" .1 Film \"rgb\" \"integer "
    "xresolution\" [40]\n"
    "Sampler \"sobol\" \"integer pixelsamples\" 4 Integrator \"path\" \"integer maxdepth\" 3 WorldBegin\n"
    "LightSource \"infinite\" \"rgb L\" [1 1 1] \"float scale\" 2 \"float illuminance\" 3 Shape \"sphere\" \"float "
    "radius\" 2 \"float zmin\" -1 \"float phimax\" "
    "90\n",
    "WorldBegin # v4\nMakeNamedMaterial \"a\" \"string type\" \"coateddiffuse\" \"rgb reflectance\" [.1 .2 .3] \"float "
    "eta\" 1.4\n"
    "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"float roughness\" .2\n"
    "Material \"mix\" \"string materials\" [ \"a\" \"b\" ] \"float amount\" .3 Shape \"disk\" NamedMaterial \"b\"\n"
    "Shape \"cylinder\" \"float zmax\" 2 \"float radius\" .5\n",
    "WorldBegin Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [1 0 0] \"float uscale\" 4\n"
    "Texture \"s\" \"spectrum\" \"scale\" \"texture tex1\" \"t\" \"float tex2\" .5 Texture \"i\" \"float\" "
    "\"imagemap\" \"string filename\" \"a.png\"\n"
    "Material \"matte\" \"texture Kd\" \"s\" \"texture bumpmap\" \"i\" Shape \"trianglemesh\" \"point P\" [0 0 0 1 0 0 "
    "0 1 0]\n"
    "\"integer indices\" [0 1 2] \"normal N\" [0 0 1 0 0 1 0 0 1] \"float uv\" [0 0 1 0 0 1] \"texture alpha\" \"i\" "
    "WorldEnd\n",
    "WorldBegin ObjectBegin \"o\" Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"integer indices\" [0 "
    "1 2 3]\n"
    "ObjectEnd AttributeBegin Rotate 30 0 1 1 Scale 2 3 4 ObjectInstance \"o\" AttributeEnd ReverseOrientation "
    "ObjectInstance \"o\"\n",
    "WorldBegin AreaLightSource \"diffuse\" \"blackbody L\" 3000 \"float power\" 10 Shape \"loopsubdiv\" \"integer "
    "levels\" 2\n"
    "\"point3 P\" [1 0 0 0 1 0 -1 0 0 0 -1 0 0 0 1 0 0 -1] \"integer indices\" [0 1 4 1 2 4 2 3 4 3 0 4 1 0 5 2 1 5 3 "
    "2 5 0 3 5]\n",
    "ColorSpace \"rec2020\" WorldBegin Attribute \"shape\" \"float alpha\" .5 TransformBegin Transform [1 0 0 0 0 1 0 "
    "0 0 0 1 0 1 2 3 1]\n"
    "LightSource \"spot\" \"point3 from\" [0 1 0] \"float coneangle\" 30 LightSource \"distant\" \"spectrum L\" [400 1 "
    "700 .5]\n"
    "CoordinateSystem \"c\" TransformEnd CoordSysTransform \"c\" Shape \"sphere\" Include \"b.pbrt\" Shape \"plymesh\" "
    "\"string filename\" \"c.ply\"\n",
    "WorldBegin MediumInterface \"fog\" \"\" MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" Material \"uber\" "
    "\"rgb opacity\" [.5 .5 .5]\n"
    "ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Identity Shape \"sphere\" Material \"dielectric\" "
    "\"spectrum eta\" \"glass-BK7\" Shape \"sphere\"\n",
    "Option \"bool x\" true PixelFilter \"gaussian\" \"float xradius\" 2 Camera \"orthographic\" \"float "
    "screenwindow\" [-1 2 -1 3] WorldBegin\n"
    "Material \"disney\" \"float metallic\" .5 Shape \"sphere\" Material \"translucent\" Shape \"sphere\" Material "
    "\"mirror\" Shape \"sphere\"\n"};

} // namespace

std::vector<std::byte> pbrt_seed(uint32_t number) { return bytes_of_text(kTexts[number % kTexts.size()]); }

bool read_pbrt_input(std::span<const std::byte> input) {
    static const std::filesystem::path path = input_path("pbrt", "input.pbrt");
    return reads([&] {
        Messages messages;
        Scene scene = read_pbrt(path, input, FileAccess(path, {}), {}, messages);
        return check_scene(scene, path.string(), messages);
    });
}

} // namespace pertev
