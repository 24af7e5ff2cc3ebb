#include "lab/record.h"

#include "lab/job_table.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

using gltf::JsonValue;

Vec3 vector_of(const JsonValue& value) {
    const std::array<float, 3> v = value.to_floats<3>();
    return {v[0], v[1], v[2]};
}

RecordView view_of(const JsonValue& value) {
    return {vector_of(value.at("eye")), vector_of(value.at("target")), value.at("fov_y_deg").to_float()};
}

uint32_t count_of(const JsonValue& value, std::string_view key) {
    return static_cast<uint32_t>(value.at(key).to_unsigned());
}
double number_of(const JsonValue& value, std::string_view key) { return value.at(key).to_double(); }

RecordScene scene_of(const JsonValue& value, const JsonValue& figures) {
    const std::string name(value.string_or("name", ""));
    const JsonValue reached = figures.at("scenes").at(name), rays = reached.at("rays");
    RecordScene scene = {.name = name,
                         .file = value.string_or("file", ""),
                         .triangles = count_of(value, "triangles"),
                         .view = view_of(value),
                         .optix_fast_trace_s = number_of(reached, "optix_fast_trace_s"),
                         .optix_fast_build_s = number_of(reached, "optix_fast_build_s")};
    for (const JsonValue& set : value.elements_of("sets")) {
        const std::string kind(set.string_or("name", ""));
        scene.sets.push_back({kind, number_of(set, "hit_share"), number_of(set, "nodes"), number_of(set, "triangles"),
                              number_of(rays.at(kind), "best_rays_per_second")});
    }
    return scene;
}

RecordJob job_of(const JsonValue& value, const std::vector<RecordScene>& scenes, const JsonValue& figures) {
    RecordJob job = {.name = value.string_or("name", ""),
                     .filter = value_named<PixelFilter>(value.at("filter").to_string()).value(),
                     .width = count_of(value, "width"),
                     .height = count_of(value, "height"),
                     .samples = count_of(value, "samples"),
                     .max_depth = count_of(value, "max_depth"),
                     .triangles = value.at("triangles").to_unsigned(),
                     .mean = number_of(value, "mean")};
    if (const auto reached = figures.at("jobs").find(job.name)) {
        job.mitsuba = number_of(*reached, "mitsuba");
        job.cycles = number_of(*reached, "cycles");
        job.pbrt = number_of(*reached, "pbrt");
    }
    if (value.find("reflectance")) job.reflectance = value.at("reflectance").to_float();
    if (value.find("eye")) job.view = view_of(value);
    if (value.find("scene")) job.view = find_named(scenes, value.at("scene").to_string())->view;
    if (value.find("roulette_depth")) job.roulette_depth = count_of(value, "roulette_depth");
    return job;
}

TransportPreset preset_of(const JsonValue& value) {
    TransportPreset preset = {value.string_or("name", ""),
                              value.string_or("scene", ""),
                              value.string_or("shows", ""),
                              value.string_or("reference_integrator", ""),
                              {}};
    if (value.find("eye")) preset.view = view_of(value);
    return preset;
}

Record read_record() {
    const JobTable table, others("figures.json");
    const JsonValue &root = table.root(), &figures = others.root();
    Record read = {.device = figures.string_or("device", "")};
    for (const JsonValue& value : root.elements_of("scenes")) read.scenes.push_back(scene_of(value, figures));
    for (const JsonValue& value : root.elements_of("jobs")) read.jobs.push_back(job_of(value, read.scenes, figures));
    for (const JsonValue& value : root.elements_of("presets")) read.presets.push_back(preset_of(value));
    return read;
}

} // namespace

const Record& the_record() {
    static const Record read = read_record();
    return read;
}

} // namespace pertev
