// Pictures of 16 bits as textures: each use keeps them, also where others use the same picture otherwise.

#include <doctest/doctest.h>

#include "formats/files/load_textures.h"
#include "image/srgb.h"
#include "image/write_png.h"
#include "tests/support/options.h"

using namespace pertev;

namespace load_textures_test {
namespace {

constexpr uint16_t kWords[] = {0x1234, 0x8001, 0xfedc, 0x7fff};

float of_word(uint16_t word) { return static_cast<float>(word) / 65535.0f; }

/// Loads a PNG of one pixel as the base colour, as normal and roughness, or as all.
Scene load(bool as_color, bool as_data, uint64_t* images = nullptr) {
    Rgba16Image picture{1, 1, {std::begin(kWords), std::end(kWords)}};
    const std::vector<std::byte> bytes = encode_png(picture, true);
    const FileAccess access(test::scratch_folder() / "a.gltf", {});
    Messages messages;
    TextureLoader loader(access, messages);
    const int32_t image = loader.add_bytes("both", bytes);
    Scene scene;
    scene.materials.resize(2);
    if (as_color) {
        scene.materials[0].base_color_texture.image = image;
        scene.materials[0].base_color_texture.is_srgb = true;
    }
    if (as_data) {
        scene.materials[0].normal_texture.image = image;
        scene.materials[1].roughness_texture.image = image;
    }
    loader.load_into(scene);
    CHECK(messages.all().empty());
    if (images != nullptr) *images = scene.images.size();
    return scene;
}

void check_pixel(const Scene& scene, const TextureRef& ref, bool is_color) {
    REQUIRE(ref.has_image());
    const TextureImage& image = scene.images.at(static_cast<std::size_t>(ref.image));
    CHECK(image.name == "both");
    CHECK(image.rgba8.pixels.empty());
    REQUIRE(image.rgba_float.pixels.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        const float stored = of_word(kWords[i]);
        CHECK(image.rgba_float.pixels[i] == (is_color && i < 3 ? srgb_decode(stored) : stored));
    }
}

} // namespace

TEST_CASE("a picture of 16 bits that is used as colours and as data keeps its depth in both") {
    uint64_t images = 0;
    const Scene colors = load(true, false, &images);
    CHECK(images == 1);
    check_pixel(colors, colors.materials[0].base_color_texture, true);
    const Scene data = load(false, true, &images);
    CHECK(images == 1);
    check_pixel(data, data.materials[0].normal_texture, false);
    const Scene both = load(true, true, &images);
    CHECK(images == 2);
    check_pixel(both, both.materials[0].base_color_texture, true);
    check_pixel(both, both.materials[0].normal_texture, false);
    CHECK(both.materials[0].normal_texture.image == both.materials[1].roughness_texture.image);
}

} // namespace load_textures_test
