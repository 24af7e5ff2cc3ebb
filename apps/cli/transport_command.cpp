#include "apps/cli/transport_command.h"

#include <algorithm>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/lab_files.h"
#include "base/error.h"
#include "base/read_file.h"
#include "image/image_format.h"
#include "image/read_image.h"
#include "image/write_exr.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "lab/describe_camera.h"
#include "lab/record_scenes.h"
#include "lab/run_transport.h"
#include "lab/transport_light.h"
#include "lab/transport_tables.h"
#include "session/opening/calibrated_camera.h"
#include "session/survey/default_light.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

constexpr uint32_t kReferenceSamples = 1024, kReferenceSamplesCuda = 16384;
constexpr const char* kAllPresets = "all";

/// A scene that is read, as it is to be measured.
struct Subject {
    std::string name, shows, reference_integrator;
    Scene scene;
    Camera camera;
};

Subject read_subject(SceneOptions options, const TransportPreset* preset, float aspect, Sink& sink) {
    Subject subject;
    if (preset != nullptr) options.scene = preset->scene;
    subject.scene = read_lab_scene(options, sink);
    add_default_light(subject.scene, SceneUse::Benchmark, sink);
    subject.name = preset != nullptr ? preset->name : lab_scene_title(options.scene);
    subject.shows = preset != nullptr ? preset->shows : "";
    subject.reference_integrator =
        preset != nullptr ? preset->reference_integrator : default_reference_integrator(subject.scene);
    subject.camera = preset != nullptr ? choose_camera(camera_choice(*preset), subject.scene, aspect, sink)
                                       : choose_camera(options.camera, subject.scene, aspect, sink);
    return subject;
}

/// Null means the scene of the command line.
std::vector<const TransportPreset*> presets_of(const SceneOptions& scene, const TransportFlags& flags) {
    if (flags.preset.empty() && !scene.scene.empty()) return {nullptr};
    refuse(!scene.scene.empty(), {"preset", flags.preset, "a preset has its own scene; leave out SCENE or --preset"});
    std::vector<const TransportPreset*> presets;
    for (const TransportPreset& preset : the_record().presets) {
        const std::string wanted = flags.preset.empty() ? "cornell" : flags.preset;
        if (wanted == kAllPresets || wanted == preset.name) presets.push_back(&preset);
    }
    const CameraChoice& camera = scene.camera;
    refuse(!camera.camera.empty() || camera.eye || camera.target || camera.up || camera.fov_deg || camera.projection ||
               camera.view_height,
           {"preset", flags.preset, "a preset has its own camera; name a SCENE to use another"});
    refuse(presets.size() > 1 && !flags.reference.empty(),
           {"reference", flags.reference, "a reference belongs to one scene; name one preset"});
    return presets;
}

/// Replaces names of settings in the laboratory's texts by flags.
void phrase_all(TransportScene& measured) {
    for (std::string& note : measured.notes) note = phrase(note);
    for (TransportRow& row : measured.rows) row.refused = phrase(row.refused);
}

/// Errors are measured on radiance, which display formats do not hold.
Image read_linear_image(const std::string& file, Sink& sink) {
    const std::vector<std::byte> bytes = read_file(file);
    const std::optional<ImageFormat> format = recognise_image(bytes);
    refuse(format == ImageFormat::Png || format == ImageFormat::Jpeg,
           {"reference", file,
            "the picture is tone-mapped; errors are measured in radiance, which an EXR or HDR file has (pertev "
            "render -o reference.exr)"});
    return read_image(bytes, file, sink);
}

TransportSettings settings_of(const PictureOptions& options, const TransportFlags& flags, bool is_cuda, Sink& sink) {
    TransportSettings settings;
    for (const std::string& name : flags.integrators) {
        if (std::ranges::find(settings.integrators, name) == settings.integrators.end()) {
            settings.integrators.push_back(name);
        }
    }
    if (settings.integrators.empty()) settings.integrators = names_of<IntegratorKind>();
    settings.repetitions = flags.repetitions, settings.seconds = flags.seconds;
    settings.max_samples = flags.max_samples;
    settings.picture = options.render;
    const PictureSize size = options.size.value_or(PictureSize{256, 256});
    settings.picture.width = size.width, settings.picture.height = size.height;
    settings.picture.photon_map.edit().search =
        value_named<PhotonSearch>(flags.photon_search).value_or(PhotonSearch::Grid);
    settings.reference_samples = flags.reference_samples > 0 ? flags.reference_samples
                                 : is_cuda                   ? kReferenceSamplesCuda
                                                             : kReferenceSamples;
    if (!flags.reference.empty()) {
        settings.reference = read_linear_image(flags.reference, sink);
        settings.reference_file = flags.reference;
    }
    return settings;
}

/// The EXR files of a scene's pictures, and their names in it. A name of a scene may be any text.
void write_pictures(const std::filesystem::path& folder, std::size_t number, TransportScene& scene) {
    for (ResultPicture& picture : scene.pictures) {
        picture.group = scene.name;
        if (folder.empty()) continue;
        picture.exr = fmt::format("transport-{}-{}.exr", number + 1, picture.title);
        write_exr(folder / picture.exr, picture.linear);
    }
}

} // namespace

int run_transport_command(Queue& queue, const PictureOptions& options, const TransportFlags& flags,
                          const std::string& output, Reporter& reporter) {
    SceneOptions scene = options.scene;
    const std::vector<const TransportPreset*> presets = presets_of(scene, flags);
    TransportSettings settings = settings_of(options, flags, queue.is_cuda(), reporter);
    fit_intrinsics({settings.picture.width, settings.picture.height}, scene.camera);
    std::vector<Subject> subjects; // all are read before the first is measured
    for (const TransportPreset* preset : presets) {
        subjects.push_back(
            read_subject(scene, preset, aspect_of(settings.picture.width, settings.picture.height), reporter));
    }
    if (!output.empty()) check_lab_folder(output);
    reporter.report_messages();
    listen_for_interrupt();

    TransportReport report = {.device = queue.device_name(),
                              .width = settings.picture.width,
                              .height = settings.picture.height,
                              .max_depth = settings.picture.path.max_depth,
                              .repetitions = settings.repetitions,
                              .seed = settings.picture.path.seed,
                              .seconds = settings.seconds};
    const Measurement head = start_measurement(queue, "");
    const double count = static_cast<double>(subjects.size());
    double before_s = 0;
    for (std::size_t i = 0; i < subjects.size() && !report.interrupted; ++i) {
        const Subject& subject = subjects[i];
        settings.reference_integrator =
            flags.reference_integrator.empty() ? subject.reference_integrator : flags.reference_integrator;
        settings.camera = phrase(describe_camera(subject.camera, subject.scene.origin_in_file));
        double seconds = 0;
        ProgressSink part([&](Progress now) {
            seconds = now.seconds;
            now.share = (static_cast<double>(i) + now.share) / count; // every scene takes about as long
            now.seconds += before_s;
            now.seconds_left.reset();
            if (now.share > 0.01) now.seconds_left = now.seconds * (1 - now.share) / now.share;
            now.doing = fmt::format("{}: {}", subject.name, now.doing);
            return reporter.goes_on(now);
        });
        TransportScene measured = run_transport(queue, subject.scene, subject.camera, settings, part);
        before_s += seconds;
        measured.name = subject.name, measured.shows = subject.shows;
        phrase_all(measured);
        report.interrupted = measured.interrupted;
        if (has_findings(measured)) write_pictures(output, i, measured);
        if (has_findings(measured) || !measured.interrupted) report.scenes.push_back(std::move(measured));
        if (!output.empty() && has_findings(report)) {
            write_measurement(output, "transport", measurement_of(report, head), "repetitions");
        }
    }
    reporter.end_progress();
    reporter.event(json_of(measurement_of(report, head), "transport"));
    if (!has_findings(report) && report.interrupted) {
        reporter.print("interrupted before the first measurement; nothing is written");
        return exit_status(ErrorCode::Interrupted);
    }
    reporter.answer(text_of(report));
    if (!output.empty() && has_findings(report)) {
        reporter.print(fmt::format("written: {}", (std::filesystem::path(output) / "transport.html").string()));
    }
    if (!has_findings(report)) {
        throw Error(ErrorCode::BadInput, "none of the integrators can render this; their reasons are above");
    }
    return report.interrupted ? exit_status(ErrorCode::Interrupted) : 0;
}

void add_transport_flags(CLI::App& verb, CLI::Option* transport, TransportFlags& flags) {
    const char* group = "Light transport (--transport)";
    std::vector<std::string> presets = {kAllPresets};
    for (const TransportPreset& preset : the_record().presets) presets.emplace_back(preset.name);
    std::vector<std::string> references;
    for (const IntegratorDescriptor& kind : integrators()) {
        if (!kind.lacks.empty()) references.emplace_back(kind.name);
    }
    const auto add = [&](CLI::Option* option, const char* type) {
        return option->type_name(type)->group(group)->needs(transport);
    };
    add(verb.add_option(
            "--preset", flags.preset,
            fmt::format("a built-in scene with its camera, instead of SCENE:\n{} (cornell)", fmt::join(presets, ", "))),
        "NAME")
        ->check(one_of(presets));
    add(verb.add_option("--integrators", flags.integrators, "some of the integrators (all but direct and indirect)"),
        "NAME,...")
        ->delimiter(',')
        ->check(one_of(integrator_names()));
    add(verb.add_option("--photon-search", flags.photon_search,
                        "structure that photon_map searches; the picture is the same (grid)"),
        "NAME")
        ->check(one_of(names_of<PhotonSearch>()));
    add(verb.add_option("--seconds", flags.seconds, "rendering time of each integrator over all repetitions"), "S")
        ->check(number_above_zero(1e6f))
        ->capture_default_str();
    add(verb.add_option("--repetitions", flags.repetitions,
                        "number of pictures of each integrator, with different seeds"),
        "N")
        ->check(whole_between(1, kMaxRepetitions))
        ->capture_default_str();
    add(verb.add_option("--spp", flags.max_samples, "maximum samples per pixel of one repetition"), "N")
        ->check(whole_between(1, 1u << 20))
        ->capture_default_str();
    add(verb.add_option(
            "--reference", flags.reference,
            "reference picture without noise (.exr, .hdr), of the same size\nand depth (a reference is rendered)"),
        "FILE")
        ->check(file_name());
    add(verb.add_option("--reference-integrator", flags.reference_integrator,
                        "integrator of the reference (path; bidirectional if it is better)"),
        "NAME")
        ->check(one_of(references));
    add(verb.add_option("--reference-spp", flags.reference_samples,
                        "samples per pixel of the reference (1024; CUDA 16384)"),
        "N")
        ->check(whole_between(2, 1u << 24));
}

} // namespace pertev
