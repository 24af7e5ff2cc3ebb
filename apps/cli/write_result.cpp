#include "apps/cli/write_result.h"

#include <sys/resource.h>

#include <algorithm>
#include <string_view>
#include <type_traits>
#include <variant>

#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "base/byte_units.h"
#include "base/error.h"
#include "base/message_text.h"
#include "base/version.h"
#include "image/picture_hash.h"
#include "image/tone_map_image.h"
#include "image/write_image.h"

namespace pertev {
namespace {

uint64_t peak_memory_bytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

std::string comma_separated(Vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// The flags that place this camera again: to the bit where flags have placed it or none are given, else as near as
/// their numbers go. And its matrix, column by column.
void add_camera(const SceneOptions& options, const Camera& camera, ExrMetadata& metadata) {
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = from.translation;
    const Vec3 target = options.target.empty() ? eye - camera.focus_distance * column(from, 2)
                                               : parse_position("--target", options.target);
    Vec3 up = options.up.empty() ? column(from, 1) : parse_vec3("--up", options.up);
    for (const Vec3 unsaid : {Vec3{0, 0, -1}, Vec3{0, 1, 0}}) {
        if (options.up.empty() && look_at(eye, target, unsaid) == from) up = unsaid;
    }
    const std::string matrix =
        fmt::format("{} {} {} {}", comma_separated(column(from, 0)), comma_separated(column(from, 1)),
                    comma_separated(column(from, 2)), comma_separated(eye));
    metadata.insert(metadata.end(), {{"pertev.camera", options.camera},
                                     {"pertev.world_from_camera", matrix},
                                     {"pertev.eye", comma_separated(eye)},
                                     {"pertev.target", comma_separated(target)},
                                     {"pertev.up", comma_separated(up)},
                                     {"pertev.aperture", camera.aperture_radius}});
    if (camera.aperture_radius > 0) metadata.emplace_back("pertev.focus", camera.focus_distance);
    if (camera.projection == Projection::Orthographic) {
        metadata.insert(metadata.end(),
                        {{"pertev.projection", "orthographic"}, {"pertev.view_height", camera.ortho_height}});
    } else {
        const float fov_deg = options.fov_deg > 0 ? options.fov_deg : camera.fov_y * (180 / kPi);
        metadata.insert(metadata.end(), {{"pertev.projection", "perspective"}, {"pertev.fov", fov_deg}});
    }
}

void add_environment(const SceneOptions& options, bool is_there, ExrMetadata& metadata) {
    const std::string made_up = is_there ? "made up" : "none";
    metadata.insert(metadata.end(),
                    {{"pertev.environment", options.environment.empty() ? made_up : options.environment},
                     {"pertev.environment_scale", options.environment_scale},
                     {"pertev.environment_rotation", options.environment_rotation_deg}});
}

/// How the PNG or JPEG beside this EXR shows the picture.
void add_display(const Display& display, ExrMetadata& metadata) {
    if (!display.is_used) return;
    metadata.insert(metadata.end(), {{"pertev.tone_map", std::string(name_of(display.tone_map))},
                                     {"pertev.exposure", display.exposure_stops}});
}

/// How the picture was made, all that is needed to make it again among it.
ExrMetadata metadata_of(const RenderFlags& flags, const RenderResult& result, const RenderRecord& record,
                        const std::string& hash) {
    ExrMetadata metadata = {{"pertev.version", fmt::format("{} {}", version(), git_commit())},
                            {"pertev.scene", flags.scene.scene},
                            {"pertev.spp", static_cast<int32_t>(result.samples)},
                            {"pertev.max_depth", static_cast<int32_t>(flags.max_depth)},
                            {"pertev.integrator", flags.integrator},
                            {"pertev.sampler", flags.sampler},
                            {"pertev.filter", flags.filter},
                            {"pertev.filter_radius", record.filter_radius},
                            {"pertev.seed", fmt::format("{}", flags.seed)},
                            {"pertev.clamp", flags.clamp},
                            {"pertev.two_sided_lights", static_cast<int32_t>(flags.scene.two_sided_lights)},
                            {"pertev.show_back_faces", static_cast<int32_t>(flags.scene.show_back_faces)},
                            {"pertev.device", record.device},
                            {"pertev.hash", hash},
                            {"pertev.invalid_samples", static_cast<double>(result.invalid_samples)},
                            {"pertev.load_seconds", record.load_seconds},
                            {"pertev.build_seconds", record.build_seconds},
                            {"pertev.render_seconds", result.render_seconds},
                            {"pertev.rays", static_cast<double>(result.rays.total())}};
    add_camera(flags.scene, record.camera, metadata);
    add_environment(flags.scene, record.has_environment, metadata);
    add_display(record.display, metadata);
    return metadata;
}

std::vector<ExrLayer> layers_of(RenderResult& result) {
    std::vector<ExrLayer> layers;
    for (FilmLayer& layer : result.layers) {
        layers.push_back({layer.name, layer.channels, std::move(layer.image.pixels)});
    }
    if (!result.ids.empty()) {
        std::vector<uint32_t> ids;
        for (const PixelIds& id : result.ids) ids.insert(ids.end(), {id.instance, id.primitive, id.material});
        layers.push_back({aov_group(kAovIds).layer, channel_names(aov_group(kAovIds)), std::move(ids)});
    }
    return layers;
}

/// Of a value of an EXR's metadata.
template <class Value>
std::string json_of(const Value& value) {
    if constexpr (std::is_same_v<Value, std::string>) {
        return json_string(value);
    } else {
        return json_number(static_cast<double>(value));
    }
}

} // namespace

void report_camera(const SceneOptions& options, const Camera& camera, Reporter& reporter) {
    ExrMetadata flags;
    add_camera(options, camera, flags);
    std::string object = R"({"event":"camera")";
    for (const auto& [name, value] : flags) {
        object += fmt::format(",{}:{}", json_string(name.substr(std::string_view("pertev.").size())),
                              std::visit([](const auto& v) { return json_of(v); }, value));
    }
    reporter.event(object + '}');
}

WrittenResult write_result(const RenderFlags& flags, const RenderRecord& record, RenderResult& result,
                           Reporter& reporter) {
    WrittenResult written = {picture_hash(result.picture).hex(), {}};
    WriteImageOptions write;
    write.tone_map = record.display.tone_map;
    write.exposure_stops = record.display.exposure_stops;
    write.transparent = flags.transparent;
    const std::vector<ExrLayer> layers = layers_of(result);
    write.layers = layers;
    write.metadata = metadata_of(flags, result, record, written.hash);
    for (const std::string& output : flags.outputs) {
        try {
            write_image(output, result.picture, write);
            reporter.output(output);
        } catch (const Error& error) {
            written.failures.emplace_back(error.what());
            reporter.output(output, error.what());
        }
    }
    return written;
}

void report_result(const RenderRecord& record, const RenderResult& result, const std::string& hash,
                   double total_seconds, Reporter& reporter) {
    const double samples = static_cast<double>(result.picture.width) * result.picture.height * result.samples;
    const double samples_per_second = samples / result.render_seconds;
    const double rays_per_second = static_cast<double>(result.rays.total()) / result.render_seconds;
    const uint64_t host_bytes = peak_memory_bytes();
    reporter.say(fmt::format(
        "{} spp in {:.2f} s ({:.2f} s in all), {:.2f} Msamples/s, {:.1f} Mrays/s, peak {:.0f} MiB{}, "
        "{}, picture {}",
        result.samples, result.render_seconds, total_seconds, samples_per_second * 1e-6, rays_per_second * 1e-6,
        mebibytes(host_bytes),
        record.is_cuda ? fmt::format(" and {:.0f} MiB on the GPU", mebibytes(result.device_peak_bytes)) : "",
        counted(result.invalid_samples, "invalid sample"), hash));
    reporter.event(fmt::format(
        R"({{"event":"done","samples":{},"seconds":{:.6f},"total_seconds":{:.6f},"samples_per_second":{},"rays_per_second":{},"peak_bytes":{},"device_peak_bytes":{},"invalid_samples":{},"hash":"{}","device":{},"interrupted":{}}})",
        result.samples, result.render_seconds, total_seconds, json_number(samples_per_second),
        json_number(rays_per_second), host_bytes, result.device_peak_bytes, result.invalid_samples, hash,
        json_string(record.device), record.interrupted));
}

} // namespace pertev
