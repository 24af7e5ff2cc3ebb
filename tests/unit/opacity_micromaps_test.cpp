// Opacity micromaps agree with the texture at every point or are undecided there. They are decided for most points.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/accept_hit.h"
#include "device_scene/classify_opacity.h"
#include "device_scene/opacity_micromaps.h"
#include "device_scene/scene_on_device.h"
#include "render/prepare_scene.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

/// A disc of alpha 1 in a square of alpha 0 with `size` texels per side. The disc's edge is `soft` texels wide.
Rgba8Image disc(uint32_t size, float soft) {
    Rgba8Image image = {size, size, std::vector<uint8_t>(size_t(4) * size * size, 255)};
    for (uint32_t y = 0; y < size; ++y) {
        for (uint32_t x = 0; x < size; ++x) {
            const float half = 0.5f * static_cast<float>(size);
            const float from = std::hypot(static_cast<float>(x) + 0.5f - half, static_cast<float>(y) + 0.5f - half);
            const float alpha = clamp((0.8f * half - from) / soft + 0.5f, 0.0f, 1.0f);
            image.pixels[4 * (size_t(y) * size + x) + 3] = static_cast<uint8_t>(std::lround(255 * alpha));
        }
    }
    return image;
}

TextureImage of_numbers(uint32_t width, uint32_t height, test::Random& random) {
    TextureImage image;
    image.rgba_float = {width, height, 4, std::vector<float>(size_t(4) * width * height)};
    for (float& value : image.rgba_float.pixels) value = random.unit() < 0.7f ? 1.0f : 3 * random.unit() - 1;
    return image;
}

/// A scene in which each instance has its own mesh and material.
struct CutOuts {
    Scene scene;
    test::Random random{7};

    CutOuts() {
        for (const uint32_t size : {64u, 7u, 1u}) {
            TextureImage image;
            image.rgba8 = disc(size, 3);
            scene.images.push_back(image);
        }
        scene.images.push_back(of_numbers(13, 5, random));
    }

    /// Triangles anywhere over a texture, from part of a texel to several repetitions.
    Mesh triangles(uint32_t count, float most) {
        Mesh mesh;
        for (uint32_t i = 0; i < count; ++i) {
            const float size = most * std::pow(0.001f, random.unit());
            const Vec2 at = {4 * random.unit() - 2, 4 * random.unit() - 2};
            for (uint32_t k = 0; k < 3; ++k) {
                mesh.positions.push_back({random.unit(), random.unit(), random.unit()});
                for (std::vector<Vec2>& uv : mesh.uv)
                    uv.push_back({at.x + size * (random.unit() - 0.5f), at.y + size * (random.unit() - 0.5f)});
                mesh.indices.push_back(3 * i + k);
            }
        }
        return mesh;
    }
    void add(const Mesh& mesh, const Material& material) {
        const auto number = static_cast<uint32_t>(scene.instances.size());
        scene.meshes.push_back(mesh);
        scene.materials.push_back(material);
        scene.instances.push_back({"", number, number, {}});
    }
};

/// The opacity at points of a scene, with micromaps and with textures only, on the CPU.
struct Micromaps {
    explicit Micromaps(const Scene& of)
        : scene(of), prepared(prepare_scene(scene, {}, messages)), device(queue, prepared) {
        maps.update(queue, scene, device.view(), true);
        with = device.view();
        with.micromaps = maps.of_instances();
        REQUIRE(device.view().micromaps == nullptr);
    }
    Opacity known(uint32_t instance, uint32_t primitive, float u, float v) const {
        const OpacityMicromapView& map = with.micromaps[instance];
        return map.states != nullptr ? opacity_at(map, primitive, u, v) : Opacity::Unknown;
    }
    bool is_same(uint32_t instance, uint32_t primitive, float u, float v, uint32_t key) const {
        const SceneView& without = device.view();
        return AcceptHit{with, {}, {}, key}(instance, primitive, u, v) ==
               AcceptHit{without, {}, {}, key}(instance, primitive, u, v);
    }

    const Scene& scene;
    Messages messages;
    Queue queue = Queue::make_cpu();
    PreparedScene prepared;
    SceneOnDevice device;
    OpacityMicromaps maps;
    SceneView with;
};

/// The bounds of an image's alpha, in host memory.
struct Pyramid {
    explicit Pyramid(const TextureImageView& image) {
        bounds.image = &image, bounds.channel = 3;
        for (uint32_t level = 1; halved(max(image.width, image.height), level - 1) > 1; ++level) {
            levels.emplace_back(size_t(halved(image.width, level)) * halved(image.height, level));
            const HalveTexelBounds halve = {bounds, level, levels.back().data()};
            for (uint32_t cell = 0; cell < levels.back().size(); ++cell) halve(cell);
            bounds.levels[level] = levels.back().data();
        }
    }
    std::vector<std::vector<ValueRange>> levels;
    TexelBoundsView bounds = {};
};

/// Barycentrics anywhere: inside, on edges, corners and lines between micro-triangles, and as far outside as a hit can
/// be.
Vec2 some_place(test::Random& random) {
    float u = random.unit(), v = random.unit();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    switch (static_cast<int>(6 * random.unit())) {
    case 0:
        return {u, 0};
    case 1:
        return {u, 1 - u};
    case 2:
        return {std::round(32 * u) / 32, v};
    case 3:
        return {std::round(32 * u) / 32, std::round(32 * v) / 32};
    case 4:
        return {std::nextafter(std::round(16 * u) / 16, 2.0f), std::nextafter(1 - std::round(16 * u) / 16, 2.0f)};
    default:
        return {u, v};
    }
}

} // namespace

TEST_CASE("each micro-triangle has a unique index, which all of its points have") {
    test::Random random(3);
    for (uint32_t level = kMinMicroLevel; level <= kMaxMicroLevel; ++level) {
        CAPTURE(level);
        std::set<uint32_t> seen;
        for (uint32_t i = 0; i < micro_triangles(level); ++i) {
            const MicroTriangle t = micro_triangle_at(level, i);
            CHECK(micro_index(level, t) == i);
            seen.insert(t.row << 16 | t.column << 1 | (t.is_upper ? 1 : 0));
            const MicroCorners corners = corners_of(level, t);
            float a = random.unit(), b = random.unit();
            if (a + b > 1) a = 1 - a, b = 1 - b;
            a = 0.01f + 0.97f * a, b = 0.01f + 0.97f * b;
            const Vec2 at = (1 - a - b) * corners.at[0] + a * corners.at[1] + b * corners.at[2];
            CHECK(at.x + at.y < 1);
            CHECK(micro_index(level, micro_triangle_of(level, at.x, at.y)) == i);
        }
        CHECK(seen.size() == micro_triangles(level));
        for (int i = 0; i < 10'000; ++i) { // no point has an invalid index
            const Vec2 at = some_place(random);
            CHECK(micro_index(level, micro_triangle_of(level, at.x, at.y)) < micro_triangles(level));
        }
    }
}

TEST_CASE("the range over a box of texels contains each of them, and is tight for small boxes") {
    test::Random random(5);
    const int size = 64;
    for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
        for (int i = 0; i < 2000; ++i) {
            const int first = static_cast<int>(600 * random.unit()) - 300;
            const int last = first + static_cast<int>(100 * square(random.unit()));
            std::set<uint32_t> read, listed;
            for (int texel = first; texel <= last; ++texel) {
                const float centre = (static_cast<float>(texel) + 0.5f) / static_cast<float>(size);
                read.insert(nearest_texel(centre, wrap, static_cast<uint32_t>(size)));
            }
            const TexelSpans spans = wrap_texels(first, last, wrap, size);
            REQUIRE(spans.count > 0);
            for (uint32_t k = 0; k < spans.count; ++k) {
                REQUIRE(spans.spans[k].last < static_cast<uint32_t>(size));
                for (uint32_t t = spans.spans[k].first; t <= spans.spans[k].last; ++t) listed.insert(t);
            }
            if (last - first < size - 1) CHECK(read == listed);
            for (const uint32_t texel : read) CHECK(listed.contains(texel));
        }
    }
}

TEST_CASE("micromaps never contradict their textures, whatever these hold and however they are mapped") {
    CutOuts made;
    for (const Wrap wrap : {Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge}) {
        for (const TextureFilter filter : {TextureFilter::Linear, TextureFilter::Nearest}) {
            for (int image = 0; image < 4; ++image) {
                const TextureRef texture = {
                    .image = image, .wrap_s = wrap, .wrap_t = Wrap::MirroredRepeat, .filter = filter};
                TextureRef turned = texture;
                turned.uv_set = 1, turned.channel = 3;
                turned.m00 = 0.8f, turned.m01 = -0.6f, turned.m02 = 3.3f, turned.m10 = 0.6f, turned.m11 = 0.8f;
                const Mesh mesh = made.triangles(24, 3);
                made.add(mesh, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f, .base_color_texture = texture}});
                made.add(mesh, {{.alpha_mode = AlphaMode::Blend, .base_color_texture = texture}});
                made.add(mesh, {{.alpha_mode = AlphaMode::Mask,
                                 .alpha = 0.9f,
                                 .alpha_cutoff = 0.3f,
                                 .base_color_texture = texture,
                                 .alpha_texture = turned}});
                Mesh tinted = mesh;
                for (std::size_t i = 0; i < mesh.positions.size(); ++i)
                    tinted.colors.push_back({1, 1, 1, i % 5 == 0 ? 0.0f : 1.0f});
                made.add(tinted, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 1, .alpha_texture = turned}});
                made.add(tinted, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0, .base_color_texture = texture}});
                Mesh even = mesh; // alpha equals the cutoff where the texture's is 1
                even.colors.assign(mesh.positions.size(), {1, 1, 1, 0.3f});
                made.add(even, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.3f, .base_color_texture = texture}});
                Mesh far = mesh; // coordinates so far from 0 that their steps are large
                for (Vec2& uv : far.uv[0]) uv.x += 3000, uv.y -= 700;
                made.add(far, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f, .base_color_texture = texture}});
            }
        }
    }
    const Micromaps micromaps_of(made.scene);
    uint32_t wrong = 0, known = 0, places = 0;
    for (uint32_t instance = 0; instance < made.scene.instances.size(); ++instance) {
        for (uint32_t i = 0; i < 4000; ++i) {
            const uint32_t primitive = i % 24;
            const Vec2 at = some_place(made.random);
            const bool is_known = micromaps_of.known(instance, primitive, at.x, at.y) != Opacity::Unknown;
            known += is_known;
            ++places;
            wrong += !micromaps_of.is_same(instance, primitive, at.x, at.y, i * 7919);
        }
    }
    CAPTURE(known);
    CAPTURE(places);
    CHECK(wrong == 0);
    CHECK(known > places / 4);
}

TEST_CASE("a texture's values on a micro-triangle lie within its range") {
    test::Random random(11);
    TextureImage fine, wide; // texels that differ by rounding, some of them NaN, and an image of many columns
    fine.rgba_float = {5, 4, 4, std::vector<float>(size_t(4) * 5 * 4)};
    for (float& value : fine.rgba_float.pixels) {
        value = 0.75f + 0x1p-24f * static_cast<float>(random.below(9));
        if (random.below(60) == 0) value = std::nanf("");
    }
    wide.rgba8 = {1u << 16, 1, std::vector<uint8_t>(size_t(4) << 16)};
    for (uint8_t& value : wide.rgba8.pixels) value = static_cast<uint8_t>(random.bits());
    const TextureImageView images[] = {view_of(fine), view_of(wide)};
    const Pyramid pyramids[] = {Pyramid(images[0]), Pyramid(images[1])};
    const uint32_t indices[] = {0, 1, 2};
    constexpr uint32_t kLevel = 5;
    uint64_t outside = 0, bounded = 0;
    for (int round = 0; round < 200'000; ++round) {
        const auto any_of = [&](auto... of) {
            const std::common_type_t<decltype(of)...> all[] = {of...};
            return all[random.below(sizeof...(of))];
        };
        TextureRef ref = {.image = static_cast<int32_t>(random.below(2)),
                          .wrap_s = any_of(Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge),
                          .wrap_t = any_of(Wrap::Repeat, Wrap::MirroredRepeat, Wrap::ClampToEdge),
                          .filter = any_of(TextureFilter::Linear, TextureFilter::Nearest),
                          .channel = 3};
        ref.m00 = any_of(1.0f, -0.7f, 0.01f), ref.m01 = any_of(0.0f, 0.3f);
        ref.m02 = any_of(0.0f, 1e4f, -300.25f, -0x1p-26f), ref.m12 = any_of(0.0f, 17.5f);
        const float size = any_of(4.0f, 0.5f, 0.01f);
        const Vec2 at = {any_of(0.0f, -1.0f, 500 * random.unit()), any_of(0.0f, random.unit())};
        Vec2 uv[3];
        for (Vec2& corner : uv) corner = at + size * (random.pair() - Vec2{0.5f, 0.5f});
        if (random.below(4) == 0) uv[1].y = uv[0].y, uv[2].x = uv[0].x;
        const MeshView mesh = {.uv = {uv, uv}, .indices = indices};
        const Vec2 place = some_place(random);
        const MicroCorners corners = corners_of(kLevel, micro_triangle_of(kLevel, place.x, place.y));
        const ValueRange range = texture_range(mesh, ref, pyramids[ref.image].bounds, {0, 1, 2}, corners);
        const float value =
            lookup_texture_channel(images, ref, interpolate(uv, TriangleIndices{0, 1, 2}, place.x, place.y), nullptr);
        bounded += range.most < kInfinity;
        if (!(range.least <= value && value <= range.most) && range.most < kInfinity) ++outside;
    }
    CHECK(outside == 0);
    CHECK(bounded > 50'000);
}

TEST_CASE("micromaps know the opacity of most points of a leaf, and constant alpha has none") {
    CutOuts made;
    Mesh square;
    square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    square.indices = {0, 1, 2, 0, 2, 3};
    made.add(square, {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f, .base_color_texture = {.image = 0}}});
    made.add(square, {{.alpha_mode = AlphaMode::Blend, .base_color_texture = {.image = 0}}});
    made.add(square, {{.alpha_mode = AlphaMode::Blend, .alpha = 0.5f}});
    made.add(square, {{.base_color_texture = {.image = 0}}});
    const Micromaps micromaps_of(made.scene);
    for (const uint32_t instance : {0u, 1u}) {
        CAPTURE(instance);
        uint32_t opaque = 0, transparent = 0;
        constexpr uint32_t kPlaces = 20'000;
        for (uint32_t i = 0; i < kPlaces; ++i) {
            float u = made.random.unit(), v = made.random.unit();
            if (u + v > 1) u = 1 - u, v = 1 - v;
            const Opacity known = micromaps_of.known(instance, i % 2, u, v);
            opaque += known == Opacity::Opaque;
            transparent += known == Opacity::Transparent;
        }
        CHECK(opaque > 0.36 * kPlaces); // the disc is half of the square
        CHECK(transparent > 0.32 * kPlaces);
    }
    CHECK(micromaps_of.with.micromaps[2].states == nullptr);
    CHECK(micromaps_of.with.micromaps[3].states == nullptr);
}

TEST_CASE("micromaps are remade when textures, materials or meshes change, and kept when objects only move") {
    CutOuts made;
    made.add(made.triangles(8, 1),
             {{.alpha_mode = AlphaMode::Mask, .alpha_cutoff = 0.5f, .base_color_texture = {.image = 0}}});
    made.add(made.triangles(8, 1), {});
    Messages messages;
    const PreparedScene prepared = prepare_scene(made.scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const SceneOnDevice device(queue, prepared);
    const std::size_t before = queue.allocated_bytes();
    OpacityMicromaps maps;
    maps.update(queue, made.scene, device.view(), true);
    CHECK(queue.allocated_bytes() - before == predicted_bytes(prepared, true) - predicted_bytes(prepared, false));
    const uint64_t taken = queue.allocation_count();
    const OpacityMicromapView* const first = maps.of_instances();
    maps.update(queue, made.scene, device.view(), false);
    CHECK(queue.allocation_count() == taken);
    CHECK(maps.of_instances() == first);
    const auto opaque_places = [&] {
        uint32_t count = 0;
        for (uint32_t i = 0; i < 4000; ++i) {
            const Vec2 at = some_place(made.random);
            count += opacity_at(maps.of_instances()[0], i % 8, at.x, at.y) == Opacity::Opaque;
        }
        return count;
    };
    CHECK(opaque_places() > 400);
    Scene clear = made.scene; // the image has the same size, but all its texels are transparent
    for (TextureImage& image : clear.images) std::ranges::fill(image.rgba8.pixels, uint8_t(0));
    {
        const PreparedScene prepared_clear = prepare_scene(clear, {}, messages);
        const SceneOnDevice clear_device(queue, prepared_clear);
        maps.update(queue, clear, clear_device.view(), true);
    }
    CHECK(opaque_places() == 0);
    Scene other = made.scene; // now another instance has the cut-out
    std::swap(other.instances[0].material, other.instances[1].material);
    maps.update(queue, other, device.view(), false);
    REQUIRE(maps.of_instances() != nullptr);
    CHECK(maps.of_instances()[0].states == nullptr);
    CHECK(maps.of_instances()[1].states != nullptr);
    for (Material& material : other.materials) material.alpha_mode = AlphaMode::Opaque;
    maps.update(queue, other, device.view(), true);
    CHECK(maps.of_instances() == nullptr);
    CHECK(queue.allocated_bytes() == before);
}
