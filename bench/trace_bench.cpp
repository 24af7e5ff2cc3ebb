// trace_bench: compares the CPU traversal of pictures with Embree on one thread, in one run. The ray sets are those of
// the record (docs/ray_sets.md) and "sun", shadow rays from the same points to one far light. Rays come in chunks, and
// all tracers take each chunk in turn, so that other work on the machine slows all of them alike.

#if PERTEV_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/picture_rays.h"
#include "lab/measurement.h"
#include "lab/ray_sets.h"
#include "lab/record_scenes.h"
#include "render/prepare_scene.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/traverse_wide.h"

using namespace pertev;

namespace {

constexpr std::size_t kChunk = 1 << 16; // long enough for a tracer to bring its tree back into the cache

/// CPU time of this thread.
template <class F>
double seconds_of(const F& f) {
    const auto now_s = [] {
        timespec t;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double start = now_s();
    f();
    return now_s() - start;
}

/// Traces a chunk and returns the seconds that it took.
using Trace = std::function<double(std::span<const Ray>)>;

Hit trace_one(const HostTrees& trees, const Ray& ray, bool any_hit) {
    Hit hit;
    if (any_hit) {
        hit.instance = trace_any<Wide8SimdTraversal<kAny>>(trees, ray, AcceptAll{}) ? 0 : kNoHit;
    } else {
        trace_closest<Wide8SimdTraversal<kClosest>>(trees, ray, AcceptAll{}, hit);
    }
    return hit;
}

Trace single(const HostTrees& trees, bool any_hit) {
    return [&trees, any_hit](std::span<const Ray> rays) {
        std::vector<Hit> hits(rays.size());
        return seconds_of([&] {
            for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = trace_one(trees, rays[i], any_hit);
        });
    };
}

Trace as_pictures(const HostTrees& trees, bool any_hit, RayOrder order) {
    return [&trees, any_hit, order](std::span<const Ray> rays) {
        std::vector<Hit> hits(rays.size());
        const auto found = std::make_unique<bool[]>(rays.size());
        return seconds_of([&] { trace_as_pictures(trees, {rays, order, any_hit, hits.data(), found.get()}); });
    };
}

/// One mesh in a tree of high quality.
class Embree {
public:
    Embree(const Mesh& mesh, bool robust) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        std::ranges::copy(mesh.positions, static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX,
                                                                                     0, RTC_FORMAT_FLOAT3, sizeof(Vec3),
                                                                                     mesh.positions.size())));
        std::ranges::copy(mesh.indices, static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
                                            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t),
                                            mesh.indices.size() / 3)));
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcSetSceneFlags(scene_, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
        rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
        rtcCommitScene(scene_);
    }
    ~Embree() {
        rtcReleaseScene(scene_);
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    /// `stream`: rays per call, of which Embree 4 takes only 1.
    Trace trace(bool any_hit, bool is_coherent, unsigned stream) const {
        return [=, this](std::span<const Ray> rays) {
            std::vector<RTCRayHit> list;
            for (const Ray& r : rays) {
                RTCRayHit& to = list.emplace_back();
                to.ray = {r.origin.x, r.origin.y, r.origin.z, r.t_min, r.direction.x, r.direction.y, r.direction.z, 0,
                          r.t_max,    ~0u,        0,          0};
                to.hit.geomID = to.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            }
            return seconds_of([&] { trace_all(list, any_hit, is_coherent, stream); });
        };
    }

private:
    void trace_all(std::vector<RTCRayHit>& list, bool any_hit, bool is_coherent, unsigned stream) const {
#if PERTEV_EMBREE == 4
        static_cast<void>(stream);
        RTCIntersectArguments closest;
        RTCOccludedArguments any;
        rtcInitIntersectArguments(&closest);
        rtcInitOccludedArguments(&any);
        closest.flags = any.flags = is_coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
        for (RTCRayHit& r : list) any_hit ? rtcOccluded1(scene_, &r.ray, &any) : rtcIntersect1(scene_, &r, &closest);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        for (std::size_t i = 0; i < list.size(); i += stream) {
            const auto count = static_cast<unsigned>(std::min<std::size_t>(stream, list.size() - i));
            if (stream == 1) {
                any_hit ? rtcOccluded1(scene_, &context, &list[i].ray) : rtcIntersect1(scene_, &context, &list[i]);
            } else if (any_hit) {
                rtcOccluded1M(scene_, &context, &list[i].ray, count, sizeof(RTCRayHit));
            } else {
                rtcIntersect1M(scene_, &context, &list[i], count, sizeof(RTCRayHit));
            }
        }
#endif
    }

    RTCDevice device_;
    RTCScene scene_;
};

struct Flags {
    std::string scene = "sponza", folder, build = std::string(name_of(kDefaultBuild));
    uint32_t rays = 1 << 20;
    int rounds = 3;
    bool json = false;
};

/// Seconds that a tracer took for each chunk of each round.
using Times = std::vector<double>;

/// The median of the chunks' ratios: how many times as fast `ours` is.
double ratio(const Times& ours, const Times& theirs) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < ours.size(); ++i) ratios.push_back(theirs[i] / ours[i]);
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::ranges::nth_element(ratios, middle);
    return *middle;
}

Fields measure(const HostTrees& trees, const Embree& robust, const Embree& fast, const RaySet& set, int rounds) {
    const bool is_coherent = set.name == "primary" || set.name == "sun", any = set.any_hit;
    const bool is_bounce = !any && set.name != "primary";
    const Trace tracers[] = {single(trees, any),
                             as_pictures(trees, any, is_bounce ? RayOrder::Scattered : RayOrder::Together),
                             robust.trace(any, is_coherent, 1), fast.trace(any, is_coherent, 1),
                             robust.trace(any, is_coherent, 256)}; // 64 to 4096 are equally fast within 5 %
    Times times[std::size(tracers)];
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t first = 0; first < set.rays.size(); first += kChunk) {
            const auto chunk = std::span(set.rays).subspan(first, std::min(kChunk, set.rays.size() - first));
            for (std::size_t i = 0; i < std::size(tracers); ++i) times[i].push_back(tracers[i](chunk));
        }
    }
    const auto mrays = [&](const Times& of) {
        double seconds = 0;
        for (const double chunk : of) seconds += chunk;
        return static_cast<double>(set.rays.size()) * rounds / seconds * 1e-6;
    };
    const auto hits =
        std::ranges::count_if(set.rays, [&](const Ray& ray) { return trace_one(trees, ray, any).instance != kNoHit; });
    const auto& [one, many, robust_times, fast_times, streams] = times;
    return {{"rays", "rays", set.name},
            {"hit_share", "hits", static_cast<double>(hits) / static_cast<double>(set.rays.size()), "", "{:.3f}"},
            {"one_ray_at_a_time_mrays_s", "one ray at a time", mrays(one), "Mrays/s", "{:.2f}"},
            {"to_robust", "to robust", ratio(one, robust_times), "", "{:.2f}"},
            {"to_fast", "to fast", ratio(one, fast_times), "", "{:.2f}"},
            {"as_pictures_do_mrays_s", "as pictures do", mrays(many), "Mrays/s", "{:.2f}"},
            {"to_robust_2", "to robust", ratio(many, robust_times), "", "{:.2f}"},
            {"to_fast_2", "to fast", ratio(many, fast_times), "", "{:.2f}"},
            {"to_robust_streams", "to robust streams", ratio(many, streams), "", "{:.2f}"}};
}

/// Shadow rays to a sun, from the same points as those of the record.
RaySet make_sun(const RaySet& shadow) {
    RaySet sun = {"sun", true, shadow.rays};
    for (Ray& ray : sun.rays) {
        ray.direction = normalize(Vec3{0.25f, 1.0f, 0.1f});
        ray.t_max = kInfinity;
    }
    return sun;
}

void run_bench(const Flags& flags) {
    Messages messages;
    const RecordScene* const record = find_named(the_record().scenes, flags.scene);
    const std::optional<TreeBuild> build = value_named<TreeBuild>(flags.build);
    if (record == nullptr || !build) throw Error(ErrorCode::BadInput, "trace_bench: no such scene, or no such build");
    const Scene scene = make_record_scene(*record, flags.folder, messages);
    const TracerChoice tracers = default_tracers(false, *build);
    const PreparedScene prepared = prepare_scene(scene, {.tracers = tracers, .keep_coordinates = true}, messages);
    const auto structure = prepared.structures->get(tracers.bounce);
    const HostTrees& trees = std::get<HostTrees>(structure->trees());
    const Embree robust(scene.meshes.front(), true), fast(scene.meshes.front(), false);
    const FrameSize frame = record_frame(flags.rays);
    const auto trace = [&](std::span<const Ray> rays, std::span<RayHit> hits) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit hit = trace_one(trees, rays[i], false);
            hits[i] = {hit.t, hit.instance, hit.primitive};
        }
    };
    std::vector<RaySet> sets =
        make_record_ray_sets({scene, record_camera(*record), frame.width, frame.height, trace}, flags.rays);
    sets.insert(sets.begin() + 2, make_sun(sets[1]));
    Measurement measured = start_measurement(Queue::make_cpu(), "One CPU thread against Embree");
    measured.tables = {{flags.scene, flags.scene + ", " + flags.build + " tree"}};
    for (const RaySet& set : sets) measured.tables[0].add(measure(trees, robust, fast, set, flags.rounds));
    std::puts(flags.json ? json_of(measured).c_str() : text_of(measured.tables[0]).c_str());
}

} // namespace

int main(int argc, char** argv) {
    Flags flags;
    const char* const folder = std::getenv("PERTEV_SCENES");
    if (folder != nullptr) flags.folder = folder;
    CLI::App app("trace_bench: rays of one thread beside Embree's");
    app.add_option("scene", flags.scene, "a scene of the record: sponza, bunny or forest");
    app.add_option("--scenes", flags.folder, "folder of the public scenes (PERTEV_SCENES)");
    app.add_option("--build", flags.build, "quality of the tree: fast, balanced or best");
    app.add_option("--rays", flags.rays, "number of rays per set");
    app.add_option("--rounds", flags.rounds, "number of rounds over all chunks");
    app.add_flag("--json", flags.json, "print the measurement as JSON");
    CLI11_PARSE(app, argc, argv);
    try {
        run_bench(flags);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
