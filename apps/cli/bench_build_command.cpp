// pertev bench build: times the device's builder of compressed trees, and compares the trees' SAH costs with those of
// the host's builders.

#include <memory>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/builders.h"
#include "apps/cli/bench_parts.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/interrupt.h"
#include "apps/cli/reporter.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "device/device_timer.h"
#include "device_scene/place_meshes.h"
#include "lab/record_scenes.h"
#include "lab/stored_figures.h"
#include "session/devices/machine.h"
#include "tracer/hploc/device_builder.h"

namespace pertev {
namespace {

struct BuildFlags : RecordFlags {
    bool compare = false;
};

/// Returns the triangles that do not move, in world space; if there are none, the first mesh's.
std::vector<BvhTriangle> read_triangles(const std::string& name, Sink& sink) {
    const Scene scene = read_record_scene(name, sink);
    std::vector<BvhTriangle> triangles = baked_triangles(scene, place_meshes(scene));
    return triangles.empty() && !scene.meshes.empty() ? mesh_triangles(scene.meshes.front()) : triangles;
}

Fields head_of(const std::string& scene, const char* title, std::string_view tree, const std::string& device,
               uint64_t triangles) {
    return {{"scene", "scene", scene},
            {"tree", title, tree},
            {"device", "", device},
            {"triangles", "triangles", triangles}};
}

/// Reports a build. `ratio` is the tree's cost relative to the SBVH's; 0 if unknown.
void add_build(const std::string& scene, std::string_view tree, const std::string& device, uint64_t triangles,
               const RunTimes& times, std::size_t nodes, int depth, float cost, double ratio, BenchReport& report) {
    const RecordScene* const record = find_named(the_record().scenes, scene);
    const bool is_known = is_on_record(device, record, triangles);
    report.add(
        "build",
        head_of(scene, "tree", tree, device, triangles) + time_fields(times) +
            Fields{{"triangles_per_second", "tri/s", millions_a_second(triangles, times.median) * 1e6, "", "{:.3g}"},
                   {"nodes", "nodes", nodes},
                   {"depth", "depth", depth},
                   {"sah_cost", "cost", static_cast<double>(cost), "", "{:.3f}"},
                   {"ratio_to_sbvh", "of sbvh", if_timed(ratio), "", "{:.3f}"},
                   ratio_field("ratio_to_optix_fast_trace", "to trace", is_known,
                               is_known ? record->optix_fast_trace_s / times.median : 0),
                   ratio_field("ratio_to_optix_fast_build", "to build", is_known,
                               is_known ? record->optix_fast_build_s / times.median : 0)},
        fmt::format(
            "hploc starts from triangles on the device and ends with compressed nodes and triangles there;\n"
            "the others run on the CPU. cost: expected cost of a ray by the surface area heuristic; to trace, to\n"
            "build: rates relative to OptiX's, only on an {}\n",
            the_record().device));
}

void bench_scene(const std::string& name, Queue& queue, const BuildFlags& flags, Reporter& reporter,
                 BenchReport& report) {
    reporter.set_work(fmt::format("{}: reading", name));
    const std::vector<BvhTriangle> triangles = read_triangles(name, reporter);
    reporter.report_messages();
    throw_if_interrupted();
    float sbvh_cost = 0;
    const auto count = static_cast<uint32_t>(triangles.size());
    const auto ratio = [&](float cost) {
        return sbvh_cost > 0 ? static_cast<double>(cost) / static_cast<double>(sbvh_cost) : 0.0;
    };
    if (flags.compare) {
        for (const BvhBuilder builder : {BvhBuilder::SpatialSplits, BvhBuilder::SpatialReinsertion,
                                         BvhBuilder::Reinsertion, BvhBuilder::Binned, BvhBuilder::Ploc}) {
            reporter.set_work(fmt::format("{}: building by {}", name, name_of(builder)));
            const Stopwatch watch;
            const CompressedBvh bvh = make_compressed_bvh(build_bvh(builder, triangles));
            const double seconds = watch.seconds();
            if (builder == BvhBuilder::SpatialSplits) sbvh_cost = bvh.sah_cost;
            add_build(name, name_of(builder), "cpu", count, {seconds, seconds, seconds, 1}, bvh.nodes.size(), bvh.depth,
                      bvh.sah_cost, ratio(bvh.sah_cost), report);
            throw_if_interrupted();
        }
    }
    reporter.set_work(fmt::format("{}: building on the device", name));
    const Buffer<BvhTriangle> there(queue, std::span(triangles), "triangles to build over");
    DeviceBuilder builder(queue, count);
    const int runs = flags.runs > 0 ? static_cast<int>(flags.runs) : (queue.is_cuda() ? 25 : 3);
    const auto time = [&](const auto& run) {
        return time_runs(queue, queue.is_cuda() ? 3 : 1, runs, run, throw_if_interrupted);
    };
    const RunTimes times = time([&] { builder.start(there.data(), count); });
    const DeviceBuilder::Figures figures = builder.finish();
    add_build(name, "hploc", queue.device_name(), count, times, figures.nodes, figures.depth, figures.sah_cost,
              ratio(figures.sah_cost), report);
    const RunTimes refits = time([&] { builder.start_refit(there.data()); });
    if (builder.finish().bounds != figures.bounds) {
        throw Error(ErrorCode::DeviceFault,
                    fmt::format("{}: a tree that was refitted to its own triangles has other bounds", name));
    }
    report.add("refit", head_of(name, "refitted", "hploc", queue.device_name(), count) + time_fields(refits));
}

int bench_build(BuildFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter);
    const std::vector<std::string> scenes = check_record_scenes(flags.scenes);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = open_queue(flags.machine, reporter);
    const UseThreads threads(queue->threads());
    BenchReport report(reporter, flags.report, *queue, "Trees built on the device");
    for (const std::string& scene : scenes) bench_scene(scene, *queue, flags, reporter, report);
    report.write();
    return 0;
}

} // namespace

void add_bench_build_command(CLI::App& bench, int& status) {
    const auto flags = std::make_shared<BuildFlags>();
    CLI::App& verb = add_bench_verb(bench, "build", "Measure trees that are built on the device",
                                    [flags, &status] { status = bench_build(*flags); });
    add_record_flags(verb, *flags, kBenchBuild, "number of timed builds (3 on the CPU, 25 in CUDA)");
    verb.add_flag("--compare", flags->compare,
                  "also builds sbvh, sbvh-reinsertion, reinsertion, binned and\nploc on the CPU");
}

} // namespace pertev
