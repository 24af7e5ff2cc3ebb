#pragma once

// Scenes for tests that have every kind of surface and light, and a function that renders one.

#include <cstdint>

#include "base/hash.h"
#include "scene/scene.h"
#include "session/session.h"

namespace pertev::test {

inline constexpr LightStrategy kLightStrategies[] = {LightStrategy::Mis, LightStrategy::NeeOnly,
                                                     LightStrategy::BsdfOnly};

/// A room open to a panorama: diffuse, metal, glass and glTF spheres (two of them instances of one mesh), a textured
/// floor, a cut-out and a blended sheet, one that hides its back from the camera, an emissive quad that faces down, a
/// point, a spot and a directional light.
Scene make_mixed_scene();
/// A camera that shows the whole scene.
Camera mixed_scene_camera();

/// A sphere of `albedo` with smooth normals, about the origin, radius 1, under an environment of radiance 1.
Scene make_furnace_scene(float albedo);

Queue make_cuda_queue(); // for tests under cuda_requested()
/// Makes the queue of the GPU with --device cuda, otherwise of the CPU.
Queue requested_queue();

/// Builds the trees of a scene and renders it.
RenderResult render(Queue& queue, const Scene& scene, const Camera& camera, const RenderSettings& settings,
                    const PrepareOptions& prepare = {});

/// Returns the mean of all numbers of a picture.
double mean_of(const Image& picture);

/// Settings of a square picture, whose paths roulette does not end.
RenderSettings square_settings(uint32_t size, uint32_t samples, uint32_t max_depth);

/// Settings of a small picture with layers, for comparing scenes before and after a change.
RenderSettings layered_settings();

/// Hashes everything that a render shows: its picture, its layers and its ids.
void add_picture(Hasher& hasher, const RenderResult& result);
Hash128 render_hash(const RenderResult& result);

} // namespace pertev::test
