#include "lab/run_lab.h"

#include <algorithm>
#include <map>
#include <new>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/version.h"
#include "device/device_timer.h"
#include "lab/traced_set.h"
#include "lab/walk_kernels.h"
#include "render/tiled_pixel.h"

namespace pertev {
namespace {

/// Thrown when keep_going says no; what has been measured is kept.
struct Stopped {};

bool is_binary(StructureKind kind) {
    return kind != StructureKind::KdMedian && kind != StructureKind::KdSah && kind != StructureKind::Octree;
}

class Lab {
public:
    Lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings,
        const std::function<bool(const LabProgress&)>& keep_going)
        : queue_(queue), scene_(scene), camera_(camera), settings_(settings), keep_going_(keep_going),
          triangles_(scene), pool_(queue, 1, "ray pool") {
        report_ = {.device = queue.device_name(),
                   .commit = fmt::format("{} {}", version(), git_commit()),
                   .triangles = triangles_.count(),
                   .instances = scene.instances.size(),
                   .width = settings.width,
                   .height = settings.height,
                   .first_depth = settings.first_depth,
                   .runs = settings.runs,
                   .warm_ups = settings.warm_ups};
        if (report_.triangles == 0) throw Error(ErrorCode::BadInput, "the scene has no triangles: nothing to trace");
    }

    LabReport run() {
        list_combinations();
        try {
            make_sets();
            for (const StructureKind structure : structures_) measure_structure(structure);
        } catch (const Stopped&) {
            report_.interrupted = true;
            for (CombinationFigures& c : report_.combinations) {
                if (c.runs.empty() && c.refused.empty()) c.refused = "interrupted before its turn";
            }
        }
        drop_doubtful_structures();
        return std::move(report_);
    }

private:
    void progress(const std::string& doing) {
        const double share = std::min(1.0, work_done_ / std::max(work_, 1.0));
        if (keep_going_ && !keep_going_({share, doing, watch_.seconds()})) throw Stopped{};
    }

    void add_combination(const Combination& c) {
        CombinationFigures figures = {.combination = c, .name = name_of(c)};
        const LabMachine machine = {queue_.is_cuda(), !triangles_.top_level.instances.empty()};
        if (const auto reason = why_not(c, machine)) {
            figures.refused = *reason;
        } else if (find_kernel(c, false, queue_.is_cuda()) == nullptr) {
            figures.refused = c.options.exact ? "not compiled" : "fast tests are compiled with rta and near alone";
        } else {
            work_ += 1;
        }
        report_.combinations.push_back(std::move(figures));
    }

    void list_combinations() {
        for (const Combination& c : settings_.only) {
            add_combination(c);
            if (std::ranges::find(structures_, c.structure) == structures_.end()) structures_.push_back(c.structure);
        }
        if (!settings_.only.empty()) return;
        structures_ = settings_.structures;
        for (const StructureKind structure : settings_.structures) {
            for (const WalkKind walk : settings_.walks) {
                if (!settings_.by_name && why_not(structure, walk)) continue;
                for (const Distribution distribution : settings_.distributions) {
                    for (const WalkOptions& options : settings_.options) {
                        add_combination({structure, walk, options, distribution});
                    }
                }
            }
        }
    }

    /// The rays of a frame, and what the proven walk finds, which is held against brute force here.
    void make_sets() {
        progress("building the tree of the proven walk");
        const BinaryTrees binary = build_binary_trees(triangles_, StructureKind::Binned);
        const BuiltStructure built(queue_, triangles_, StructureKind::Binned, TreeLayout::Binary, &binary);
        const auto& proven = std::get<SceneBvhView>(built.trees());
        progress("making rays");
        const int bounces = settings_.depth - 1;
        const RaySetJob job = {scene_, camera_, settings_.width, settings_.height, make_ray_tracer(queue_, proven)};
        const bool record = settings_.record_rays > 0;
        const std::vector<RaySet> sets =
            record ? make_record_ray_sets(job, settings_.record_rays) : make_frame_ray_sets(job, bounces);
        const BruteForce oracle(queue_, triangles_);
        int depth = 0;
        for (const RaySet& set : sets) {
            if (!set.any_hit) ++depth;
            const bool wanted = set.any_hit ? settings_.shadow : depth == 1 ? settings_.primary : settings_.diffuse;
            if (!(wanted || record) || set.rays.empty()) continue;
            progress(fmt::format("{}: the proven walk against brute force", set.name));
            sets_.push_back(trace_set(queue_, set, proven, oracle, triangles_, kOracleRays, kOracleNastyRays));
            sets_.back().figures.depth = set.any_hit || record ? 0 : depth; // frames are not of the record
            report_.sets.push_back(sets_.back().figures);
        }
        if (sets_.empty()) throw Error(ErrorCode::BadInput, "none of the rays asked for meets the scene");
    }

    std::vector<CombinationFigures*> combinations_of(StructureKind structure) {
        std::vector<CombinationFigures*> of;
        for (CombinationFigures& c : report_.combinations) {
            if (c.combination.structure == structure && c.refused.empty()) of.push_back(&c);
        }
        return of;
    }

    void measure_structure(StructureKind structure) {
        std::map<TreeLayout, std::vector<CombinationFigures*>> of_layout;
        for (CombinationFigures* c : combinations_of(structure)) of_layout[layout_of(c->combination.walk)].push_back(c);
        if (of_layout.empty()) return;
        std::optional<BinaryTrees> binary;
        for (const auto& [layout, combinations] : of_layout) {
            try {
                progress(fmt::format("building {}", name_of(structure)));
                if (is_binary(structure) && !binary) binary = build_binary_trees(triangles_, structure);
                const BuiltStructure built(queue_, triangles_, structure, layout, binary ? &*binary : nullptr);
                report_.structures.push_back(built.figures());
                for (CombinationFigures* c : combinations) {
                    c->structure = static_cast<uint32_t>(report_.structures.size() - 1);
                    measure(*c, built);
                }
            } catch (const Error& error) {
                if (error.code() != ErrorCode::OutOfMemory && error.code() != ErrorCode::OverLimit) throw;
                refuse(combinations, structure, error.what());
            } catch (const std::bad_alloc&) {
                refuse(combinations, structure, "does not fit into this machine's memory");
            }
        }
    }

    void refuse(const std::vector<CombinationFigures*>& combinations, StructureKind structure, const std::string& why) {
        report_.structures.push_back({.name = name_of(structure), .failed = why});
        for (CombinationFigures* c : combinations) {
            c->structure = static_cast<uint32_t>(report_.structures.size() - 1);
            if (c->runs.empty()) c->refused = why;
        }
    }

    void measure(CombinationFigures& c, const BuiltStructure& built) {
        std::vector<RunFigures> runs;
        for (uint32_t k = 0; k < sets_.size(); ++k) {
            const TracedSet& set = sets_[k];
            progress(fmt::format("{}: {}", c.name, set.figures.name));
            const WalkKernel* kernel = find_kernel(c.combination, set.figures.any_hit, queue_.is_cuda());
            if (kernel == nullptr) continue; // closest hits alone
            RunFigures run = {.set = k};
            if (!check(c, set, *kernel, built, run)) return;
            if (settings_.runs > 0) {
                time(set, *kernel, built, run);
                count(c, set, built, run);
            }
            if (!set.figures.any_hit && kernel->limits != nullptr && queue_.is_cuda()) {
                const KernelLimits limits = kernel->limits();
                c.registers = limits.registers, c.occupancy = static_cast<double>(limits.occupancy);
            }
            runs.push_back(run);
            work_done_ += 1 / static_cast<double>(sets_.size());
        }
        c.runs = std::move(runs);
    }

    RayBatch batch_of(const TracedSet& set) const {
        return {set.rays.data(), static_cast<uint32_t>(set.rays.size()), pool_.data()};
    }

    /// False when the combination differs from the proven walk: it has no figures then.
    bool check(CombinationFigures& c, const TracedSet& set, const WalkKernel& kernel, const BuiltStructure& built,
               RunFigures& run) {
        Buffer<RayHit> hits(queue_, set.rays.size(), "hits");
        hits.zero(); // a ray that was forgotten must not find an old result
        kernel.trace(queue_, built.trees(), batch_of(set), hits.data());
        std::vector<RayHit> copy;
        run.different = count_different(hits.read(copy), set.wanted);
        if (run.different == 0 || !c.combination.options.exact) return true;
        c.refused = fmt::format("WRONG: {} of {} {} rays differ from the proven walk; please report it", run.different,
                                set.rays.size(), set.figures.name);
        return false;
    }

    void time(const TracedSet& set, const WalkKernel& kernel, const BuiltStructure& built, RunFigures& run) {
        const Buffer<RayHit> hits(queue_, set.rays.size(), "hits");
        const RunTimes times = time_runs(queue_, settings_.warm_ups, settings_.runs,
                                         [&] { kernel.trace(queue_, built.trees(), batch_of(set), hits.data()); });
        run.median_s = times.median, run.least_s = times.least, run.largest_s = times.greatest;
    }

    void count(const CombinationFigures& c, const TracedSet& set, const BuiltStructure& built, RunFigures& run) {
        Combination plain = c.combination; // what a ray tests does not depend on how it came to its thread
        if (const WalkKernel* own = find_kernel(plain, set.figures.any_hit, queue_.is_cuda()); own->count == nullptr) {
            plain.distribution = Distribution::OneAThread;
        }
        const WalkKernel* kernel = find_kernel(plain, set.figures.any_hit, queue_.is_cuda());
        const double rays = static_cast<double>(set.rays.size());
        if (kernel != nullptr && kernel->count != nullptr) {
            const Buffer<RayWork> on_device(queue_, set.rays.size(), "ray work");
            kernel->count(queue_, built.trees(), batch_of(set), on_device.data());
            const std::vector<RayWork> work = on_device.download();
            uint64_t nodes = 0, triangles = 0;
            for (const RayWork& w : work) nodes += w.nodes, triangles += w.triangles;
            run.nodes = static_cast<double>(nodes) / rays, run.triangles = static_cast<double>(triangles) / rays;
            if (settings_.heat_maps && set.figures.depth == 1) add_heat_map(c, work);
        }
        kernel = find_kernel(c.combination, set.figures.any_hit, queue_.is_cuda());
        if (!queue_.is_cuda() || kernel->count_lanes == nullptr) return;
        Buffer<LaneCounts> on_device(queue_, 1, "lane counts");
        on_device.zero();
        kernel->count_lanes(queue_, built.trees(), batch_of(set), on_device.data());
        const LaneCounts work = on_device.download().front();
        const auto ratio = [](uint64_t a, uint64_t b) {
            return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0.0;
        };
        run.node_lanes = ratio(work.node_lanes, work.node_steps);
        run.triangle_lanes = ratio(work.triangle_lanes, work.triangle_steps);
        run.sectors = ratio(work.node_sectors, work.node_requests);
    }

    /// One for each structure and walk, with all its switches on.
    void add_heat_map(const CombinationFigures& c, const std::vector<RayWork>& work) {
        const WalkOptions& o = c.combination.options;
        const bool plain = o.rta && (o.near_first || !find_kernel_with_order(c.combination)) && o.exact &&
                           c.combination.distribution == Distribution::OneAThread;
        if (!plain || work.size() != std::size_t(settings_.width) * settings_.height) return;
        HeatMap map = {c.name, settings_.width, settings_.height, {}, {}};
        map.nodes.resize(work.size()), map.triangles.resize(work.size());
        for (uint32_t i = 0; i < work.size(); ++i) { // rays are in the order of tiles
            const uint32_t pixel = tiled_pixel(i, settings_.width, settings_.height);
            map.nodes[pixel] = work[i].nodes, map.triangles[pixel] = work[i].triangles;
        }
        report_.heat_maps.push_back(std::move(map));
    }
    bool find_kernel_with_order(Combination c) const {
        c.options.near_first = true;
        return find_kernel(c, false, queue_.is_cuda()) != nullptr;
    }

    /// Combinations that never came to their turn name no structure.
    void drop_doubtful_structures() {
        if (report_.structures.empty()) report_.structures.push_back({.name = "none", .failed = "nothing was built"});
    }

    Queue& queue_;
    const Scene& scene_;
    const Camera& camera_;
    const LabSettings& settings_;
    const std::function<bool(const LabProgress&)>& keep_going_;
    LabTriangles triangles_;
    Buffer<uint32_t> pool_;
    std::vector<StructureKind> structures_;
    std::vector<TracedSet> sets_;
    LabReport report_;
    Stopwatch watch_;
    double work_ = 0, work_done_ = 0; // combinations
};

} // namespace

LabReport run_lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings,
                  const std::function<bool(const LabProgress&)>& keep_going) {
    return Lab(queue, scene, camera, settings, keep_going).run();
}

} // namespace pertev
