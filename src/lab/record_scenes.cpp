#include "lab/record_scenes.h"

#include <fmt/format.h>

#include "base/error.h"
#include "formats/read_scene.h"
#include "session/opening/open_scene.h"

namespace pertev {
namespace {

/// Returns only the file's triangles, in one mesh in the file's order, without normals.
Mesh read_one_mesh(const std::filesystem::path& path, Sink& sink) {
    const Scene scene = read_scene(path, {.geometry_only = true}, sink);
    Mesh mesh;
    for (const Instance& instance : scene.instances) {
        const Mesh& part = scene.meshes[instance.mesh];
        const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
        for (const Vec3 p : part.positions) mesh.positions.push_back(transform_point(instance.world_from_local, p));
        for (const uint32_t index : part.indices) mesh.indices.push_back(first + index);
    }
    return mesh;
}

Scene make_grey_scene(const std::string& file, float reflectance, Sink& sink) {
    Scene scene = read_scene(file, {.geometry_only = true}, sink);
    scene.materials.assign(1, Material{{.base_color = {reflectance, reflectance, reflectance}}, "grey"});
    for (Instance& instance : scene.instances) instance.material = 0;
    for (Mesh& mesh : scene.meshes) {
        mesh.normals.clear();
        mesh.tangents.clear();
        mesh.colors.clear();
    }
    scene.images.clear();
    scene.lights.clear();
    scene.environment = Environment{};
    return scene;
}

Camera camera_of(const RecordView& view, const std::string& name) {
    Camera camera;
    camera.name = name;
    camera.world_from_camera = look_at(view.eye, view.target, {0, 1, 0});
    camera.fov_y = view.fov_y_deg * kPi / 180;
    return camera;
}

} // namespace

std::filesystem::path record_file(const RecordScene& scene, const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / scene.file;
    if (folder.empty() || !std::filesystem::exists(path)) {
        throw Error(ErrorCode::BadInput, FileLocation{path.string()},
                    fmt::format("the scene {} needs this file in the folder PERTEV_SCENES (see docs/ray_sets.md){}",
                                scene.name, folder.empty() ? "; it is not set" : ""));
    }
    return path;
}

Camera record_camera(const RecordScene& scene) { return camera_of(scene.view, scene.name); }

Scene make_record_scene(const RecordScene& record, const std::filesystem::path& folder, Sink& sink) {
    Scene scene;
    scene.meshes.push_back(read_one_mesh(record_file(record, folder), sink));
    scene.materials.push_back({{}, "grey"});
    scene.instances.push_back({.name = record.name});
    scene.cameras.push_back(record_camera(record));
    return scene;
}

RenderSettings job_settings(const RecordJob& job) {
    RenderSettings settings;
    settings.width = job.width, settings.height = job.height, settings.samples = job.samples;
    settings.path.max_depth = job.max_depth;
    settings.filter = job.filter;
    if (job.filter == PixelFilter::Tent) settings.filter_radius = 1;
    if (job.roulette_depth) {
        settings.path.roulette = Roulette::Throughput;
        settings.path.roulette_depth = *job.roulette_depth;
    }
    return settings;
}

Scene make_job_scene(const RecordJob& job, const std::string& file, Sink& sink) {
    if (job.reflectance) return make_grey_scene(file, *job.reflectance, sink);
    return open_scene(file, sink, SceneUse::Benchmark);
}

Camera job_camera(const RecordJob& job, const Scene& scene, float aspect, Sink& sink) {
    if (job.view) return camera_of(*job.view, job.name);
    return choose_camera(CameraChoice{}, scene, aspect, sink);
}

CameraChoice camera_choice(const TransportPreset& preset) {
    CameraChoice choice;
    if (!preset.view) return choice;
    choice.eye = to_double(preset.view->eye), choice.target = to_double(preset.view->target);
    choice.fov_deg = preset.view->fov_y_deg;
    return choice;
}

} // namespace pertev
