#pragma once

// Heights of pbrt as normal maps. pbrt's heights are metres, and its texture coordinates follow the mesh; a normal map
// here has one strength, that of the mesh's mean size of the texture.

#include "formats/pbrt/textures.h"
#include "math/double_transform.h"
#include "scene/scene.h"

namespace pertev::pbrt {

/// Returns the area of a mesh after a transform.
double world_area(const Mesh& mesh, const DoubleTransform& world_from_mesh);

/// Replaces the image of material.normal_texture, which has the heights, by their normals, and sets the strength that
/// they have on `mesh`. The image of `heights` is decoded there.
void set_bumps(const TextureValue& heights, const Mesh& mesh, const DoubleTransform& world_from_mesh,
               Material& material, Scene& scene);

} // namespace pertev::pbrt
