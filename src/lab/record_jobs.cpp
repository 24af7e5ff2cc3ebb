#include "lab/record_jobs.h"

#include <algorithm>
#include <array>

#include "formats/read_scene.h"
#include "lab/record_scenes.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"

namespace pertev {
namespace {

constexpr std::array kJobs = {
    RecordJob{"S5", true, 1920, 1080, 256, 5, 262204, 0.05784},
    RecordJob{"S8", true, 1920, 1080, 256, 8, 262204, 0.06252},
    RecordJob{"cornell-box-65", false, 1024, 1024, 512, 64, 36, 0.1200},
    RecordJob{"cornell-box-8", false, 1024, 1024, 512, 7, 36, 0.1194},
};

Scene make_grey_scene(const std::string& file, Messages& messages) {
    ReadOptions options;
    options.geometry_only = true;
    Scene scene = read_scene(file, options, messages);
    scene.materials.assign(1, Material{{.base_color = {0.7f, 0.7f, 0.7f}}, "grey"});
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

} // namespace

std::span<const RecordJob> record_jobs() { return kJobs; }

const RecordJob* find_record_job(std::string_view name) {
    const auto found = std::ranges::find(kJobs, name, &RecordJob::name);
    return found == kJobs.end() ? nullptr : &*found;
}

RenderSettings job_settings(const RecordJob& job) {
    RenderSettings settings;
    settings.width = job.width, settings.height = job.height, settings.samples = job.samples;
    settings.path.max_depth = job.max_depth;
    if (job.is_grey) {
        settings.filter = PixelFilter::Box;
        settings.path.roulette = Roulette::Throughput;
        settings.path.roulette_depth = 2;
    } else {
        settings.filter = PixelFilter::Tent;
        settings.filter_radius = 1;
    }
    return settings;
}

Scene make_job_scene(const RecordJob& job, const std::string& file, Messages& messages) {
    if (job.is_grey) return make_grey_scene(file, messages);
    OpenOptions options;
    options.scene = file;
    options.use = SceneUse::Benchmark;
    return open_scene(options, messages);
}

Camera job_camera(const RecordJob& job, const Scene& scene, float aspect, Messages& messages) {
    if (job.is_grey) return record_camera(*find_record_scene("sponza"));
    return choose_camera(CameraChoice{}, scene, aspect, messages);
}

} // namespace pertev
