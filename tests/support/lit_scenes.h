#pragma once

// Scenes of emissive squares for the tests of light sampling, and a light set with the data of its view.

#include <array>
#include <cstdint>
#include <vector>

#include "shading/build_light_set.h"
#include "tests/support/random.h"

namespace pertev::test {

inline double as_double(float x) { return static_cast<double>(x); }

/// Returns the linear values of encoded bytes. They are linear, so textures of the tests have the same values with and
/// without is_srgb.
inline std::array<float, 256> make_linear_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < 256; ++i) table[i] = static_cast<float>(i) * (1.0f / 255.0f);
    return table;
}
inline const std::array<float, 256> kTable = make_linear_table();

/// A scene's light set and the data of its view.
struct Lights {
    LightSetData data;
    std::vector<TextureImageView> images;
    LightSetView view;

    explicit Lights(const Scene& scene) : images(views_of_images(scene)) {
        Messages messages;
        data = build_light_set(scene, kTable.data(), messages);
        data.tree->get();
        view = view_of(data, images.data(), kTable.data());
    }
};

/// A square of side 2 in the plane y = 0 about the origin that faces -y, with 2 n^2 triangles and (u, v) from (0, 0) to
/// (1, 1).
inline Mesh make_square(uint32_t n) {
    Mesh mesh;
    for (uint32_t i = 0; i <= n; ++i) {
        for (uint32_t j = 0; j <= n; ++j) {
            const Vec2 uv = {static_cast<float>(i) / static_cast<float>(n),
                             static_cast<float>(j) / static_cast<float>(n)};
            mesh.positions.push_back({2 * uv.x - 1, 0, 2 * uv.y - 1});
            mesh.uv[0].push_back(uv);
            if (i == n || j == n) continue;
            const uint32_t a = i * (n + 1) + j, b = a + n + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, a + 1, b, b + 1, a + 1});
        }
    }
    return mesh;
}

inline uint32_t add_emitter(Scene& scene, const Mesh& mesh, Rgb emission, const Transform& world_from_local) {
    Material material;
    material.emission = emission;
    scene.meshes.push_back(mesh);
    scene.materials.push_back(material);
    Instance instance;
    instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
    instance.material = static_cast<uint32_t>(scene.materials.size() - 1);
    instance.world_from_local = world_from_local;
    scene.instances.push_back(instance);
    return static_cast<uint32_t>(scene.instances.size() - 1);
}

inline SampleBits random_bits(Random& random) {
    const uint32_t x = random.bits();
    return {x, random.bits()};
}

} // namespace pertev::test
