#pragma once

// The record: five sets of rays (docs/ray_sets.md) that other tracers were timed on. Here are the three scenes that
// they are traced in, with their cameras, and what tells whether rays are the same. How fast others were is in
// lab/stored_figures.h.

#include <filesystem>
#include <span>
#include <string_view>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// What other tracers' record says of one set of rays, 8,294,400 of them: the share that hit, nodes and triangles a ray
/// in a binary tree. A tracer that makes the same rays in the same scene has the same hit share.
struct RecordedSet {
    const char* name;
    double hit_share;
    double nodes, triangles;
};

struct RecordScene {
    const char* name;
    const char* file;   // under the folder of public scenes; null: generated
    uint32_t triangles; // that have an area
    Vec3 eye, target;
    float fov_y_deg;
    RecordedSet sets[5]; // in the order in which they are made
};

inline constexpr uint32_t kRecordRays = 8294400; // four frames of 1920 x 1080

/// sponza, bunny, forest.
std::span<const RecordScene> record_scenes();
/// Null where none has this name.
const RecordScene* find_record_scene(std::string_view name);

Camera record_camera(const RecordScene& scene);

/// The file of a scene that has one, under the folder of public scenes (docs/scenes.md). Throws Error(BadInput) where
/// it is not there.
std::filesystem::path record_file(const RecordScene& scene, const std::filesystem::path& folder);

/// Geometry in one mesh, grey, with the camera. The forest needs no folder. Throws as record_file.
Scene make_record_scene(const RecordScene& scene, const std::filesystem::path& folder, Messages& messages);

} // namespace pertev
