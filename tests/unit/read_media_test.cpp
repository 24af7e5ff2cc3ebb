// Homogeneous media of files: pbrt, Mitsuba and glTF (formats/pbrt/media.h, formats/mitsuba/media.h,
// KHR_materials_volume_scatter).

#include <doctest/doctest.h>

#include <string>

#include "formats/read_scene.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

Scene read_with_media(const std::string& name, const std::string& text, Messages& messages) {
    return read_scene(test::write_text(test::scratch_folder() / name, text), {}, messages);
}
Scene read_with_media(const std::string& name, const std::string& text) {
    Messages messages;
    Scene scene = read_with_media(name, text, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    return scene;
}

const Material& material_of(const Scene& scene, std::size_t instance) {
    return scene.materials[scene.instances.at(instance).material];
}
void check_rates(Rgb rates, Rgb expected) {
    CHECK(rates.r == doctest::Approx(expected.r).epsilon(1e-4));
    CHECK(rates.g == doctest::Approx(expected.g).epsilon(1e-4));
    CHECK(rates.b == doctest::Approx(expected.b).epsilon(1e-4));
}

/// Returns the material of a glTF file whose only one has these extensions.
Material gltf_material(const std::string& extensions) {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    return material_of(
        read_with_media("m.gltf",
                        builder.json(R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"material":0,)"
                                     R"("attributes":{"POSITION":0}}]}],"materials":[{"pbrMetallicRoughness":)"
                                     R"({"metallicFactor":0},"extensions":{)" +
                                     extensions + "}}]")),
        0);
}

} // namespace

TEST_CASE("pbrt: the camera's medium is around everything, and others are in shapes") {
    const Scene scene = read_with_media(
        "m.pbrt",
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [4 5 6] "
        "\"float scale\" .5 \"float g\" .25\n"
        "MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin\n"
        "MakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"string preset\" \"Wholemilk\"\n"
        "Material \"diffuse\" Shape \"sphere\"\n"
        "AttributeBegin MediumInterface \"milk\" \"fog\" Material \"interface\" Shape \"sphere\" Material "
        "\"dielectric\" Shape \"sphere\" AttributeEnd\n"
        "Material \"interface\" Shape \"sphere\"\n"
        "AttributeBegin MediumInterface \"fog\" Shape \"sphere\" AttributeEnd\n");
    check_rates(scene.medium.sigma_a, {0.5f, 1, 1.5f});
    check_rates(scene.medium.sigma_s, {2, 2.5f, 3});
    CHECK(scene.medium.g == 0.25f);
    REQUIRE(scene.instances.size() == 4); // the last one divides nothing
    CHECK(!material_of(scene, 0).medium.is_there());
    CHECK(material_of(scene, 1).is_clear_boundary);
    check_rates(material_of(scene, 1).medium.sigma_s, {2.55f, 3.21f, 3.77f});
    CHECK(material_of(scene, 2).kind == MaterialKind::Dielectric);
    check_rates(material_of(scene, 2).medium.sigma_a, {0.0011f, 0.0024f, 0.014f});
    CHECK(material_of(scene, 3).is_clear_boundary); // a hollow in the fog
    CHECK(!material_of(scene, 3).medium.is_there());
}

TEST_CASE("pbrt: a subsurface material is a medium in glass, and grids are left out") {
    const Scene skin =
        read_with_media("m.pbrt", "WorldBegin Material \"subsurface\" \"rgb sigma_a\" [1 1 2] \"rgb sigma_s\" "
                                  "[3 4 5] \"float scale\" 10 \"float eta\" 1.4 Shape \"sphere\"\n"
                                  "Material \"subsurface\" \"rgb reflectance\" [.5 .5 .5] \"rgb mfp\" [.1 .2 "
                                  ".5] Shape \"sphere\"\n");
    CHECK(material_of(skin, 0).ior == 1.4f);
    check_rates(material_of(skin, 0).medium.sigma_s, {30, 40, 50});
    CHECK(material_of(skin, 1).ior == 1.33f);
    check_rates(material_of(skin, 1).medium.sigma_t(), {10, 5, 2});
    CHECK(material_of(skin, 1).medium.sigma_s.r == doctest::Approx(10 * 0.91171).epsilon(1e-3));
    Messages messages;
    const Scene cloud =
        read_with_media("m.pbrt",
                        "WorldBegin MakeNamedMedium \"c\" \"string type\" \"uniformgrid\" \"float density\" [1 2]\n"
                        "MediumInterface \"c\" \"\" Material \"interface\" Shape \"sphere\"\n"
                        "Material \"diffuse\" Shape \"sphere\"\n",
                        messages);
    CHECK(messages.left_out().size() == 1);
    CHECK(!cloud.medium.is_there());
    CHECK(cloud.instances.size() == 1); // an interface between vacua is not there
    const Scene later =
        read_with_media("m.pbrt", "WorldBegin MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"\n"
                                  "MakeNamedMedium \"m\" \"string type\" \"homogeneous\"\n");
    CHECK(material_of(later, 0).medium.scatters());
    Messages unknown;
    (void)read_with_media("m.pbrt",
                          "WorldBegin MediumInterface \"fog\" \"\" Material \"interface\" Shape \"sphere\"\n"
                          "Material \"diffuse\" Shape \"sphere\"\n",
                          unknown);
    CHECK(unknown.left_out().size() == 1);
}

TEST_CASE("pbrt: the medium of a camera in a body is in the body alone, and that outside of it around everything") {
    const std::string media = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [1 1 1]\n"
                              "MakeNamedMedium \"haze\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [2 2 2]\n"
                              "MediumInterface \"\" \"fog\" Camera \"perspective\" WorldBegin Material \"interface\"\n";
    const auto body = [](const std::string& inside, const std::string& outside) {
        return "MediumInterface \"" + inside + "\" \"" + outside + "\" Shape \"sphere\"\n";
    };
    CHECK(read_with_media("m.pbrt", media + body("fog", "")).medium == MediumParameters());
    CHECK(read_with_media("m.pbrt", media + body("fog", "haze")).medium.sigma_s.r == 2);
    const Scene bubble =
        read_with_media("m.pbrt", media + body("fog", "haze") + "Material \"dielectric\"\n" + body("", "fog"));
    CHECK(bubble.medium.sigma_s.r == 2); // glass is no space around
    const Scene hollow = read_with_media("m.pbrt", media + body("fog", "") + body("", "fog"));
    CHECK(hollow.medium.sigma_s.r == 1);
    Messages differing;
    CHECK(read_with_media("m.pbrt", media + body("fog", "") + body("fog", "haze"), differing).medium.sigma_s.r == 1);
    CHECK(differing.left_out().size() == 2); // the haze is nowhere
}

TEST_CASE("pbrt: coefficients are those of pbrt, by name before sigma and reflectance, and what differs is said") {
    const auto subsurface = [](const std::string& parameters, std::size_t left_out) {
        Messages messages;
        const Scene scene =
            read_with_media("m.pbrt", "WorldBegin Material " + parameters + " Shape \"sphere\"\n", messages);
        CHECK(messages.left_out().size() == left_out);
        return material_of(scene, 0).medium;
    };
    check_rates(subsurface("\"kdsubsurface\" \"rgb mfp\" [.1 .2 .5] \"float scale\" 2", 0).sigma_t(), {5, 2.5f, 1});
    check_rates(subsurface("\"kdsubsurface\"", 0).sigma_t(), {1, 1, 1});
    const MediumParameters marble =
        subsurface("\"subsurface\" \"string name\" \"Marble\" \"float g\" .5 \"rgb sigma_a\" [1 1 1]", 2);
    check_rates(marble.sigma_s, {2.19f, 2.62f, 3});
    CHECK(marble.g == 0);
    check_rates(subsurface("\"subsurface\" \"rgb sigma_a\" [1 1 1] \"rgb reflectance\" [0 0 0]", 1).sigma_a, {1, 1, 1});
    check_rates(subsurface("\"subsurface\" \"string name\" \"Marbel\" \"rgb sigma_a\" [1 2 3]", 1).sigma_a, {1, 2, 3});
    (void)subsurface("\"subsurface\" \"rgb Kr\" [1 1 1] \"rgb Kt\" [.5 1 1]", 1);
    const Scene leaf = read_with_media(
        "m.pbrt",
        "WorldBegin MakeNamedMedium \"m\" \"string type\" \"homogeneous\" MediumInterface \"m\" \"\" Material "
        "\"diffusetransmission\" Shape \"sphere\"\n");
    CHECK(material_of(leaf, 0).medium.scatters());
}

TEST_CASE("Mitsuba: the first sensor's medium counts, and an invisible emitter has none") {
    const std::string fog = "<medium type='homogeneous' id='fog'/>", ball = "<shape type='sphere'><bsdf type='null'/>";
    Messages sensors;
    const Scene first =
        read_with_media("m.xml",
                        "<scene version='3.0.0'>" + fog +
                            "<sensor type='perspective'/><sensor type='perspective'><ref name='medium' "
                            "id='fog'/></sensor><shape type='sphere'><bsdf type='dielectric'/></shape></scene>",
                        sensors);
    CHECK(sensors.left_out().size() == 1);
    CHECK(!first.medium.is_there());
    const Scene inside = read_with_media(
        "m.xml", "<scene version='3.0.0'>" + fog + "<sensor type='perspective'><ref name='medium' id='fog'/></sensor>" +
                     ball + "<ref name='interior' id='fog'/></shape></scene>");
    CHECK(!inside.medium.is_there());
    CHECK(material_of(inside, 0).medium.is_there());
    Messages messages;
    const Scene lamp = read_with_media("m.xml",
                                       "<scene version='3.0.0'>" + fog + ball +
                                           "<emitter type='area'/><ref name='interior' id='fog'/></shape></scene>",
                                       messages);
    CHECK(messages.left_out().size() == 2); // the medium, and what lies behind
    CHECK(!material_of(lamp, 0).is_clear_boundary);
    CHECK(material_of(lamp, 0).emission.r > 0);
}

TEST_CASE("Mitsuba: the sensor's medium is around everything, and interior ones are in shapes") {
    const Scene scene = read_with_media(
        "m.xml",
        "<scene version='3.0.0'><medium type='homogeneous' id='fog'><rgb name='sigma_t' value='.2,.4,.6'/><float "
        "name='scale' value='10'/><rgb name='albedo' value='.5,.5,1'/><phase type='hg'><float name='g' "
        "value='-.5'/></phase></medium>"
        "<sensor type='perspective'><ref name='medium' id='fog'/></sensor>"
        "<shape type='sphere'><bsdf type='dielectric'/><ref name='exterior' id='fog'/></shape>"
        "<shape type='cube'><bsdf type='null'/><medium name='interior' type='homogeneous'><rgb name='sigma_t' "
        "value='1,.5,.25'/></medium></shape><shape type='cube'><bsdf type='null'/></shape></scene>");
    check_rates(scene.medium.sigma_s, {1, 2, 6});
    check_rates(scene.medium.sigma_a, {1, 2, 0});
    CHECK(scene.medium.g == -0.5f);
    REQUIRE(scene.instances.size() == 2);
    CHECK(!material_of(scene, 0).medium.is_there());
    CHECK(material_of(scene, 1).is_clear_boundary);
    check_rates(material_of(scene, 1).medium.sigma_s, {0.75f, 0.375f, 0.1875f});
    Messages messages;
    const Scene opaque = read_with_media(
        "m.xml",
        "<scene version='3.0.0'><shape type='cube'><bsdf type='diffuse'/><medium name='interior' "
        "type='homogeneous'/></shape><shape type='sphere'><bsdf type='dielectric'/><medium name='exterior' "
        "type='homogeneous'/></shape></scene>",
        messages);
    CHECK(messages.left_out().size() == 2); // in an opaque shape, and outside of one
}

TEST_CASE("a medium in a surface that light passes straight has a boundary of its own just inside") {
    const std::string medium =
        "<medium name='interior' type='homogeneous'><rgb name='sigma_t' value='1,2,3'/></medium></shape></scene>";
    for (const char* const bsdf : {"<bsdf type='thindielectric'/>",
                                   "<bsdf type='mask'><bsdf type='twosided'><bsdf type='diffuse'/></bsdf></bsdf>"}) {
        const Scene scene =
            read_with_media("m.xml", std::string("<scene version='3.0.0'><shape type='cube'>") + bsdf + medium);
        REQUIRE(scene.instances.size() == 2);
        CHECK(!material_of(scene, 0).medium.is_there());
        CHECK(material_of(scene, 1).is_clear_boundary);
        check_rates(material_of(scene, 1).medium.sigma_s, {0.75f, 1.5f, 2.25f});
        const Mesh& inner = scene.meshes.at(scene.instances[1].mesh);
        CHECK(inner.positions.size() == 8); // 24 vertices are joined, so that it is closed
        const Bounds3 box = bounds_of(inner);
        CHECK(box.hi.x < 0.9999f);
        CHECK(box.hi.x > 0.9990f);
        CHECK(box.lo.y > -0.9999f);
    }
    const std::string in_milk = "WorldBegin MakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"string preset\" "
                                "\"Wholemilk\" MediumInterface \"milk\" \"\"\n";
    const Scene pane = read_with_media("m.pbrt", in_milk + "Material \"thindielectric\" Shape \"sphere\"\n");
    REQUIRE(pane.instances.size() == 2);
    CHECK(material_of(pane, 1).is_clear_boundary);
    // Light that pbrt's alpha lets through stays in the medium outside.
    const Scene leaf =
        read_with_media("m.pbrt", in_milk + "Material \"diffuse\" Shape \"sphere\" \"float alpha\" .5\n");
    CHECK(leaf.instances.size() == 1);
}

TEST_CASE("pbrt: misspelt types of media and names of spectra have pbrt's spelling suggested") {
    const auto says = [](const std::string& text, const char* wanted) {
        Messages messages;
        (void)read_with_media("m.pbrt", "WorldBegin " + text + " Shape \"sphere\"", messages);
        REQUIRE(messages.left_out().size() == 1);
        CHECK_MESSAGE(messages.left_out()[0].find(wanted) != std::string::npos, messages.left_out()[0]);
    };
    says("MakeNamedMedium \"m\" \"string type\" \"homogenous\"", "did you mean \"homogeneous\"?");
    says("Material \"conductor\" \"spectrum eta\" \"metal-Agg-eta\"", "did you mean \"metal-Ag-eta\"?");
    says("Material \"dielectric\" \"spectrum eta\" \"glass-FF11\"", "did you mean \"glass-F11\"?");
}

TEST_CASE("Mitsuba: the albedo of a medium may be a volume of one colour") {
    const Scene scene = read_with_media(
        "m.xml",
        "<scene version='3.0.0'><shape type='cube'><bsdf type='null'/><medium name='interior' type='homogeneous'>"
        "<float name='sigma_t' value='2'/><volume name='albedo' type='constvolume'><rgb name='value' "
        "value='.9,.5,.25'/></volume></medium></shape></scene>");
    check_rates(material_of(scene, 0).medium.sigma_s, {1.8f, 1, 0.5f});
    check_rates(material_of(scene, 0).medium.sigma_a, {0.2f, 1, 1.5f});
}

TEST_CASE("glTF: volume scatter is a medium whose extinction is the volume's attenuation") {
    const std::string volume = R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,0.25,1],)"
                               R"("attenuationDistance":0.1})";
    const std::string scatter =
        R"("KHR_materials_volume_scatter":{"multiscatterColor":[0.5,1,1],"scatterAnisotropy":0.3})";
    const Material milk =
        gltf_material(R"("KHR_materials_transmission":{"transmissionFactor":1},)" + volume + "," + scatter);
    CHECK(milk.kind == MaterialKind::Dielectric);
    CHECK(!milk.absorbs()); // the medium does
    check_rates(milk.medium.sigma_t(), {6.93147f, 13.86294f, 0});
    CHECK(milk.medium.sigma_s.r == doctest::Approx(6.93147 * 0.91171).epsilon(1e-3));
    CHECK(milk.medium.sigma_a.g == doctest::Approx(0).epsilon(1e-3));
    CHECK(milk.medium.g == 0.3f);
    const Material wax =
        gltf_material(R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":1},"KHR_materials_volume":)"
                      R"({"attenuationColor":[0.5,0.25,1],"attenuationDistance":0.1},)" +
                      scatter);
    CHECK(wax.encloses());
    CHECK(wax.medium.scatters());
    CHECK(!gltf_material(R"("KHR_materials_transmission":{"transmissionFactor":1},)" + volume).medium.is_there());
}

TEST_CASE("glTF: an animation of the attenuation of a volume that scatters is left out, and others play") {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("SCALAR", std::vector<float>{0, 1});
    builder.add("SCALAR", std::vector<float>{1, 2});
    const auto read = [&](const std::string& scatter, Messages& messages) {
        return read_with_media(
            "m.gltf",
            builder.json(
                R"("extensionsUsed":["KHR_animation_pointer"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)"
                R"({"material":0,"attributes":{"POSITION":0}}]}],"materials":[{"pbrMetallicRoughness":)"
                R"({"metallicFactor":0},"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},)"
                R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,0.25,1],)"
                R"("attenuationDistance":1})" +
                scatter +
                R"(}}],"animations":[{"samplers":[{"input":1,"output":2}],"channels":[{"sampler":0,"target":{)"
                R"("path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/materials/0/extensions/)"
                R"(KHR_materials_volume/attenuationDistance"}}}}]}])"),
            messages);
    };
    Messages plain, scattering;
    CHECK(read("", plain).animations.at(0).channels.size() == 1);
    CHECK(plain.left_out().empty());
    const Scene milk = read(R"(,"KHR_materials_volume_scatter":{"multiscatterColor":[1,1,1]})", scattering);
    CHECK((milk.animations.empty() || milk.animations[0].channels.empty()));
    CHECK(scattering.left_out().size() == 1);
}
