#include "bench/ray_contest.h"

#include <time.h>

#include <algorithm>
#include <memory>

#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/trace_many.h"
#include "trace/wide/traverse_wide.h"

namespace pertev::bench {
namespace {

// Long enough that a tracer finds its tree in the cache again after the others.
constexpr std::size_t kChunk = 1 << 16;

/// This thread's own time.
double now_s() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

template <class F>
double seconds_of(const F& f) {
    const double start = now_s();
    f();
    return now_s() - start;
}

constexpr TraversalOptions kClosest = {}, kAny = {.near_first = false}; // the options of pictures
                                                                        // (device_scene/find_hits.h)

double trace_one_by_one(const HostTrees& trees, std::span<const Ray> rays, bool any_hit, std::size_t& hits) {
    std::vector<Hit> results(rays.size());
    const double s = seconds_of([&] {
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (any_hit) {
                results[i].instance = trace_any<Wide8SimdTraversal<kAny>>(trees, rays[i], AcceptAll{}) ? 0 : kNoHit;
            } else {
                trace_closest<Wide8SimdTraversal<kClosest>>(trees, rays[i], AcceptAll{}, results[i]);
            }
        }
    });
    hits =
        static_cast<std::size_t>(std::ranges::count_if(results, [](const Hit& hit) { return hit.instance != kNoHit; }));
    return s;
}

double trace_many(const HostTrees& trees, RayOrder order, std::span<const Ray> rays, bool any_hit, std::size_t& hits) {
    std::vector<Hit> results(rays.size());
    const auto met = std::make_unique<bool[]>(rays.size());
    const auto count = static_cast<uint32_t>(rays.size());
    const auto ray_of = [&](uint32_t i) { return rays[i]; };
    const auto accept_of = [](uint32_t) { return AcceptAll{}; };
    const double s = seconds_of([&] {
        if (any_hit) {
            trace_any_many<kAny>(trees, count, order, ray_of, accept_of, met.get());
        } else {
            trace_closest_many<kClosest>(trees, count, order, ray_of, accept_of, results.data());
        }
    });
    hits = 0;
    for (uint32_t i = 0; i < count; ++i) hits += any_hit ? met[i] : results[i].instance != kNoHit;
    return s;
}

} // namespace

const char* name_of(OurWay way) {
    switch (way) {
    case OurWay::Single:
        return "single";
    case OurWay::Scattered:
        return "in flight";
    case OurWay::Together:
        break;
    }
    return "together";
}

std::string embree_name(const std::string& mode, EmbreeWay way) { return mode + " " + name_of(way); }

std::vector<Contestant> make_contestants(const HostTrees& trees, const EmbreePeers& peers, bool any_hit,
                                         bool coherent) {
    std::vector<Contestant> all;
    all.push_back({name_of(OurWay::Single), [&trees, any_hit](std::span<const Ray> rays, std::size_t& hits) {
                       return trace_one_by_one(trees, rays, any_hit, hits);
                   }});
    for (const OurWay way : {OurWay::Scattered, OurWay::Together}) {
        const RayOrder order = way == OurWay::Together ? RayOrder::Together : RayOrder::Scattered;
        all.push_back({name_of(way), [&trees, order, any_hit](std::span<const Ray> rays, std::size_t& hits) {
                           return trace_many(trees, order, rays, any_hit, hits);
                       }});
    }
    const auto add = [&](const std::string& mode, const EmbreePeer& peer, EmbreeWay way) {
        all.push_back(
            {embree_name(mode, way), [&peer, way, any_hit, coherent](std::span<const Ray> rays, std::size_t& hits) {
                 EmbreeRays made = make_embree_rays(way, rays, any_hit, coherent);
                 const double s = seconds_of([&] { peer.trace(way, made); });
                 hits = count_hits(way, made);
                 return s;
             }});
    };
    const auto add_both = [&](EmbreeWay way) {
        add("robust", peers.robust, way);
        add("fast", peers.fast, way);
    };
    add_both(EmbreeWay::Single);
    for (const EmbreeWay way : kBatchedWays) add_both(way);
    return all;
}

Contest::Contest(const std::vector<Contestant>& contestants, const std::vector<Ray>& rays, int rounds)
    : traced_(rays.size() * static_cast<std::size_t>(rounds)) {
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t first = 0; first < rays.size(); first += kChunk) {
            const auto chunk = std::span(rays).subspan(first, std::min(kChunk, rays.size() - first));
            for (const Contestant& one : contestants) {
                std::size_t hits = 0;
                seconds_[one.name].push_back(one.trace(chunk, hits));
                if (round == 0) hits_[one.name] += hits;
            }
        }
    }
}

double Contest::ratio(const std::string& ours, const std::string& theirs) const {
    const std::vector<double>&a = seconds_.at(ours), &b = seconds_.at(theirs);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < a.size(); ++i) ratios.push_back(b[i] / a[i]);
    return median(std::move(ratios));
}

double Contest::mrays_per_s(const std::string& name) const {
    double s = 0;
    for (const double chunk : seconds_.at(name)) s += chunk;
    return static_cast<double>(traced_) / s * 1e-6;
}

std::string Contest::strongest(const std::string& mode) const {
    std::string best;
    for (const EmbreeWay way : kBatchedWays) {
        const std::string name = embree_name(mode, way);
        if (best.empty() || ratio(name, best) > 1) best = name;
    }
    return best;
}

} // namespace pertev::bench
