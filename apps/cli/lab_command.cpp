// pertev lab: every structure and every traversal side by side, on this machine and scene.

#include <algorithm>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/commands.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/flag_phrases.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/lab_files.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "apps/cli/thesis_command.h"
#include "apps/cli/transport_command.h"
#include "base/error.h"
#include "formats/files/parse_number.h"
#include "lab/describe_camera.h"
#include "lab/lab_tables.h"
#include "lab/list_combinations.h"
#include "lab/ray_sets.h"
#include "lab/record_scenes.h"
#include "lab/run_lab.h"
#include "session/devices/machine.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/strictness.h"

namespace pertev {
namespace {

struct LabFlags : PictureOptions {
    std::vector<std::string> structures, traversals, rays = {"primary", "shadow", "diffuse"}, tests = {"exact"};
    std::vector<std::string> rta = {"both"};
    std::string order = "on", persistent = "both", depths;
    std::string output;
    uint32_t runs = 20, count = 0;
    bool no_heat_maps = false, thesis = false, transport = false;
    TransportFlags of_transport;
    SettingFlags settings;
    ReportFlags report;
};

std::vector<bool> on_off(const std::string& value) {
    if (value == "both") return {true, false};
    return {value == "on"};
}

/// The requested switches, those with the most on first, because heat maps show the first of a traversal.
std::vector<TraversalOptions> traversal_options(const LabFlags& flags) {
    const auto named = [](const std::vector<std::string>& list, std::string_view name) {
        return std::ranges::find(list, name) != list.end();
    };
    std::vector<TraversalOptions> options;
    for (const TestKind tests : kValuesOf<TestKind>) {
        if (!named(flags.tests, name_of(tests))) continue;
        for (const std::string rta : {"on", "nodes", "off"}) {
            if (!named(flags.rta, rta) && !(named(flags.rta, "both") && rta != "nodes")) continue;
            for (const bool near_first : on_off(flags.order)) {
                options.push_back({rta != "off", near_first, tests, rta != "nodes"});
            }
        }
    }
    return options;
}

/// Returns first and last depth of "1-8" or "8", which are the same range.
std::pair<int, int> parse_depths(const std::string& text) {
    const std::size_t dash = text.find('-');
    const auto last = parse_whole_number(dash == std::string::npos ? text : text.substr(dash + 1));
    const auto first =
        dash == std::string::npos ? std::optional<uint64_t>(1) : parse_whole_number(text.substr(0, dash));
    if (!first || !last || *first < 1 || *first > *last || *last > kMaxFrameDepth + 1) {
        throw Error(ErrorCode::BadInput, "depths", text,
                    fmt::format("expected a largest depth or a range such as 1-8, within 1-{}", kMaxFrameDepth + 1));
    }
    return {static_cast<int>(*first), static_cast<int>(*last)};
}

/// Returns the named kinds, or all if none is named. CLI11 has checked the names.
template <class Kind>
std::vector<Kind> chosen(const std::vector<std::string>& names) {
    std::vector<Kind> kinds;
    for (const std::string& name : names) {
        const Kind kind = *value_named<Kind>(name);
        if (std::ranges::find(kinds, kind) == kinds.end()) kinds.push_back(kind);
    }
    return names.empty() ? std::vector<Kind>(kValuesOf<Kind>.begin(), kValuesOf<Kind>.end()) : kinds;
}

LabSettings lab_settings(const LabFlags& flags, bool is_cuda) {
    LabSettings settings;
    settings.structures = chosen<StructureKind>(flags.structures);
    settings.by_name = !flags.structures.empty() && !flags.traversals.empty();
    settings.traversals = chosen<TraversalKind>(flags.traversals);
    // A brute-force traversal over all of a frame's rays takes hours, so it must be named.
    if (flags.traversals.empty()) std::erase(settings.traversals, TraversalKind::BruteForce);
    settings.options = traversal_options(flags);
    settings.distributions.clear();
    if (!is_cuda && flags.persistent == "on") {
        throw Error(ErrorCode::BadInput, "persistent", "on",
                    "applies to GPUs; CPU threads always take rays from a pool");
    }
    if (!is_cuda || flags.persistent != "on") settings.distributions.push_back(Distribution::OneAThread);
    if (is_cuda && flags.persistent != "off") {
        settings.distributions.push_back(Distribution::Persistent);
        settings.distributions.push_back(Distribution::DynamicFetch);
    }
    const PictureSize size = flags.size.value_or(PictureSize{1024, 768});
    settings.width = size.width, settings.height = size.height;
    const std::string depths = !flags.depths.empty() ? flags.depths : flags.thesis ? "1-8" : "1-3";
    std::tie(settings.first_depth, settings.depth) = parse_depths(depths);
    const auto traces = [&](const char* kind) { return std::ranges::find(flags.rays, kind) != flags.rays.end(); };
    settings.primary = traces("primary"), settings.shadow = traces("shadow"), settings.diffuse = traces("diffuse");
    if (traces("record")) {
        if (flags.rays.size() > 1 || flags.size || !flags.depths.empty()) {
            throw Error(ErrorCode::BadInput, "rays", "record",
                        "the record's ray sets are fixed; leave out other kinds, --size and --depths");
        }
        settings.record_rays = flags.count > 0 ? flags.count : kRecordRays;
        const FrameSize frame = record_frame(settings.record_rays);
        settings.width = frame.width, settings.height = frame.height;
    } else if (flags.count > 0) {
        throw Error(ErrorCode::BadInput, "count", "", "applies to --rays record; --size sets the rays of a frame");
    }
    settings.runs = static_cast<int>(flags.runs);
    settings.warm_ups = is_cuda ? 3 : 1;
    settings.heat_maps = !flags.no_heat_maps && !flags.output.empty();
    return settings;
}

int run(LabFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    if (!flags.thesis && !flags.transport && flags.scene.scene.empty()) {
        throw Error(ErrorCode::BadInput, "scene", "", "a scene is required (or --thesis, or --transport)");
    }
    apply_camera_from(flags);
    const std::unique_ptr<Queue> queue = open_queue(flags.machine, reporter);
    const UseThreads threads(queue->threads());
    if (flags.transport) {
        reporter.set_work("loading");
        return run_transport_command(*queue, flags, flags.of_transport, flags.output, reporter);
    }
    LabSettings settings = lab_settings(flags, queue->is_cuda());
    fit_intrinsics({settings.width, settings.height}, flags.scene.camera);
    reporter.set_work("loading");
    if (flags.thesis) return run_thesis(*queue, flags.scene, settings, flags.output, reporter);

    const Scene scene = read_lab_scene(flags.scene, reporter);
    if (flags.strict) refuse_what_is_left_out(reporter, "nothing was measured");
    const Camera camera =
        choose_camera(flags.scene.camera, scene, aspect_of(settings.width, settings.height), reporter);
    check_any_can_run(list_combinations(settings, queue->is_cuda())); // before a folder is made
    if (!flags.output.empty()) check_lab_folder(flags.output);
    reporter.report_messages();
    settings.scene = lab_scene_title(flags.scene.scene);
    settings.camera = phrase(describe_camera(camera, scene.origin_in_file));
    listen_for_interrupt();
    const Measurement head = start_measurement(*queue, settings.scene);
    const auto save = [&](const LabReport& so_far) {
        if (flags.output.empty() || !has_findings(so_far)) return;
        write_measurement(flags.output, "report", measurement_of(so_far, head), "runs");
    };
    const LabReport report = run_lab(*queue, scene, camera, settings, reporter, save);
    reporter.end_progress();
    reporter.result(json_of(measurement_of(report, head), "lab"));
    if (!has_findings(report) && report.interrupted) {
        reporter.print("interrupted before the first measurement; nothing is written");
        return exit_status(ErrorCode::Interrupted);
    }
    reporter.answer(text_of(report));
    if (!flags.output.empty()) {
        write_measurement(flags.output, "report", measurement_of(report, head), "runs");
        reporter.print(fmt::format("written: {}", (std::filesystem::path(flags.output) / "report.html").string()));
    }
    fail_if_wrong(report);
    return report.interrupted ? exit_status(ErrorCode::Interrupted) : 0;
}

void add_switch(CLI::App& verb, const char* flag, std::string& value, const char* what) {
    verb.add_option(flag, value, what)->type_name("WHICH")->check(one_of({"on", "off", "both"}))->capture_default_str();
}

} // namespace

void add_lab_command(CLI::App& app, int& status) {
    CLI::App& verb = *app.add_subcommand(
        "lab", "Compare every structure and traversal, or every integrator, on your scene and device");
    const auto flags = std::make_shared<LabFlags>();
    CLI::Option* scene = add_scene_name(verb, flags->scene)->required(false);
    scene->description(scene->get_description() + "; or\nsponza, bunny or forest: the scenes of bench rays");
    verb.add_option("--structures", flags->structures, "some of the structures (all)")
        ->type_name("NAME,...")
        ->delimiter(',')
        ->check(one_of(names_of<StructureKind>()));
    verb.add_option("--traversals,--walks", flags->traversals, "some of the traversals (all but brute-force)")
        ->type_name("NAME,...")
        ->delimiter(',')
        ->check(one_of(names_of<TraversalKind>()));
    verb.add_option(
            "--rta", flags->rta,
            "redundant traversal avoidance: skips nodes behind the nearest\nhit; nodes, of compressed alone: tests "
            "at nodes and not at pops")
        ->type_name("WHICH,...")
        ->delimiter(',')
        ->check(one_of({"on", "off", "both", "nodes"}))
        ->capture_default_str();
    add_switch(verb, "--order", flags->order, "visits nearer children first");
    verb.add_option(
            "--tests", flags->tests,
            "the triangle test: exact; fast, which leaks at edges, as in most\ntracers; or woop, Aila and Laine's "
            "unit triangles, which leaks too")
        ->type_name("WHICH,...")
        ->delimiter(',')
        ->check(one_of(names_of<TestKind>()))
        ->capture_default_str();
    add_switch(verb, "--persistent", flags->persistent, "CUDA: threads take rays from a pool");
    verb.add_option("--depths", flags->depths,
                    fmt::format("frames of paths of FIRST to LAST rays, LAST at most {}; LAST\nalone is 1-LAST (1-3; "
                                "with --thesis 1-8)",
                                kMaxFrameDepth + 1))
        ->type_name("[FIRST-]LAST");
    verb.add_option(
            "--rays", flags->rays,
            "sets of rays: primary, shadow, diffuse, or record, the five of\nbench rays (primary,shadow,diffuse)")
        ->type_name("KIND,...")
        ->delimiter(',')
        ->check(one_of({"primary", "shadow", "diffuse", "record"}));
    add_whole(verb, "--count", flags->count, "rays per set of the record (8294400)", 1, 1u << 30);
    add_whole(verb, "--runs", flags->runs, "number of timed runs; the result is the median", 1, 10000)
        ->capture_default_str();
    verb.add_flag("--no-heat-maps", flags->no_heat_maps, "omits heat maps of traversal tests per pixel");
    CLI::Option* thesis =
        verb.add_flag("--thesis", flags->thesis,
                      "repeats chapter 6 of the thesis: the Cornell box and Sibenik\n(SCENE, or found "
                      "under PERTEV_SCENES), depths 1-8; with -o also\nthe pictures of chapters 2 to 4");
    CLI::Option* transport =
        verb.add_flag("--transport", flags->transport,
                      "compares integrators instead of traversals: error over time\nagainst a reference");
    for (const char* flag : {"--structures", "--traversals", "--rta", "--order", "--tests", "--persistent", "--rays",
                             "--count", "--no-heat-maps"}) {
        thesis->excludes(verb.get_option(flag)); // the comparison of the thesis
        transport->excludes(verb.get_option(flag));
    }
    for (const char* flag : {"--thesis", "--depths", "--runs"}) transport->excludes(verb.get_option(flag));
    add_transport_flags(verb, transport, flags->of_transport);
    CLI::Option* output =
        verb.add_option(
                "-o,--output", flags->output,
                "folder for report.html, .csv and .json; with --thesis thesis.html\nand .json, its pictures and "
                "thesis-1 and -2.csv; with --transport\ntransport.html, .csv, .json and EXR files")
            ->type_name("DIR");
    flags->render.path.max_depth = kTransportDepth;
    flags->settings.add(verb, kLab, *flags, all_settings(), {{"size", "1024x768; with --transport 256x256"}});
    for (const char* flag : {"--max-depth", "--seed"}) verb.get_option(flag)->needs(transport);
    for (CLI::Option* many : {thesis, transport}) many->excludes(verb.get_option("--strict")); // their scenes are known
    add_report_flags(verb, flags->report);
    verb.callback([flags, output, &status] {
        if (output->count() > 0 && flags->output.empty()) {
            throw Error(ErrorCode::BadInput, "output", "", "the name of the folder is empty");
        }
        status = run(*flags);
    });
}

} // namespace pertev
