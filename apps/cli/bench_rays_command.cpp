// pertev bench rays: times the traversals of pictures on ray sets that other tracers can use, too (docs/ray_sets.md).
// It also prints stored figures of the same sets, and the ratio to the best public tracer if both have the same rays
// and card (lab/stored_figures.h). The tree is the best one unless --build names another. On a CPU it is traversed with
// one ray after the other, where pictures go by packets and flights of rays (trace/wide/trace_many.h).

#include <algorithm>
#include <memory>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "lab/isolated_rays.h"
#include "lab/measure_rays.h"
#include "lab/ray_sets.h"
#include "lab/record_scenes.h"
#include "lab/stored_figures.h"
#include "render/prepare_scene.h"
#include "session/devices/machine.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/choose_camera.h"
#include "settings/tracer_options.h"

namespace pertev {
namespace {

struct RaysFlags : RecordFlags {
    uint32_t count = kRecordRays;
    bool check = false, axes = false;
};

/// A set of rays of a scene: `number` is its index, `record` the record's scene seen by its own camera, or null.
struct SetOfScene {
    std::string scene;
    const RecordScene* record;
    std::size_t number;
    const PreparedScene& prepared;
};

std::string describe(const RayHit& hit) { return fmt::format("({}, {}, {})", hit.t, hit.instance, hit.primitive); }

/// Compares hits with the binary traversal's on the host. Throws Error(DeviceFault) that names the first ray that
/// differs.
void check_hits(const std::vector<RayHit>& hits, const RaySet& set, const PreparedScene& prepared) {
    Queue cpu = Queue::make_cpu();
    RaysOnDevice rays(cpu, set);
    rays.trace(make_tracer(cpu, kBinaryTracer, prepared));
    const std::vector<RayHit> wanted = rays.hits();
    const auto [found, want] = std::ranges::mismatch(hits, wanted);
    if (found == hits.end()) return;
    throw Error(ErrorCode::DeviceFault,
                fmt::format("{}: ray {} of {} hits {}, by the binary traversal on the CPU {}", set.name,
                            found - hits.begin(), hits.size(), describe(*found), describe(*want)));
}

/// Returns the set's row. Its ratio to the best public tracer, if it is on the record, goes to `ratios`.
Fields measure(Queue& queue, const RaySet& set, const SetOfScene& of, const RaysFlags& flags,
               const TracerChoice& choice, std::vector<double>& ratios) {
    const Combination& combination = tracer_of_pictures(set, choice);
    const std::string device = queue.device_name(), name = name_of(combination);
    const bool any = !set.rays.empty();
    RunTimes times;
    WorkSummary work;
    double share = 0;
    if (any) {
        throw_if_interrupted();
        const Tracer tracer = make_tracer(queue, combination, of.prepared);
        RaysOnDevice rays(queue, set);
        rays.trace(tracer);
        const std::vector<RayHit> hits = rays.hits();
        if (flags.check) check_hits(hits, set, of.prepared);
        share = hit_share(hits);
        throw_if_interrupted();
        Combination counted = kBinaryTracer;
        counted.options.near_first = !set.any_hit; // the record's choice
        work = summarize_work(rays.count_work(make_tracer(queue, counted, of.prepared)));
        const int runs = flags.runs > 0 ? static_cast<int>(flags.runs) : (queue.is_cuda() ? 25 : 5);
        times = time_runs(queue, queue.is_cuda() ? 3 : 1, runs, [&] {
            throw_if_interrupted(); // a run of millions of rays takes seconds on a CPU
            rays.trace(tracer);
        });
    }
    const double rate = times.median > 0 ? static_cast<double>(set.rays.size()) / times.median : 0.0;
    const bool is_known = is_on_record(device, of.record, of.prepared.triangles, of.number, set.rays.size(), share);
    const RecordedSet r = of.record != nullptr ? of.record->sets[of.number] : RecordedSet{};
    if (is_known) ratios.push_back(rate / r.best_rays_per_second);
    const auto recorded = [&](double value) { return of.record != nullptr ? ResultCell(value) : ResultCell(); };
    const auto traced = [any](auto value) { return any ? ResultCell(value) : ResultCell(); };
    return Fields{{"scene", "scene", of.scene},
                  {"set", "set", set.name},
                  {"device", "", device},
                  {"tracer", "", name},
                  {"rays", "rays", set.rays.size()},
                  {"rays_per_second", "", traced(rate)},
                  {"mrays", "Mrays/s", traced(rate * 1e-6), "", "{:.2f}"}} +
           time_fields(times) +
           Fields{{"hit_share", "hits", share, "", "{:.3f}"},
                  {"nodes", "nodes", work.nodes, "", "{:.1f}"},
                  {"triangles", "tri", work.triangles, "", "{:.1f}"},
                  {"most_nodes", "most", work.max_nodes},
                  {"most_triangles", "", work.max_triangles},
                  {"checked", "", flags.check},
                  {"best_mrays", "best", recorded(r.best_rays_per_second * 1e-6), "", "{:.0f}"},
                  ratio_field("ratio_to_best", "ratio", is_known, is_known ? ratios.back() : 0),
                  {"recorded_hit_share", "its hits", recorded(r.hit_share), "", "{:.3f}"},
                  {"recorded_nodes", "its nodes", recorded(r.nodes), "", "{:.1f}"},
                  {"recorded_triangles", "its tri", recorded(r.triangles), "", "{:.1f}"},
                  {"traced_by", "traced by", any ? name : "empty, because no ray before it hit a surface"}};
}

/// Prints the summary of ratios to the best public tracers, if there are any; `scene` is "" of all scenes together.
void print_summary(const std::string& scene, std::span<const double> ratios, Reporter& reporter) {
    if (ratios.empty()) return;
    const auto [mean, least] = summarize(ratios);
    reporter.event(json_of("ratios", {{"scene", "", if_not_empty(scene)},
                                      {"sets", "", ratios.size()},
                                      {"ratio_to_best", "", mean},
                                      {"least", "", least}}));
    reporter.answer(
        fmt::format("{}: {:.2f} times the best public tracer (geometric mean of {} sets; the lowest is {:.2f})\n",
                    scene.empty() ? "all" : scene, mean, ratios.size(), least));
}

/// Ratios to the best public tracers go to `all`.
void bench_scene(const std::string& name, Queue& queue, const RaysFlags& flags, const TracerChoice& choice,
                 BenchReport& report, std::vector<double>& all, Reporter& reporter) {
    reporter.set_work(fmt::format("{}: making ray sets", name));
    Stopwatch watch;
    const Scene scene = read_record_scene(name, reporter);
    const double load_s = watch.seconds();
    throw_if_interrupted();
    const PreparedScene prepared = // the sets are in the file's coordinates
        prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .tracers = choice, .keep_coordinates = true}, reporter);
    const FrameSize frame = record_frame(flags.count);
    CameraChoice choice_of_camera = flags.scene.camera;
    fit_intrinsics({frame.width, frame.height}, choice_of_camera);
    const Camera camera = choose_camera(choice_of_camera, scene, 16.0f / 9.0f, reporter);
    reporter.report_messages();
    watch.restart();
    std::vector<RaySet> sets = make_isolated_sets(queue, scene, camera, prepared, flags.count, reporter);
    const std::size_t recorded = sets.size();
    if (flags.axes) std::ranges::move(make_axis_ray_sets(sets[2]), std::back_inserter(sets));
    reporter.print(fmt::format("{}: {} triangles, scene {:.2f} s, trees {:.2f} s, ray sets {:.2f} s (frames of {}x{})",
                               name, prepared.triangles, load_s, prepared.build_seconds, watch.seconds(), frame.width,
                               frame.height));
    const RecordScene* const record = find_named(the_record().scenes, name);
    Messages unsaid; // they are those of its first use
    const bool is_moved = !(camera == choose_camera({}, scene, 16.0f / 9.0f, unsaid));
    std::vector<double> ratios;
    for (std::size_t i = 0; i < sets.size(); ++i) {
        reporter.set_work(fmt::format("{}: measuring {}", name, sets[i].name));
        const SetOfScene of = {record != nullptr ? name : std::filesystem::path(name).stem().string(),
                               is_moved || i >= recorded ? nullptr : record, i, prepared};
        report.add("rays", measure(queue, sets[i], of, flags, choice, ratios),
                   fmt::format(
                       "share of hits; nodes and triangles per ray in the binary tree, and nodes of the costliest ray; "
                       "at the right\nthe best public tracer on an {}, the ratio to it on the same device, and what "
                       "the record has for these rays\n",
                       the_record().device));
        sets[i].rays = {}; // a quarter of a gigabyte on the record
    }
    print_summary(name, ratios, reporter);
    all.insert(all.end(), ratios.begin(), ratios.end());
    if (flags.check) {
        reporter.answer(fmt::format(
            "{}: checked; each hit is the same as that of the binary traversal on the CPU, bit for bit\n", name));
    }
}

int bench_rays(RaysFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    apply_camera_from(flags);
    const std::vector<std::string> scenes = check_record_scenes(flags.scenes);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = open_queue(flags.machine, reporter);
    const UseThreads threads(queue->threads());
    const TracerChoice choice = tracer_choice(flags.tracer, queue->is_cuda()).value(); // best trees have a default
    BenchReport report(reporter, flags.report, *queue, "Rays of the record");
    std::vector<double> ratios;
    for (const std::string& scene : scenes) bench_scene(scene, *queue, flags, choice, report, ratios, reporter);
    if (scenes.size() > 1) print_summary("", ratios, reporter);
    report.write();
    return 0;
}

} // namespace

void add_bench_rays_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<RaysFlags>();
    CLI::App& verb = add_bench_verb(bench, "rays", "Time traversal on the ray sets that other tracers were timed on",
                                    [flags, &status] { status = bench_rays(*flags); });
    add_whole(verb, "--count", flags->count, "rays per set; the record's is four frames of 1920x1080", 1, 1u << 30)
        ->capture_default_str();
    verb.add_flag("--check", flags->check, "compares every hit with that of the binary traversal on the CPU");
    verb.add_flag("--axes", flags->axes, "two more sets: diffuse1 along axes, and tilted by a thousandth");
    flags->tracer.default_build = TreeBuild::Best; // no tree's making is timed
    add_record_flags(verb, *flags, kBenchRays, "timed runs per set (5 on the CPU, 25 in CUDA)");
}

} // namespace pertev
