#include "lab/record_scenes.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/read_scene.h"
#include "lab/make_bunny_box.h"
#include "lab/make_forest.h"

namespace pertev {
namespace {

const std::array kScenes = {
    RecordScene{"sponza",
                "crytek-sponza/sponza.obj",
                262204,
                {-110, 18, -2},
                {60, 32, -4},
                60,
                {{"primary", .991, 44.5, 3.6},
                 {"shadow", .869, 30.9, 3.1},
                 {"diffuse1", .977, 43.1, 6.2},
                 {"diffuse2", .970, 39.7, 5.5},
                 {"diffuse3", .973, 38.8, 5.6}}},
    RecordScene{"bunny",
                "stanford/bunny.obj",
                1119408,
                {0.3f, 1.5f, 3.6f},
                {0, 0.95f, 0},
                32,
                {{"primary", 1.00, 24.6, 2.5},
                 {"shadow", .350, 22.3, 1.6},
                 {"diffuse1", .611, 25.4, 2.6},
                 {"diffuse2", .635, 20.1, 1.8},
                 {"diffuse3", .645, 19.7, 1.8}}},
    RecordScene{"forest",
                nullptr,
                8223200,
                {0, 17.80f, 75},
                {0, 7.25f, 0},
                55,
                {{"primary", .803, 65.8, 4.5},
                 {"shadow", .968, 42.4, 3.5},
                 {"diffuse1", .739, 63.2, 6.4},
                 {"diffuse2", .787, 63.2, 6.7},
                 {"diffuse3", .808, 63.3, 6.9}}},
};

/// The file's triangles alone, all in one mesh in the file's order, without normals.
Mesh read_one_mesh(const std::filesystem::path& path, Messages& messages) {
    ReadOptions options;
    options.geometry_only = true;
    const Scene scene = read_scene(path, options, messages);
    Mesh mesh;
    for (const Instance& instance : scene.instances) {
        const Mesh& part = scene.meshes[instance.mesh];
        const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
        for (const Vec3 p : part.positions) mesh.positions.push_back(transform_point(instance.world_from_local, p));
        for (const uint32_t index : part.indices) mesh.indices.push_back(first + index);
    }
    return mesh;
}

} // namespace

std::span<const RecordScene> record_scenes() { return kScenes; }

const RecordScene* find_record_scene(std::string_view name) {
    const auto found = std::ranges::find(kScenes, name, &RecordScene::name);
    return found == kScenes.end() ? nullptr : &*found;
}

std::filesystem::path record_file(const RecordScene& scene, const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / scene.file;
    if (folder.empty() || !std::filesystem::exists(path)) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("the scene {} needs {} under the folder that PERTEV_SCENES names (docs/scenes.md){}",
                                scene.name, scene.file, folder.empty() ? "; it is not set" : ""));
    }
    return path;
}

Camera record_camera(const RecordScene& scene) {
    Camera camera;
    camera.name = scene.name;
    camera.world_from_camera = look_at(scene.eye, scene.target, {0, 1, 0});
    camera.fov_y = scene.fov_y_deg * kPi / 180;
    return camera;
}

Scene make_record_scene(const RecordScene& record, const std::filesystem::path& folder, Messages& messages) {
    Scene scene;
    if (record.file == nullptr) {
        scene.meshes.push_back(make_forest());
    } else {
        scene.meshes.push_back(read_one_mesh(record_file(record, folder), messages));
        if (std::string_view(record.name) == "bunny") scene.meshes[0] = make_bunny_box(scene.meshes[0]);
    }
    scene.materials.push_back({{}, "grey"});
    scene.instances.push_back({.name = record.name});
    scene.cameras.push_back(record_camera(record));
    return scene;
}

} // namespace pertev
