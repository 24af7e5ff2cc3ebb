#pragma once

// Rows of form factors of small scenes, and rooms with radiosity in closed form.

#include <vector>

#include "base/parallel_for.h"
#include "radiosity/row_maker.h"
#include "radiosity/solve_radiosity.h"
#include "tests/support/flat_scenes.h"

namespace pertev::test {

/// The axis-parallel box from -`half` to `half` of six sheets of `material` that face inwards.
inline Scene closed_box(const Material& material, float half = 1) {
    Scene scene;
    const Vec3 x = {half, 0, 0}, y = {0, half, 0}, z = {0, 0, half};
    for (const float side : {-1.0f, 1.0f}) {
        const float s = -side; // inwards
        add(scene, sheet(side * x, s * y, z), material);
        add(scene, sheet(side * y, s * z, x), material);
        add(scene, sheet(side * z, s * x, y), material);
    }
    return scene;
}

inline Material emitter_material(float reflectance, float radiance) {
    return {{.base_color = grey(reflectance), .emission = grey(radiance)}, "lamp"};
}

/// A scene and its patches.
struct PatchedScene {
    PatchedScene(Scene made, float patch_size, Messages messages = {})
        : scene(std::move(made)), prepared(prepare_scene(scene, {}, messages)), solved(prepared),
          tree(make_patches(solved.view(), patch_size)) {}

    std::vector<FormFactorRow> rows(const RadiositySettings& settings) const {
        const RowMakers makers(solved, tree, settings);
        std::vector<FormFactorRow> all(tree.patches.size());
        parallel_for_ranges(all.size(), 1, [&](uint64_t begin, uint64_t end) {
            const auto maker = makers.for_thread();
            for (uint64_t i = begin; i < end; ++i) maker->make(tree.patches[i], static_cast<uint32_t>(i), all[i]);
        });
        return all;
    }
    /// Returns the form factor from side `side` of instance `from` to instance `to`.
    double factor(const std::vector<FormFactorRow>& rows, uint32_t from, uint32_t side, uint32_t to) const {
        double sum = 0, area = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Patch& patch = tree.patches[i];
            if (patch.instance != from || patch.side() != side) continue;
            area += static_cast<double>(patch.area);
            for (const FormFactor& factor : rows[i].factors) {
                if (tree.patches[factor.patch].instance != to) continue;
                sum += static_cast<double>(patch.area) * static_cast<double>(factor.factor);
            }
        }
        return sum / area;
    }

    Scene scene;
    PreparedScene prepared;
    SolvedScene solved;
    PatchTree tree;
};

} // namespace pertev::test
