// pertev bench build: how long the builder that runs on the device takes for a tree of compressed nodes, and what rays
// would pay for that tree beside those of builders on the host.

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
#include "session/machine.h"
#include "tracer/hploc/device_builder.h"

namespace pertev {
namespace {

struct BuildFlags : PictureOptions {
    std::vector<std::string> scenes;
    uint32_t runs = 0;
    bool compare = false;
    SettingFlags settings;
    ReportFlags report;
};

/// All triangles that do not move, in one world; where there are none, those of the first mesh.
std::vector<BvhTriangle> read_triangles(const std::string& name, Messages& messages) {
    const Scene scene = read_record_scene(name, messages);
    std::vector<BvhTriangle> triangles = baked_triangles(scene, place_meshes(scene));
    return triangles.empty() && !scene.meshes.empty() ? mesh_triangles(scene.meshes.front()) : triangles;
}

/// `ratio`: of the tree's cost to that of the SBVH; 0: not known. `scene` may be one of the record.
void print(const std::string& scene, std::string_view tree, const std::string& device, uint64_t triangles,
           const RunTimes& times, std::size_t nodes, int depth, float cost, double ratio, Reporter& reporter) {
    const std::vector<Ratio> others = ratios_of(BuildRun{device, find_record_scene(scene), triangles, times.median});
    if (reporter.json()) {
        return reporter.event(fmt::format(
            R"({{"event":"build","scene":{},"tree":"{}","device":{},"triangles":{},"median_seconds":{},"least_seconds":{},"greatest_seconds":{},"runs":{},"nodes":{},"depth":{},"sah_cost":{:.4f},"ratio_to_sbvh":{},{}}})",
            json_string(scene), tree, json_string(device), triangles, json_number(times.median),
            json_number(times.least), json_number(times.greatest), times.runs, nodes, depth, cost,
            ratio > 0 ? fmt::format("{:.4f}", ratio) : "null", ratios_json(others)));
    }
    reporter.answer(fmt::format(
        "{:11} {:12} {:>8} {:11.3f} {:9.3f} {:>9} {:9} {:5} {:8.3f} {:>7} {:>8} {:>8}\n", scene, tree, triangles,
        times.median * 1e3, times.least * 1e3, fmt::format("{:.1f}", millions_a_second(triangles, times.median)), nodes,
        depth, cost, ratio > 0 ? fmt::format("{:.3f}", ratio) : "-", ratio_cell(others[0]), ratio_cell(others[1])));
}

/// A built tree fitted to its triangles again.
void print_refit(const std::string& scene, const std::string& device, uint64_t triangles, const RunTimes& times,
                 Reporter& reporter) {
    if (reporter.json()) {
        return reporter.event(fmt::format(
            R"({{"event":"refit","scene":{},"tree":"hploc","device":{},"triangles":{},"median_seconds":{},"least_seconds":{},"greatest_seconds":{},"runs":{}}})",
            json_string(scene), json_string(device), triangles, json_number(times.median), json_number(times.least),
            json_number(times.greatest), times.runs));
    }
    reporter.answer(fmt::format("{:11} {:12} {:>8} {:11.3f} {:9.3f} {:>9}\n", scene, "its refit", triangles,
                                times.median * 1e3, times.least * 1e3,
                                fmt::format("{:.1f}", millions_a_second(triangles, times.median))));
}

void bench_scene(const std::string& name, Queue& queue, const BuildFlags& flags, Reporter& reporter) {
    reporter.set_work(fmt::format("{}: reading", name));
    const std::vector<BvhTriangle> triangles = read_triangles(name, reporter.messages());
    reporter.say_messages();
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
            print(name, name_of(builder), "cpu", count, {seconds, seconds, seconds, 1}, bvh.nodes.size(), bvh.depth,
                  bvh.sah_cost, ratio(bvh.sah_cost), reporter);
            throw_if_interrupted();
        }
    }
    reporter.set_work(fmt::format("{}: building on the device", name));
    const Buffer<BvhTriangle> there(queue, std::span(triangles), "triangles to build of");
    DeviceBuilder builder(queue, count);
    const int runs = flags.runs > 0 ? static_cast<int>(flags.runs) : (queue.is_cuda() ? 25 : 3);
    const auto time = [&](const auto& run) {
        return time_runs(queue, queue.is_cuda() ? 3 : 1, runs, run, throw_if_interrupted);
    };
    const RunTimes times = time([&] { builder.start(there.data(), count); });
    const DeviceBuilder::Figures figures = builder.finish();
    print(name, "hploc", queue.device_name(), count, times, figures.nodes, figures.depth, figures.sah_cost,
          ratio(figures.sah_cost), reporter);
    const RunTimes refits = time([&] { builder.start_refit(there.data()); });
    if (builder.finish().bounds != figures.bounds) {
        throw Error(ErrorCode::DeviceFault,
                    fmt::format("{}: a tree fitted to its own triangles has other bounds", name));
    }
    print_refit(name, queue.device_name(), count, refits, reporter);
}

int bench_build(BuildFlags& flags) {
    Reporter reporter(flags.report);
    flags.settings.read(flags, reporter.messages());
    const std::vector<std::string> scenes = check_record_scenes(flags.scenes);
    listen_for_interrupt();
    const std::unique_ptr<Queue> queue = take_machine(flags.machine, reporter.messages());
    reporter.answer(
        fmt::format("{}: from triangles on the device to compressed nodes and triangles there; others on "
                    "the CPU; cost of a ray by\nthe surface area heuristic, and its ratio to the SBVH's; at the "
                    "right, on an {} alone, our rate in\ntimes that of OptiX when it builds for fast tracing and "
                    "for fast building\n"
                    "{:11} {:12} {:>8} {:>11} {:>9} {:>9} {:>9} {:>5} {:>8} {:>7} {:>8} {:>8}\n",
                    queue->device_name(), kFiguresDevice, "scene", "tree", "tri", "ms (median)", "fastest", "Mtri/s",
                    "nodes", "depth", "cost", "of sbvh", "to trace", "to build"));
    for (const std::string& scene : scenes) bench_scene(scene, *queue, flags, reporter);
    return 0;
}

} // namespace

void add_bench_build_command(CLI::App& bench, int& status) {
    CLI::App& verb = *bench.add_subcommand("build", "Trees that are built on the device");
    const auto flags = std::make_shared<BuildFlags>();
    add_record_scenes(verb, flags->scenes);
    add_whole(verb, "--runs", flags->runs, "timed (3 on the CPU, 25 in CUDA)", 1, 10000);
    verb.add_flag("--compare", flags->compare,
                  "build by sbvh, sbvh-reinsertion, reinsertion, binned and\nploc on the CPU too");
    flags->settings.add(verb, kBenchBuild, *flags);
    add_report_flags(verb, flags->report);
    verb.callback([&verb, flags, &status] {
        refuse_flags_before(verb);
        status = bench_build(*flags);
    });
}

} // namespace pertev
