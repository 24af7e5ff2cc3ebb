#pragma once

// Heights of pbrt and Mitsuba as normal maps. Their heights are metres, and their texture coordinates follow the mesh;
// a normal map here has one strength, that of the mesh's mean size of the texture. The steps of a checkerboard are
// slopes of a sixteenth of a check.

#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "formats/described/image_budget.h"
#include "formats/described/surface.h"
#include "math/double_transform.h"
#include "scene/scene.h"

namespace pertev::described {

/// Returns the area of a mesh after a transform.
double world_area(const Mesh& mesh, const DoubleTransform& world_from_mesh);

/// Normals of height maps, each made once.
class Bumps {
public:
    /// `made` are images that are not from files. The arguments must outlive this object.
    Bumps(ImageBudget& budget, const std::vector<TextureImage>& made, Scene& scene)
        : budget_(budget), made_(made), scene_(scene) {}

    /// Replaces the image of material.normal_texture, which has the heights, by their normals, and sets the strength
    /// that they have on `mesh`. The image of `heights` is decoded here, or is one of `made`.
    void set(const TextureValue& heights, const Mesh& mesh, const DoubleTransform& world_from_mesh, Material& material);

private:
    /// `ref` has the decoded image of `heights`, if that has one.
    int32_t normals_of(const TextureRef& ref, const TextureValue& heights);

    ImageBudget& budget_;
    const std::vector<TextureImage>& made_;
    Scene& scene_;
    std::map<std::tuple<int32_t, int32_t, bool, ImageChange, Wrap>, int32_t> numbers_; // by image, encoding and wrap
};

} // namespace pertev::described
