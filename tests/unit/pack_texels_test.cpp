// Float images lie on a device in as few bits as hold the same values, to the bit.

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/pack_texels.h"
#include "device_scene/scene_on_device.h"
#include "image/srgb.h"
#include "render/prepare_scene.h"
#include "session/render_memory.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

/// Returns whether the packed texels are those of the floats, to the bit.
bool are_same(const PackedTexels& packed, const std::vector<float>& floats) {
    std::vector<float> table(kSrgbBytes);
    table.insert(table.end(), srgb_words_table().begin(), srgb_words_table().end());
    const TextureImageView view = {.width = static_cast<uint32_t>(floats.size() / 4),
                                   .height = 1,
                                   .rgba_float = packed.words.empty() ? floats.data() : nullptr,
                                   .rgba16 = packed.words.empty() ? nullptr : packed.words.data(),
                                   .depth = packed.depth};
    bool same = true;
    for (uint32_t i = 0; i < view.width; ++i) {
        for (const bool is_srgb : {false, true}) {
            const Vec4 texel = load_texel(view, i, 0, is_srgb, table.data());
            same = same && std::memcmp(&texel, &floats[4 * i], 16) == 0;
            for (uint32_t c = 0; c < 4; ++c) {
                same = same &&
                       bits_of(load_texel_channel(view, i, 0, c, is_srgb, table.data())) == bits_of(floats[4 * i + c]);
            }
        }
    }
    return same;
}

/// All 65536 words, `value(word)` as colours and alpha(word) as alpha.
template <class Value, class Alpha>
std::vector<float> all_words(const Value& value, const Alpha& alpha) {
    std::vector<float> floats;
    for (uint32_t word = 0; word < 65536; ++word) {
        for (uint32_t c = 0; c < 3; ++c) floats.push_back(value((word + 777 * c) % 65536));
        floats.push_back(alpha(word));
    }
    return floats;
}

float unit(uint32_t word) { return static_cast<float>(word) / 65535.0f; }

} // namespace

TEST_CASE("texels: 16-bit integers, linear and sRGB-encoded, take 16 bits and keep their values") {
    const std::vector<float> linear = all_words(unit, unit);
    const PackedTexels of_linear = pack_texels(linear);
    CHECK(of_linear.depth == TexelDepth::Unorm16);
    CHECK(are_same(of_linear, linear));
    const std::vector<float> colors = all_words([](uint32_t word) { return srgb_decode(unit(word)); }, unit);
    const PackedTexels of_colors = pack_texels(colors);
    CHECK(of_colors.depth == TexelDepth::Srgb16);
    CHECK(are_same(of_colors, colors));
}

TEST_CASE("texels: every finite half is one, and other floats stay floats") {
    std::vector<float> halves;
    for (uint32_t word = 0; word < 65536; ++word) {
        const uint32_t exponent = word >> 10 & 31, fraction = word & 1023;
        if (exponent == 31) continue;
        const double size =
            exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(1024 + fraction, static_cast<int>(exponent) - 25);
        halves.push_back(static_cast<float>((word & 0x8000u) != 0 ? -size : size));
    }
    const PackedTexels packed = pack_texels(halves);
    CHECK(packed.depth == TexelDepth::Half);
    CHECK(are_same(packed, halves));
    for (const float other : {65520.0f, 0x1p-25f, 3 * 0x1p-25f, 1 + 0x1p-11f, -0.3f, 1e30f, 0x1p-140f}) {
        CAPTURE(other);
        for (const std::size_t at : {std::size_t(2), halves.size() - 2}) {
            std::vector<float> more = halves;
            more[at] = other;
            const PackedTexels floats = pack_texels(more);
            CHECK(floats.depth == TexelDepth::Float);
            CHECK(floats.words.empty());
            CHECK(are_same(floats, more));
        }
    }
}

TEST_CASE("a device holds an image once, at its depth, however many materials use it") {
    Scene scene;
    TextureImage words;
    words.rgba_float = {64, 64, 4, {}};
    for (uint32_t i = 0; i < 4 * 64 * 64; ++i) words.rgba_float.pixels.push_back(unit(7 * i % 65536));
    scene.images.push_back(words);
    Material material = test::white();
    material.base_color_texture.image = 0;
    for (int i = 0; i < 50; ++i) test::add(scene, test::floor_at(0.1f * static_cast<float>(i), 1), material);
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    CHECK(texture_bytes(scene) == 64 * 64 * 8);
    Queue queue = Queue::make_cpu();
    const SceneOnDevice on_device(queue, prepared);
    CHECK(on_device.view().images[0].depth == TexelDepth::Unorm16);
    CHECK(predicted_bytes(prepared, false) == queue.allocated_bytes());
    scene.images.clear();
    for (Material& plain : scene.materials) plain.base_color_texture = {};
    Queue without = Queue::make_cpu();
    const SceneOnDevice plain(without, prepare_scene(scene, {}, messages));
    const std::size_t more = queue.allocated_bytes() - without.allocated_bytes();
    CHECK(more >= 64 * 64 * 8);
    CHECK(more <= 64 * 64 * 8 + 512);
}

TEST_CASE("the error for too little memory names the textures where they take the most") {
    const RenderSettings settings;
    for (const uint64_t textures : {uint64_t(1) << 33, uint64_t(1)}) {
        const auto error = test::thrown_error([&] {
            check_render_memory(std::size_t(1) << 34, settings, {1 << 20, true, false}, textures);
        });
        REQUIRE(error);
        CHECK(error->code() == ErrorCode::OutOfMemory);
        CHECK(test::says(error, "max_texture_size") == (textures > 1));
    }
    RenderSettings cropped;
    for (const char* const name : {"`size`", "`crop`"}) {
        CHECK(test::says(test::thrown_error([&] {
                             check_render_memory(std::size_t(1) << 34, cropped, {1 << 20, true, false}, 0);
                         }),
                         name));
        cropped.crop = PictureCrop{0, 0, 2, 2};
    }
}
