// trace_bench: the traversal that pictures on a CPU take, in the trees that they take, beside Embree's in the same run,
// on one thread. Kinds of rays are those of the record (docs/ray_sets.md) and "sun", first shadow rays to one far
// light.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/embree_peer.h"
#include "bench/ray_contest.h"
#include "lab/ray_sets.h"
#include "lab/record_scenes.h"
#include "render/prepare_scene.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/traverse_wide.h"

using namespace pertev;
using namespace pertev::bench;

namespace {

struct Flags {
    std::string scene = "sponza", folder, build = std::string(name_of(kDefaultBuild));
    uint32_t rays = 1 << 20;
    int rounds = 3;
    bool json = false;
};

struct Work {
    double nodes = 0, triangles = 0; // a ray
};

constexpr TraversalOptions kClosest = {}, kAny = {.near_first = false}; // the options of pictures
                                                                        // (device_scene/find_hits.h)

Work count_work(const HostTrees& trees, const RaySet& set) {
    uint64_t nodes = 0, triangles = 0;
    const TraversalCounter counter{&nodes, &triangles};
    for (const Ray& ray : set.rays) {
        Hit hit;
        if (set.any_hit) {
            trace_any<Wide8SimdTraversal<kAny>>(trees, ray, AcceptAll{}, counter);
        } else {
            trace_closest<Wide8SimdTraversal<kClosest>>(trees, ray, AcceptAll{}, hit, counter);
        }
    }
    const double n = static_cast<double>(set.rays.size());
    return {static_cast<double>(nodes) / n, static_cast<double>(triangles) / n};
}

void measure(const HostTrees& trees, const EmbreePeers& peers, const RaySet& set, const Flags& flags) {
    const bool coherent = set.name == "primary" || set.name == "sun";
    const Contest contest(make_contestants(trees, peers, set.any_hit, coherent), set.rays, flags.rounds);
    // Like pictures: bounces in flight, other rays in packets if they are coherent.
    const bool is_bounce = !set.any_hit && set.name != "primary";
    const std::string many = name_of(is_bounce ? OurWay::Scattered : OurWay::Together), one = name_of(OurWay::Single);
    const std::string robust = embree_name("robust", EmbreeWay::Single), fast = embree_name("fast", EmbreeWay::Single);
    const std::string batched = contest.strongest("robust"), fast_batched = contest.strongest("fast");
    const std::string stream = embree_name("robust", EmbreeWay::Stream);
    const bool has_streams = std::ranges::find(kBatchedWays, EmbreeWay::Stream) != std::end(kBatchedWays);
    const double to_streams = has_streams ? contest.ratio(many, stream) : 0; // Embree 4 has none
    const Work work = count_work(trees, set);
    const double share = static_cast<double>(contest.hits(many)) / static_cast<double>(set.rays.size());
    if (flags.json) {
        std::printf(
            R"({"kind":"%s","any_hit":%s,"rays":%zu,"hit_share":%.4f,"mrays_per_s":%.3f,"ratio_to_embree":%.3f,)"
            R"("ratio_to_embree_fast":%.3f,"ratio_to_embree_streams":%.3f,"ratio_to_embree_batched":%.3f,)"
            R"("ratio_to_embree_fast_batched":%.3f,"single_mrays_per_s":%.3f,"single_ratio_to_embree":%.3f,)"
            R"("single_ratio_to_embree_fast":%.3f,"batched":"%s","fast_batched":"%s","nodes":%.2f,"triangles":%.2f})"
            "\n",
            set.name.c_str(), set.any_hit ? "true" : "false", set.rays.size(), share, contest.mrays_per_s(many),
            contest.ratio(many, robust), contest.ratio(many, fast), to_streams, contest.ratio(many, batched),
            contest.ratio(many, fast_batched), contest.mrays_per_s(one), contest.ratio(one, robust),
            contest.ratio(one, fast), batched.c_str(), fast_batched.c_str(), work.nodes, work.triangles);
    } else {
        std::printf("%-9s %6.3f | %6.2f %5.2f %5.2f | %6.2f %5.2f %5.2f %5.2f %5.2f %5.2f | %6.2f %6.2f %6.2f %6.2f | "
                    "%5.1f %5.1f | %s, %s\n",
                    set.name.c_str(), share, contest.mrays_per_s(one), contest.ratio(one, robust),
                    contest.ratio(one, fast), contest.mrays_per_s(many), contest.ratio(many, robust),
                    contest.ratio(many, fast), to_streams, contest.ratio(many, batched),
                    contest.ratio(many, fast_batched), contest.mrays_per_s(robust), contest.mrays_per_s(fast),
                    contest.mrays_per_s(batched), contest.mrays_per_s(fast_batched), work.nodes, work.triangles,
                    batched.c_str(), fast_batched.c_str());
    }
    std::fflush(stdout);
}

/// First shadow rays to a sun: from the same points as those of the record.
RaySet make_sun(const RaySet& shadow) {
    RaySet sun = {"sun", true, shadow.rays};
    for (Ray& ray : sun.rays) {
        ray.direction = normalize(Vec3{0.25f, 1.0f, 0.1f});
        ray.t_max = kInfinity; // the end of the rays of pictures
    }
    return sun;
}

int run_bench(const Flags& flags) {
    Messages messages;
    const RecordScene* const record = find_named(the_record().scenes, flags.scene);
    if (record == nullptr) throw Error(ErrorCode::BadInput, "trace_bench: no such scene: " + flags.scene);
    const Scene scene = make_record_scene(*record, flags.folder, messages);
    const std::optional<TreeBuild> build = value_named<TreeBuild>(flags.build);
    if (!build) throw Error(ErrorCode::BadInput, "trace_bench: no such build: " + flags.build);
    const TracerChoice tracers = default_tracers(false, *build);
    const PreparedScene prepared = prepare_scene(scene, {.tracers = tracers, .keep_coordinates = true}, messages);
    const auto structure = prepared.structures->get(tracers.bounce);
    const HostTrees& trees = std::get<HostTrees>(structure->trees());
    const EmbreePeer robust(scene.meshes.front(), true), fast(scene.meshes.front(), false);

    const FrameSize frame = record_frame(flags.rays);
    const auto trace = [&](std::span<const Ray> rays, std::span<RayHit> hits) {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            Hit hit;
            trace_closest<Wide8SimdTraversal<kClosest>>(trees, rays[i], AcceptAll{}, hit);
            hits[i] = {hit.t, hit.instance, hit.primitive};
        }
    };
    std::vector<RaySet> sets =
        make_record_ray_sets({scene, record_camera(*record), frame.width, frame.height, trace}, flags.rays);
    sets.insert(sets.begin() + 2, make_sun(sets[1]));
    if (!flags.json) {
        std::printf(
            "%s, %s tree: %zu triangles, %llu nodes, %llu triangles in leaves, built in %.2f s\n"
            "kind, share of hits | one ray at a time: Mrays/s, to robust, to fast | as pictures do: Mrays/s, to "
            "robust, to fast, to robust streams (0: it has none), to robust batched, to fast batched | Embree's "
            "Mrays/s: robust, fast, robust batched, fast batched | our nodes, triangles of a ray by itself | how "
            "Embree batches best\n",
            flags.scene.c_str(), flags.build.c_str(), scene.meshes.front().indices.size() / 3,
            static_cast<unsigned long long>(structure->figures().nodes),
            static_cast<unsigned long long>(structure->figures().triangles), prepared.build_seconds);
    }
    for (const RaySet& set : sets) measure(trees, {robust, fast}, set, flags);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    Flags flags;
    const char* const folder = std::getenv("PERTEV_SCENES");
    if (folder != nullptr) flags.folder = folder;
    CLI::App app("trace_bench: rays of one thread beside Embree's");
    app.add_option("scene", flags.scene, "of the record: sponza, bunny or forest");
    app.add_option("--scenes", flags.folder, "folder of the public scenes; else PERTEV_SCENES");
    app.add_option("--build", flags.build, "of the tree: fast, balanced or best");
    app.add_option("--rays", flags.rays, "of each kind");
    app.add_option("--rounds", flags.rounds, "how often each chunk of rays is traced by everyone");
    app.add_flag("--json", flags.json, "one object a kind of ray");
    CLI11_PARSE(app, argc, argv);
    try {
        return run_bench(flags);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
