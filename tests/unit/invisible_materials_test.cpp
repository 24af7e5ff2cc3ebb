#include <doctest/doctest.h>

#include "scene/invisible_materials.h"

using namespace pertev;

namespace invisible_materials_test { // test files are compiled together

/// A triangle of one material.
struct Case {
    Scene scene;

    explicit Case(AlphaMode mode, float alpha = 1) {
        scene.meshes.push_back({.name = "m", .positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .indices = {0, 1, 2}});
        scene.materials.push_back({{.alpha_mode = mode, .alpha = alpha}, "ghost"});
        scene.instances.push_back({.name = "i", .mesh = 0, .material = 0});
    }
    Case& with_texture(uint8_t alpha) {
        TextureImage image;
        image.rgba8 = {.width = 2, .height = 1, .pixels = {9, 9, 9, 0, 9, 9, 9, alpha}};
        scene.images.push_back(std::move(image));
        scene.materials[0].base_color_texture.image = 0;
        return *this;
    }
    Case& with_vertices(float alpha) {
        scene.meshes[0].colors = {{1, 1, 1, 0}, {1, 1, 1, alpha}, {1, 1, 1, 0}};
        return *this;
    }
    bool is_named() const {
        Messages messages;
        warn_of_invisible_materials(scene, "a.obj", messages);
        if (messages.all().empty()) return false;
        CHECK(messages.all().size() == 1);
        CHECK(messages.all()[0].is_warning);
        return messages.all()[0].text.find("ghost") != std::string::npos;
    }
};

TEST_CASE("a material made invisible by its own, its texture's or its vertices' alpha is named") {
    CHECK(Case(AlphaMode::Blend, 0).is_named());
    CHECK(Case(AlphaMode::Mask, 0.4f).is_named());
    CHECK(Case(AlphaMode::Blend).with_texture(0).is_named());
    CHECK(Case(AlphaMode::Mask).with_texture(127).is_named());
    CHECK(Case(AlphaMode::Blend).with_vertices(0).is_named());
    CHECK(Case(AlphaMode::Mask).with_vertices(0.49f).is_named());
    CHECK(Case(AlphaMode::Mask, 0.7f).with_vertices(0.7f).is_named());
}

TEST_CASE("a material that is visible anywhere is not named") {
    CHECK_FALSE(Case(AlphaMode::Opaque, 0).is_named());
    CHECK_FALSE(Case(AlphaMode::Opaque).with_texture(0).with_vertices(0).is_named());
    CHECK_FALSE(Case(AlphaMode::Blend, 0.01f).is_named());
    CHECK_FALSE(Case(AlphaMode::Mask, 0.5f).is_named());
    CHECK_FALSE(Case(AlphaMode::Blend).with_texture(1).is_named());
    CHECK_FALSE(Case(AlphaMode::Mask).with_texture(128).is_named());
    CHECK_FALSE(Case(AlphaMode::Mask).with_vertices(0.5f).is_named());
    Case unused(AlphaMode::Opaque);
    unused.scene.materials.push_back({{.alpha_mode = AlphaMode::Blend, .alpha = 0}, "ghost"});
    CHECK_FALSE(unused.is_named());
    Case shared = Case(AlphaMode::Blend).with_vertices(0); // another mesh with the material has an alpha above 0
    shared.scene.meshes.push_back(shared.scene.meshes[0]);
    shared.scene.meshes[1].colors.clear();
    shared.scene.instances.push_back({.name = "j", .mesh = 1, .material = 0});
    CHECK_FALSE(shared.is_named());
}

} // namespace invisible_materials_test
