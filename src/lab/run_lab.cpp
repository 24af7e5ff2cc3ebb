#include "lab/run_lab.h"

#include <algorithm>
#include <functional>
#include <map>
#include <new>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/machine_memory.h"
#include "base/stopwatch.h"
#include "device/device_timer.h"
#include "device_scene/place_meshes.h"
#include "lab/in_pieces.h"
#include "lab/list_combinations.h"
#include "lab/measure_rays.h"
#include "lab/traced_set.h"
#include "render/tiled_pixel.h"

namespace pertev {
namespace {

/// The reference traversal. Some of its rays are compared with brute force, so that every other combination can be
/// compared with it on all rays.
constexpr Combination kReference = {.structure = StructureKind::Binned, .traversal = TraversalKind::WhileWhile};

/// Builds the TLAS over instances that have a BLAS, in the file's coordinates, which the ray sets use too.
Tlas tlas_over(const Scene& scene, const BinaryTrees& trees) {
    return build_tlas(placed_trees(scene, place_meshes(scene), trees.blas_bounds()));
}

class Lab {
public:
    Lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings, Sink& sink,
        const std::function<void(const LabReport&)>& save)
        : queue_(queue), scene_(scene), camera_(camera), settings_(settings), sink_(sink), save_(save),
          triangles_{{scene, place_meshes(scene), sink}, {}} {
        report_ = {.scene = settings.scene,
                   .device = queue.device_name(),
                   .camera = settings.camera,
                   .triangles = triangles_.parts.count(),
                   .instances = scene.instances.size(),
                   .width = settings.width,
                   .height = settings.height,
                   .first_depth = settings.first_depth,
                   .runs = settings.runs,
                   .warm_ups = settings.warm_ups};
        if (report_.triangles == 0)
            throw Error(ErrorCode::BadInput, "scene", "", "the scene has no triangles to trace");
    }

    LabReport run() {
        list_structures();
        try {
            make_sets();
            for (const StructureKind structure : structures_) measure_structure(structure);
        } catch (const Error& error) { // the measurements so far are kept
            const bool device_is_lost = error.code() == ErrorCode::DeviceFault && measuring_ != nullptr;
            if (error.code() != ErrorCode::Interrupted && !device_is_lost) throw;
            report_.interrupted = true;
            if (device_is_lost) measuring_->wrong = true, measuring_->refused = error.what();
        }
        if (report_.interrupted) {
            for (CombinationFigures& c : report_.combinations) {
                if ((c.runs.empty() || c.runs.size() < sets_.size()) && c.refused.empty()) {
                    c.refused = c.runs.empty() ? "interrupted before it was measured" : "interrupted";
                }
            }
        }
        return std::move(report_);
    }

private:
    void progress(const std::string& doing, double share_of_step = 0) {
        const double share = std::min(1.0, work_done_ / std::max(work_, 1.0)), seconds = watch_.seconds();
        Progress now = {.doing = doing, .share = share, .seconds = seconds, .share_of_step = share_of_step};
        if (share > 0.01) now.seconds_left = seconds * (1 - share) / share;
        sink_.progress(now);
        sink_.check();
    }
    /// Returns a progress callback for work in pieces. `doing` must outlive it.
    PieceDone progress_of(const std::string& doing) {
        return [this, &doing](double share) { progress(doing, share); };
    }

    void list_structures() {
        report_.combinations = list_combinations(settings_, queue_.is_cuda());
        check_any_can_run(report_.combinations);
        for (const CombinationFigures& c : report_.combinations) {
            work_ += c.refused.empty() ? 1 : 0;
            const StructureKind structure = c.combination.structure;
            if (std::ranges::find(structures_, structure) == structures_.end()) structures_.push_back(structure);
        }
    }

    /// Makes the rays of a frame, traces them by the reference traversal and compares that with brute force.
    void make_sets() {
        progress("building the tree of the reference traversal");
        const BinaryTrees binary = build_binary_trees(triangles_.parts, BvhBuilder::Binned, sink_);
        triangles_.tlas = tlas_over(scene_, binary);
        const Tracer reference = tracer_over(kReference, binary);
        const BruteForce oracle(queue_, triangles_.parts, triangles_.tlas);
        with_memory_for_rays([&] { trace_sets(reference, oracle); });
    }

    Tracer tracer_over(const Combination& combination, const BinaryTrees& trees) {
        const auto built = std::make_shared<const BuiltStructure>(triangles_.tlas, combination.structure,
                                                                  layout_of(combination), trees, nullptr, sink_);
        return {queue_, combination, built};
    }

    void trace_sets(const Tracer& reference, const BruteForce& oracle) {
        std::vector<RaySet> sets = make_rays(reference);
        const bool record = settings_.record_rays > 0;
        int depth = 0;
        std::string parent; // the set whose hits are the next set's origins
        for (RaySet& set : sets) {
            if (!set.any_hit) ++depth;
            const bool wanted = set.any_hit ? settings_.shadow : depth == 1 ? settings_.primary : settings_.diffuse;
            if (wanted || record) {
                if (set.rays.empty()) {
                    report_.notes.push_back(
                        fmt::format("{}: there are no rays, because none of {} hits the scene", set.name, parent));
                } else {
                    // The record's sets are not part of a frame.
                    add_set(set, reference, oracle, set.any_hit || record ? 0 : depth);
                }
            }
            if (!set.any_hit && !set.rays.empty()) parent = set.name;
            set.rays = {}; // the rays that are needed are on the device
        }
        if (sets_.empty()) {
            if (settings_.depth == 1 && settings_.diffuse && !settings_.primary) {
                throw Error(ErrorCode::BadInput, "depths", "1",
                            "diffuse rays are the second rays of paths and need a depth of at least 2");
            }
            throw Error(ErrorCode::BadInput, "camera", "",
                        "none of the camera's rays hits the scene, so there are no diffuse or shadow rays");
        }
    }

    void add_set(const RaySet& set, const Tracer& reference, const BruteForce& oracle, int depth) {
        const std::string checking = fmt::format("{}: comparing the reference traversal with brute force", set.name);
        progress(checking);
        const uint64_t checked = check_reference_traversal(queue_, set, reference, oracle, triangles_, kOracleRays,
                                                           kOracleStressRays, progress_of(checking));
        const std::string tracing = fmt::format("{}: tracing by the reference traversal", set.name);
        sets_.push_back(trace_set(queue_, set, reference, progress_of(tracing)));
        sets_.back().figures.brute_force_rays = checked;
        sets_.back().figures.depth = depth;
        report_.sets.push_back(sets_.back().figures);
    }

    std::vector<RaySet> make_rays(const Tracer& reference) {
        progress("making rays");
        const RaySetJob job = {scene_, camera_, settings_.width, settings_.height, ray_tracer(reference)};
        return settings_.record_rays > 0 ? make_record_ray_sets(job, settings_.record_rays)
                                         : make_frame_ray_sets(job, settings_.depth - 1);
    }

    /// Runs f; an error of exhausted memory says what it was for. Throws Error(OutOfMemory) before that if not even the
    /// camera rays and their hits fit.
    template <class F>
    void with_memory_for_rays(const F& f) const {
        const bool record = settings_.record_rays > 0;
        const uint64_t rays = record ? settings_.record_rays : uint64_t(settings_.width) * settings_.height;
        const uint64_t bytes = rays * (sizeof(Ray) + sizeof(RayHit));
        const int sets = record ? 5 : settings_.depth + 1;
        const auto complain = [&](const std::string& what) {
            return Error(ErrorCode::OutOfMemory, record ? "count" : "size", "",
                         fmt::format("out of memory{}: {} rays and their hits take {:.1f} GiB per set, for up to {} "
                                     "sets, and this machine has {:.1f} GiB; a smaller value gives fewer rays",
                                     what, rays, gibibytes(bytes), sets, gibibytes(machine_memory_bytes())));
        };
        if (bytes > machine_memory_bytes()) throw complain("");
        try {
            f();
        } catch (const std::bad_alloc&) {
            throw complain("");
        } catch (const Error& error) {
            if (error.code() != ErrorCode::OutOfMemory) throw;
            throw complain(fmt::format(" ({})", error.what()));
        }
    }

    uint64_t pixels() const { return uint64_t(settings_.width) * settings_.height; }

    /// Traces by the reference traversal, in pieces.
    RayTracer ray_tracer(const Tracer& reference) {
        return [this, trace = make_ray_tracer(queue_, reference)](std::span<const Ray> rays, std::span<RayHit> hits) {
            const auto piece = [&](uint64_t begin, uint64_t count) {
                trace(rays.subspan(begin, count), hits.subspan(begin, count));
            };
            in_pieces(rays.size(), first_piece_of_rays(), piece, [this](double) { progress("making rays"); });
        };
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
        for (CombinationFigures* c : combinations_of(structure)) of_layout[layout_of(c->combination)].push_back(c);
        if (of_layout.empty()) return;
        std::optional<BinaryTrees> binary;
        for (const auto& entry : of_layout) {
            const TreeLayout layout = entry.first;
            const std::vector<CombinationFigures*>& combinations = entry.second;
            const uint32_t at = static_cast<uint32_t>(report_.structures.size());
            const std::string failed = unless_memory_lacks([&] {
                progress(fmt::format("building {}", name_of(structure)));
                const auto builder = builder_of(structure);
                if (builder && !binary) {
                    binary = build_binary_trees(triangles_.parts, *builder, sink_);
                    progress(fmt::format("converting {}", name_of(structure)));
                }
                const Tlas& tlas = triangles_.tlas;
                const auto on_host =
                    builder ? std::make_shared<const BuiltStructure>(tlas, structure, layout, *binary, nullptr, sink_)
                            : std::make_shared<const BuiltStructure>(tlas, structure, triangles_.parts, nullptr, sink_);
                const auto built = std::make_shared<const StructureOnDevice>(queue_, on_host);
                report_.structures.push_back(on_host->figures());
                for (CombinationFigures* c : combinations) {
                    c->structure = at;
                    const std::string lacks =
                        unless_memory_lacks([&] { measure(*c, Tracer(queue_, c->combination, built)); });
                    if (!lacks.empty()) c->refused = lacks;
                }
            });
            if (failed.empty()) continue;
            report_.structures.push_back({.name = std::string(name_of(structure)), .failed = failed});
            for (CombinationFigures* c : combinations) c->structure = at, c->refused = failed;
        }
        if (save_) save_(report_);
        progress("measured " + std::string(name_of(structure)));
    }

    /// Runs f and returns its message if memory or another limit did not suffice, else nothing.
    template <class F>
    std::string unless_memory_lacks(const F& f) {
        try {
            f();
            return {};
        } catch (const Error& error) {
            if (error.code() != ErrorCode::OutOfMemory && error.code() != ErrorCode::OverLimit) throw;
            return error.what();
        } catch (const std::bad_alloc&) {
            return "the tables do not fit into this machine's memory";
        }
    }

    void measure(CombinationFigures& c, const Tracer& tracer) {
        measuring_ = &c;
        for (uint32_t k = 0; k < sets_.size(); ++k) {
            const TracedSet& set = sets_[k];
            const std::string doing = fmt::format("{}: {}", c.name, set.figures.name);
            progress(doing);
            if (const RunFigures* same = same_run(c, k)) {
                c.runs.push_back(*same);
                c.runs.back().is_copy = true;
            } else {
                RunFigures run = {.set = k};
                if (!check(c, set, tracer, doing, run)) return c.runs.clear();
                if (settings_.runs > 0) {
                    time(set, tracer, doing, run);
                    count(c, set, tracer, doing, run);
                    if (!set.figures.any_hit) take_limits(c, tracer);
                }
                c.runs.push_back(run);
            }
            work_done_ += 1 / static_cast<double>(sets_.size());
        }
    }

    /// Returns the figures of an identical combination that was measured, or null: any-hit traversals with and without
    /// RTA are identical, because there is no nearest hit to use.
    const RunFigures* same_run(const CombinationFigures& c, uint32_t set) const {
        if (!sets_[set].figures.any_hit) return nullptr;
        for (const auto& [rta, at_pops] : {std::pair(true, true), std::pair(true, false), std::pair(false, true)}) {
            Combination other = c.combination;
            other.options.rta = rta, other.options.rta_at_pops = at_pops;
            const std::string name = name_of(other);
            const auto at = std::ranges::find_if(report_.combinations, [&](const auto& o) { return o.name == name; });
            if (at == report_.combinations.end() || &*at == &c) continue;
            if (const RunFigures* run = find_run(*at, set)) return run;
        }
        return nullptr;
    }

    static void take_limits(CombinationFigures& c, const Tracer& tracer) {
        const auto limits = tracer.limits();
        if (!limits) return;
        c.registers = limits->registers, c.local_bytes = limits->local_bytes;
        c.occupancy = static_cast<double>(limits->occupancy);
    }

    static uint32_t count_of(const TracedSet& set) { return static_cast<uint32_t>(set.rays.size()); }
    /// Runs work over the set: at once on a GPU, as in the timed runs; in pieces on a CPU, where it may take an hour.
    template <class Work>
    void over_set(const TracedSet& set, const std::string& doing, const Work& work) {
        if (queue_.is_cuda()) {
            work(0, set.rays.size());
        } else {
            in_pieces(set.rays.size(), first_piece_of_rays(), work, progress_of(doing));
        }
    }

    /// Compares a combination with the reference traversal. Returns false if they differ; the combination then has no
    /// figures.
    bool check(CombinationFigures& c, const TracedSet& set, const Tracer& tracer, const std::string& doing,
               RunFigures& run) {
        HitsOnDevice hits(queue_, set.rays.size());
        hits.spoil(); // so that a ray that is not traced cannot have a right result
        over_set(set, doing, [&](uint64_t begin, uint64_t count) {
            trace(tracer, set.figures.any_hit, set.rays.data() + begin, static_cast<uint32_t>(count), hits.from(begin));
        });
        run.different =
            count_different(hits.download(set.figures.any_hit), set.wanted, c.combination.options.is_exact());
        if (run.different == 0 || !c.combination.options.is_exact()) return true;
        c.wrong = true;
        c.refused = fmt::format("WRONG: {} of {} {} rays differ from the reference traversal; please report this",
                                run.different, set.rays.size(), set.figures.name);
        return false;
    }

    void time(const TracedSet& set, const Tracer& tracer, const std::string& doing, RunFigures& run) {
        const HitsOnDevice hits(queue_, set.rays.size());
        const auto trace_set = [&] {
            trace(tracer, set.figures.any_hit, set.rays.data(), count_of(set), hits.from(0));
        };
        const RunTimes times =
            time_runs(queue_, settings_.warm_ups, settings_.runs, trace_set, [&] { progress(doing); });
        run.median_s = times.median, run.min_s = times.least, run.largest_s = times.greatest;
    }

    void count(const CombinationFigures& c, const TracedSet& set, const Tracer& tracer, const std::string& doing,
               RunFigures& run) {
        const Buffer<RayWork> on_device(queue_, set.rays.size(), "ray work");
        bool counted = true;
        over_set(set, doing, [&](uint64_t begin, uint64_t count) {
            counted = tracer.count_work(set.figures.any_hit, all_candidates(set.rays.data() + begin),
                                        static_cast<uint32_t>(count), on_device.data() + begin);
        });
        if (counted) {
            const std::vector<RayWork> work = on_device.download();
            const WorkSummary summary = summarize_work(work);
            run.nodes = summary.nodes, run.triangles = summary.triangles;
            if (wants_heat_map(c, set)) add_heat_map(c, set, run, work);
        }
        const auto lanes = tracer.count_lanes(set.figures.any_hit, all_candidates(set.rays.data()), count_of(set));
        if (lanes) take_lanes(*lanes, run);
    }

    static void take_lanes(const LaneCounts& counts, RunFigures& run) {
        const auto ratio = [](uint64_t a, uint64_t b) {
            return b > 0 ? std::optional(static_cast<double>(a) / static_cast<double>(b)) : std::nullopt;
        };
        run.node_lanes = ratio(counts.node_lanes, counts.node_steps);
        run.triangle_lanes = ratio(counts.triangle_lanes, counts.triangle_steps);
        run.node_sectors = ratio(counts.node_sectors, counts.node_requests);
        run.triangle_sectors = ratio(counts.triangle_sectors, counts.triangle_requests);
    }

    /// Returns whether to make a heat map: one per structure and traversal, from the first combination, which has the
    /// most options on.
    bool wants_heat_map(const CombinationFigures& c, const TracedSet& set) const {
        const auto is_same = [&](const Combination& other) {
            return other.structure == c.combination.structure && other.traversal == c.combination.traversal;
        };
        return settings_.heat_maps && set.figures.name == kCameraSet && set.rays.size() >= pixels() &&
               std::ranges::none_of(mapped_, is_same);
    }

    /// Adds the heat map while it belongs to the fastest.
    void add_heat_map(const CombinationFigures& c, const TracedSet& set, const RunFigures& run,
                      const std::vector<RayWork>& work) {
        mapped_.push_back(c.combination);
        HeatMap map = {.name = c.name, .width = settings_.width, .height = settings_.height};
        map.rays_per_second = static_cast<double>(set.rays.size()) / run.median_s;
        map.nodes.resize(pixels()), map.triangles.resize(pixels());
        for (uint32_t i = 0; i < pixels(); ++i) { // rays are in tile order; only the first frame is drawn
            const uint32_t pixel = tiled_pixel(i, settings_.width, settings_.height);
            map.nodes[pixel] = work[i].nodes, map.triangles[pixel] = work[i].triangles;
        }
        auto& kept = report_.heat_maps;
        kept.insert(std::ranges::upper_bound(kept, map.rays_per_second, std::greater{}, &HeatMap::rays_per_second),
                    std::move(map));
        kept.resize(std::min(kept.size(), kHeatMapsKept));
    }

    Queue& queue_;
    const Scene& scene_;
    const Camera& camera_;
    const LabSettings& settings_;
    Sink& sink_;
    const std::function<void(const LabReport&)>& save_;
    LabTriangles triangles_;
    std::vector<StructureKind> structures_;
    std::vector<TracedSet> sets_;
    LabReport report_;
    Stopwatch watch_;
    CombinationFigures* measuring_ = nullptr;
    std::vector<Combination> mapped_; // combinations that have a heat map
    double work_ = 0, work_done_ = 0; // number of combinations, and how many are finished
};

} // namespace

LabReport run_lab(Queue& queue, const Scene& scene, const Camera& camera, const LabSettings& settings, Sink& sink,
                  const std::function<void(const LabReport&)>& save) {
    return Lab(queue, scene, camera, settings, sink, save).run();
}

} // namespace pertev
