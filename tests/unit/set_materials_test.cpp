#include <doctest/doctest.h>

#include <set>
#include <string>

#include <fmt/format.h>

#include "scene/metals.h"
#include "session/material_effects.h"
#include "session/opening/open_scene.h"
#include "session/set_materials.h"
#include "shading/lobes/fresnel.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

Scene three_materials() {
    Scene scene;
    for (const char* name : {"gold leaf", "gold ring", ""}) {
        Material material = test::white(0.5f);
        material.name = name;
        test::add(scene, test::floor_at(0, 1), material);
    }
    return scene;
}

void change(Scene& scene, const std::string& text) {
    const MaterialChange changes[] = {parse_material_change(text)};
    set_materials(scene, changes);
}

bool refuses_change(const std::string& text, const std::string& why) {
    Scene scene = three_materials();
    const auto error = test::thrown_error([&] { change(scene, text); });
    return test::is_about(error, ErrorCode::BadInput, "material", text) && test::says(error, why);
}

/// Makes the changes and returns the warnings.
std::vector<Remark> warnings_of_changes(Scene& scene, const std::vector<std::string>& texts) {
    std::vector<MaterialChange> changes;
    for (const std::string& text : texts) changes.push_back(parse_material_change(text));
    Messages messages;
    set_materials(scene, changes, messages);
    std::vector<Remark> remarks;
    for (const Message& message : messages.all()) remarks.push_back(message.remark);
    return remarks;
}

} // namespace

TEST_CASE("a clear boundary stays one whatever else is set, and a medium that no light reaches is reported") {
    Scene scene = three_materials();
    change(scene, "gold leaf is_clear_boundary=true alpha=1 alpha_mode=opaque");
    CHECK(scene.materials[0].is_clear_boundary);
    CHECK(scene.materials[0].alpha == 0);
    CHECK(scene.materials[0].alpha_mode == AlphaMode::Mask);
    CHECK(refuses_change("gold leaf is_clear_boundary=false", "can only be true"));
    const MaterialChange changes[] = {parse_material_change("gold ring medium_sigma_s=1"),
                                      parse_material_change("gold leaf medium_sigma_s=1")};
    Messages messages;
    set_materials(scene, changes, messages);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("materials are changed by name, by wildcards, or by number where they have no name") {
    Scene scene = three_materials();
    change(scene, "gold leaf base_color=1,0.5,0.25");
    CHECK(scene.materials[0].base_color == Rgb{1, 0.5f, 0.25f});
    CHECK(scene.materials[1].base_color == grey(0.5f));
    change(scene, "gold* metallic=1 roughness=0.25");
    CHECK(scene.materials[1].metallic == 1);
    CHECK(scene.materials[1].roughness == 0.25f);
    CHECK(scene.materials[1].kind == MaterialKind::MetallicRoughness); // a diffuse one has neither
    CHECK(scene.materials[2].kind == MaterialKind::Diffuse);
    change(scene, "2 emission=3 double_sided=false alpha_mode=blend alpha=0.5");
    CHECK(scene.materials[2].emission == grey(3));
    CHECK_FALSE(scene.materials[2].double_sided);
    CHECK(scene.materials[2].alpha_mode == AlphaMode::Blend);
    CHECK(scene.materials[2].alpha == 0.5f);
    change(scene, "gold ring kind=conductor eta=1,2,3 k=4");
    CHECK(scene.materials[1].kind == MaterialKind::Conductor);
    CHECK(scene.materials[1].eta == Rgb{1, 2, 3});
    CHECK(scene.materials[1].k == grey(4));
    change(scene, "gold leaf kind=metallic_roughness metal_fresnel=f82 microfacet_distribution=beckmann energy=single");
    change(scene, "gold leaf fuzz_weight=0.5 fuzz_model=zeltner coat_color=1,0.5,0.25");
    CHECK(scene.materials[0].fuzz_model == FuzzModel::Zeltner);
    CHECK(scene.materials[0].coat_color == Rgb{1, 0.5f, 0.25f});
    CHECK(scene.materials[0].metal_fresnel == MetalFresnel::F82);
    CHECK(scene.materials[0].microfacet_distribution == MicrofacetDistribution::Beckmann);
    CHECK(scene.materials[0].energy == MicrofacetEnergy::Single);
    change(scene, "2 base_diffuse_roughness=0.5");
    CHECK(scene.materials[2].kind == MaterialKind::Diffuse);
    CHECK(scene.materials[2].is_stacked());
}

TEST_CASE("names of OpenPBR set the parameters that have others here") {
    Scene scene = three_materials();
    change(scene, "gold leaf base_metalness=1 specular_roughness=0.25 specular_ior=1.25 thin_film_thickness=0.5");
    const Material& leaf = scene.materials[0];
    CHECK(leaf.kind == MaterialKind::MetallicRoughness);
    CHECK(leaf.metallic == 1);
    CHECK(leaf.roughness == 0.25f);
    CHECK(leaf.ior == 1.25f);
    CHECK(leaf.thin_film_thickness_nm == 500);
    change(scene, "gold leaf geometry_thin_walled=false geometry_opacity=1");
    CHECK_FALSE(leaf.thin_walled);
    CHECK(leaf.alpha_mode == AlphaMode::Opaque);
    change(scene, "gold leaf geometry_opacity=0.5");
    CHECK(leaf.alpha == 0.5f);
    CHECK(leaf.alpha_mode == AlphaMode::Blend);
    change(scene, "gold leaf alpha_mode=mask geometry_opacity=0.25");
    CHECK(leaf.alpha_mode == AlphaMode::Mask);
    CHECK(refuses_change("gold leaf specular_roughness=2", "specular_roughness is a number from 0 to 1"));
    CHECK(refuses_change("gold leaf thin_film_thickness=2000", "thin_film_thickness is a number from 0 to 1048.57"));
    CHECK(refuses_change("gold leaf geometry_thin_walled=2", "geometry_thin_walled is"));
}

TEST_CASE("OpenPBR's weight of the base and its emission are products") {
    Scene scene = three_materials();
    change(scene, "gold leaf base_weight=0.5 base_color=1,0.5,0.25"); // in any order
    CHECK(scene.materials[0].base_color == Rgb{0.5f, 0.25f, 0.125f});
    change(scene, "gold ring base_weight=0.25");
    CHECK(scene.materials[1].base_color == grey(0.125f));
    change(scene, "gold leaf emission_color=1,0.5,0 emission_luminance=1366"); // nits; 683 lm/W
    CHECK(scene.materials[0].emission == Rgb{2, 1, 0});
    const MaterialChange gltf[] = {parse_material_change("gold ring emission_luminance=100")};
    set_materials(scene, gltf, nobody(), 1);
    CHECK(scene.materials[1].emission == grey(100));
    CHECK(refuses_change("gold leaf emission_color=1,0,0", "emission_luminance"));
    CHECK(refuses_change("gold leaf emission_luminance=-1", "from 0 to"));
    CHECK(refuses_change("gold leaf emission_luminance=1,1,1", "1 numbers"));
    CHECK(refuses_change("gold leaf base_weight=1.5", "from 0 to 1"));
    for (const char* key : {"coat_darkening", "subsurface_weight", "transmission_scatter", "geometry_normal"}) {
        CHECK(refuses_change(fmt::format("gold leaf {}=1", key), "there is no"));
    }
}

TEST_CASE("a diffuse material becomes metallic-roughness for what only that does, unless the value means nothing") {
    for (const char* value :
         {"metallic=0", "roughness=1", "ior=1.5", "specular_weight=1", "specular_color=1", "transmission_weight=0.5",
          "metal_fresnel=f82", "diffuse_transmission_weight=0.8", "specular_retroreflectivity=1", "thin_film_weight=1",
          "microfacet_distribution=beckmann", "energy=single", "specular_roughness_anisotropy=0.5"}) {
        CAPTURE(value);
        Scene scene = three_materials();
        CHECK(warnings_of_changes(scene, {std::string("gold leaf ") + value}).empty());
        CHECK(scene.materials[0].kind == MaterialKind::MetallicRoughness);
    }
    for (const char* value : {"diffuse_transmission_weight=0", "specular_retroreflectivity=0", "thin_film_weight=0",
                              "microfacet_distribution=ggx", "energy=compensated", "specular_roughness_anisotropy=0",
                              "thin_walled=true", "priority=0", "transmission_color=1", "coat_weight=1",
                              "fuzz_weight=1", "base_diffuse_roughness=1", "emission=1"}) {
        CAPTURE(value);
        Scene scene = three_materials();
        CHECK(warnings_of_changes(scene, {std::string("gold leaf ") + value}).empty());
        CHECK(scene.materials[0].kind == MaterialKind::Diffuse);
    }
}

TEST_CASE("parameters without an effect on the kind of their material are reported, with its name") {
    const auto warns = [](const std::string& kind, const std::string& value, const std::string& key) {
        Scene scene = three_materials();
        const std::string of_kind = "gold leaf kind=" + kind + " " + value;
        const std::vector<Remark> found = warnings_of_changes(scene, {of_kind});
        CAPTURE(of_kind);
        REQUIRE(found.size() == (key.empty() ? 0 : 1));
        if (key.empty()) return;
        CHECK(found[0].setting == "material");
        CHECK(found[0].value == of_kind);
        for (const std::string& part : {key, "kind=" + kind, std::string("'gold leaf'")})
            CHECK(found[0].reason.find(part) != std::string::npos);
    };
    for (const char* key : {"thin_walled=false", "priority=1", "has_relative_ior=true", "transmission_depth=1"})
        warns("diffuse", key, std::string(key).substr(0, std::string(key).find('=')));
    warns("conductor", "specular_weight=0.3", "specular_weight");
    warns("conductor", "specular_weight=0.3 energy=single", ""); // here it has one
    warns("conductor", "specular_color=1,0,0 thin_film_weight=1", "specular_color, thin_film_weight have");
    warns("conductor", "geometry_thin_walled=false", "geometry_thin_walled");
    warns("conductor", "base_metalness=0", "base_metalness");
    warns("conductor", "metallic=1 transmission_weight=0 thin_walled=true ior=1.5", "");
    warns("dielectric", "specular_weight=0.3 specular_color=1,0,0", "specular_weight, specular_color");
    warns("dielectric", "transmission_weight=0", "transmission_weight"); // all of it transmits
    warns("dielectric", "transmission_weight=1 thin_walled=false thin_film_weight=1", "");
    warns("dielectric", "thin_walled=true", "thin_walled");
    warns("unlit", "emission=1", "emission");
    warns("unlit", "base_color=1 alpha=0.5", "");
    Scene scene = three_materials();
    CHECK(warnings_of_changes(scene, {"gold* thin_walled=false", "gold leaf transmission_weight=1"}).size() == 1);
    CHECK(scene.materials[0].is_solid());
    CHECK(warnings_of_changes(scene, {"gold ring kind=conductor", "gold ring eta=1", "gold ring kind=dielectric"})
              .size() == 1);
}

TEST_CASE("each parameter of a material is judged by its kind, but those that all kinds use") {
    std::set<std::string> not_judged;
    const auto note = [&](auto&&, const char* name, auto&&...) {
        if (!is_judged(name)) not_judged.insert(name);
    };
    const MaterialParameters material;
    visit_choices(material, note);
    visit_flags(material, note);
    visit_parameters(material, note, [](auto&&...) {});
    CHECK(not_judged == std::set<std::string>{"alpha", "alpha_cutoff", "alpha_mode", "double_sided",
                                              "is_clear_boundary", "kind", "medium_g", "medium_sigma_a",
                                              "medium_sigma_s"});
}

TEST_CASE("measured metals reflect as published, and an unknown one is answered with the list") {
    Scene scene = three_materials();
    change(scene, "gold* metal=gold");
    CHECK(scene.materials[1].kind == MaterialKind::Conductor);
    CHECK(scene.materials[1].eta == find_metal("gold")->eta);
    CHECK(refuses_change("gold leaf metal=unobtainium", "aluminium"));
    CHECK(refuses_change("gold leaf metal=unobtainium", "vanadium"));
    CHECK(find_metal("Gold") == nullptr);
    const auto at_normal = [](const char* name) {
        const MeasuredMetal& metal = *find_metal(name);
        return fresnel_conductor(1, metal.eta, metal.k);
    };
    const auto is_near = [](Rgb a, Rgb b) { return max_component(a - b) < 0.03f && max_component(b - a) < 0.03f; };
    CHECK(is_near(at_normal("silver"), {0.99f, 0.98f, 0.98f})); // linear Rec. 709, from tables of reflectance
    CHECK(is_near(at_normal("aluminium"), {0.91f, 0.92f, 0.92f}));
    CHECK(is_near(at_normal("copper"), {0.93f, 0.63f, 0.53f}));
    CHECK(is_near(at_normal("iron"), {0.53f, 0.51f, 0.49f}));
    for (std::size_t i = 1; i < measured_metals().size(); ++i) {
        CHECK(measured_metals()[i - 1].name < measured_metals()[i].name);
    }
}

TEST_CASE("a texture of a material can be dropped") {
    Scene scene = three_materials();
    scene.images.emplace_back().rgba8 = {1, 1, {1, 2, 3, 4}};
    scene.materials[0].base_color_texture.image = 0;
    change(scene, "gold leaf base_color_texture=none");
    CHECK_FALSE(scene.materials[0].base_color_texture.has_image());
    CHECK(refuses_change("gold leaf base_color_texture=x.png", "none"));
}

TEST_CASE("a change of a material that is not possible is refused with what is") {
    CHECK(refuses_change("silver roughness=0.1", "'gold leaf'"));
    CHECK(refuses_change("gold leaf shine=1", "roughness"));
    CHECK(refuses_change("gold leaf roughness=2", "from 0 to 1"));
    CHECK(refuses_change("gold leaf roughness=nan", "from 0 to 1"));
    CHECK(refuses_change("gold leaf ior=0", "to 1024"));
    CHECK(refuses_change("gold leaf roughness=", "from 0 to 1"));
    CHECK(refuses_change("gold leaf base_color=1,0", "3"));
    CHECK(refuses_change("gold leaf kind=metal", "conductor"));
    CHECK(refuses_change("gold leaf double_sided=1", "true"));
    CHECK(refuses_change("gold leaf eta=1", "kind=conductor"));
    for (const char* text : {"gold leaf", "roughness=1", "", " =1"}) {
        CHECK(test::is_about(test::thrown_error([&] { parse_material_change(text); }), ErrorCode::BadInput, "material",
                             text));
    }
}

TEST_CASE("a material's description is a change that makes the same material") {
    Scene scene = three_materials();
    change(scene, "gold leaf base_color=1,0.5,0.25 metallic=1 roughness=0.123 coat_weight=0.5 thin_walled=false");
    change(scene, "gold leaf ior=0.75 has_relative_ior=true");
    change(scene, "gold ring kind=conductor alpha_mode=mask k=1,2,3 microfacet_distribution=beckmann energy=single");
    for (std::size_t i = 0; i < 2; ++i) {
        const std::string text = describe_material(scene, i);
        CAPTURE(text);
        Scene fresh = three_materials();
        change(fresh, text);
        CHECK(describe_material(fresh, i) == text);
    }
    CHECK(describe_material(scene, 2) == "2 kind=diffuse base_color=0.5");
    scene.images.emplace_back().name = "leaf.png";
    scene.materials[2].base_color_texture.image = 0;
    CHECK(describe_material(scene, 2).ends_with("base_color_texture=leaf.png"));
}

TEST_CASE("an opened scene has the changed materials, before its lights are set") {
    SceneOptions options;
    options.scene = "cornell-box";
    options.materials = {"*hite* base_color=0.25"};
    Messages messages;
    const Scene scene = open_scene(options, messages);
    std::size_t changed = 0;
    for (const Material& material : scene.materials) changed += material.base_color == grey(0.25f);
    CHECK(changed > 0);
    options.materials = {"none roughness=1"};
    CHECK(test::thrown_error([&] { open_scene(options, messages); }));
}
