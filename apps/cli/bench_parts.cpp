#include "apps/cli/bench_parts.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/report_radiosity.h"
#include "base/error.h"
#include "base/json_text.h"
#include "base/write_file_atomically.h"
#include "formats/builtin_scenes.h"
#include "formats/read_scene.h"
#include "lab/record_scenes.h"
#include "lab/report_page.h"
#include "math/portable_math.h"
#include "session/check_integrator.h"
#include "session/devices/machine.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "session/opening/picture_settings.h"
#include "session/opening/strictness.h"
#include "session/pictures/check_options.h"
#include "session/pictures/prepare_render.h"
#include "settings/parse_values.h"
#include "settings/value_names.h"

namespace pertev {

namespace {

bool is_there(const std::string& scene) {
    std::error_code no_such_name; // a name may be too long for a file
    return builtin_scene(scene) || std::filesystem::exists(scene, no_such_name);
}

} // namespace

void check_bench_scene(const std::string& name, std::string_view others) {
    refuse(!is_scene_name(name), {FileLocation{name}, fmt::format("neither {}{}", others, scene_kinds())});
    refuse(!is_there(name), {FileLocation{name}, "the file does not exist"});
}

void add_record_flags(CLI::App& verb, RecordFlags& flags, SettingVerbs verbs, const char* runs) {
    verb.add_option("--scene", flags.scenes,
                    "sponza, bunny, forest, a scene file or a built-in scene;\nmay be given again (the first three, "
                    "the files under PERTEV_SCENES)")
        ->type_name("NAME|FILE")
        ->check(file_name())
        ->allow_extra_args(false);
    add_whole(verb, "--runs", flags.runs, runs, 1, 10000);
    flags.settings.add(verb, verbs, flags);
    add_bench_report_flags(verb, flags.report);
}

std::vector<std::string> check_record_scenes(std::vector<std::string> names) {
    if (names.empty()) {
        for (const RecordScene& scene : the_record().scenes) names.emplace_back(scene.name);
    }
    for (const std::string& name : names) {
        const RecordScene* const record = find_named(the_record().scenes, name);
        if (record == nullptr) check_bench_scene(name, "sponza, bunny or forest nor ");
        if (record != nullptr) record_file(*record, public_scenes_folder());
    }
    return names;
}

Scene read_record_scene(const std::string& name, Sink& sink) {
    if (const RecordScene* record = find_named(the_record().scenes, name)) {
        return make_record_scene(*record, public_scenes_folder(), sink);
    }
    return read_scene(name, {.geometry_only = true}, sink);
}

Scene read_lab_scene(const SceneOptions& options, Sink& sink) {
    const std::string& name = options.scene;
    if (const RecordScene* record = find_named(the_record().scenes, name)) {
        refuse(!options.file_scene.empty(),
               {"file_scene", options.file_scene, fmt::format("{} has fixed scenes", name)});
        refuse(!options.variant.empty(), {"variant", options.variant, fmt::format("{} has fixed scenes", name)});
        return make_record_scene(*record, public_scenes_folder(), sink);
    }
    if (!is_there(name)) {
        std::vector<std::string_view> known = builtin_scene_names();
        for (const RecordScene& record : the_record().scenes) known.emplace_back(record.name);
        throw Error(ErrorCode::BadInput, "scene", name,
                    fmt::format("neither a file nor a scene name; the scenes are {}", fmt::join(known, ", ")));
    }
    return read_any_scene(options, sink);
}

std::string lab_scene_title(const std::string& scene) {
    return utf8_text(std::filesystem::path(scene).stem().string());
}

std::unique_ptr<BenchedScene> read_benched_scene(RenderFlags& flags, SettingVerbs verb, Reporter& reporter) {
    flags.settings.read(flags, reporter); // before anything is read
    check_options(flags, verb);
    listen_for_interrupt();
    apply_camera_from(flags);
    auto benched = std::make_unique<BenchedScene>();
    if (verb == kBenchFrames) {
        for (auto& queue : open_queues(flags.machine, reporter)) benched->queues.push_back(std::move(queue));
    } else {
        benched->queues.push_back(open_queue(flags.machine, reporter));
    }
    benched->queue = benched->queues.front();
    const UseThreads threads(benched->queue->threads());
    reporter.report_messages();
    reporter.set_work(fmt::format("loading {}", flags.scene.scene));
    benched->scene = open_scene(flags.scene, reporter, SceneUse::Benchmark);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing was measured");
    const RenderSettings& settings = benched->settings = render_settings(flags, benched->scene);
    check_light(settings, benched->scene, reporter);
    fit_intrinsics({settings.width, settings.height}, flags.scene.camera);
    benched->camera =
        choose_camera(flags.scene.camera, benched->scene, aspect_of(settings.width, settings.height), reporter);
    check_camera(settings, benched->camera);
    if (verb == kBenchFrames) check_reconstruction(benched->camera);
    throw_if_interrupted();
    reporter.set_work("building trees");
    benched->prepared = prepare_scene(benched->scene, {}, reporter);
    reporter.report_messages();
    if (is_solved(settings.integrator)) {
        benched->settings.radiosity = radiosity_display(benched->prepared, flags.radiosity, settings.path.seed,
                                                        reporter, report_solving(reporter));
    }
    bytes_to_render(flags, benched->prepared, settings, *benched->queue);
    return benched;
}

void add_picture_flags(CLI::App& verb, SettingVerbs verbs, PictureFlags& flags, const std::string& sizes,
                       const std::string& samples) {
    flags.settings.add(verb, verbs, flags, all_settings(), {{"size", sizes}, {"spp", samples}});
    add_bench_report_flags(verb, flags.report);
}

PrepareOptions trees_for(const RenderSettings& settings, const Queue& queue) {
    PrepareOptions options;
    options.builder = builder_of(tracers_of(settings, queue.is_cuda()));
    return options;
}

void add_bench_report_flags(CLI::App& verb, ReportFlags& flags) {
    add_report_flags(verb, flags);
    verb.add_option(
            "--report", flags.measurement,
            "writes the measurement with machine and command as JSON, as a page\nwith plots, or its rows as CSV")
        ->type_name("FILE.json|.html|.csv")
        ->check(file_name());
}

BenchReport::BenchReport(Reporter& reporter, const ReportFlags& flags, const Queue& queue, std::string title)
    : reporter_(reporter), file_(flags.measurement), measurement_(start_measurement(queue, std::move(title))) {
    if (file_.empty()) return;
    const std::string extension = std::filesystem::path(file_).extension().string();
    refuse(extension != ".json" && extension != ".html" && extension != ".csv",
           {"report", file_, "expected a name that ends in .json, .html or .csv"});
    check_writable(file_);
}

ResultTable& BenchReport::table_of(const char* name) {
    for (ResultTable& table : measurement_.tables) {
        if (table.name == name) return table;
    }
    return measurement_.tables.emplace_back(ResultTable{name, name});
}

void BenchReport::add(const char* event, const Fields& fields, const std::string& above) {
    ResultTable& table = table_of(event);
    table.add(fields);
    reporter_.event(json_of(event, fields));
    if (table.rows.size() == 1) reporter_.answer(above + line_of(table, std::nullopt));
    reporter_.answer(line_of(table, table.rows.size() - 1));
}

void BenchReport::add_alone(const char* event, const Fields& fields) {
    table_of(event).add(fields);
    reporter_.event(json_of(event, fields));
    reporter_.answer(text_of(fields));
}

void BenchReport::keep(const char* name, const Fields& fields) { table_of(name).add(fields); }

void BenchReport::write() const {
    if (file_.empty()) return;
    const std::string extension = std::filesystem::path(file_).extension().string();
    const std::string json = json_of(measurement_, "", extension == ".html");
    std::string text = extension == ".html" ? report_page({&json, 1}) : json + '\n';
    if (extension == ".csv") {
        text.clear();
        for (const ResultTable& table : measurement_.tables) text += csv_of(measurement_, table.name);
    }
    reporter_.write_output(file_, [&] { write_file_atomically(file_, std::as_bytes(std::span(text))); });
}

Fields time_fields(const RunTimes& times) {
    return {{"median_seconds", "median", times.median, "s", "{:.6f}"},
            {"least_seconds", "least", times.least, "s", "{:.6f}"},
            {"greatest_seconds", "greatest", times.greatest, "s", "{:.6f}"},
            {"runs", "", times.runs}};
}

Camera moved(const Camera& camera, float yaw, Vec3 step) {
    const float c = cos(yaw), s = sin(yaw);
    const auto turned = [&](Vec3 v) { return Vec3{c * v.x + s * v.z, v.y, c * v.z - s * v.x}; };
    const Transform& m = camera.world_from_camera;
    Camera result = camera;
    const Vec3 x = turned(column(m, 0)), y = turned(column(m, 1)), z = turned(column(m, 2));
    result.world_from_camera = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, {}};
    result.world_from_camera.translation = m.translation + transform_vector(result.world_from_camera, step);
    return result;
}

CameraBatch cameras_about(const Camera& camera, uint32_t count, float scene_size) {
    CameraBatch batch;
    for (uint32_t k = 0; k < count; ++k) {
        const auto part_of = [&](double share) {
            const double at = k * share;
            return static_cast<float>(at - static_cast<uint32_t>(at));
        };
        const Vec3 aside = {part_of(0.7548776662) - 0.5f, part_of(0.5698402910) - 0.5f, 0};
        batch.cameras.push_back(moved(camera, kPi / 3 * (part_of(0.6180339887) - 0.5f), (0.04f * scene_size) * aside));
    }
    return batch;
}

void render_again(Session& session, uint32_t samples) {
    throw_if_interrupted();
    session.cut();
    session.render(samples, InterruptSink());
    throw_if_interrupted();
}

CLI::App& add_bench_verb(CLI::App& bench, const char* name, const char* help, std::function<void()> run) {
    CLI::App& verb = *bench.add_subcommand(name, help);
    verb.callback([&bench, &verb, run = std::move(run)] {
        for (const CLI::Option* flag : bench.get_options()) {
            if (flag->count() == 0) continue;
            throw Error(ErrorCode::BadInput, fmt::format("{} is a flag of `bench {}` and must come after that name",
                                                         flag->get_name(), verb.get_name()));
        }
        run();
    });
    return verb;
}

} // namespace pertev
