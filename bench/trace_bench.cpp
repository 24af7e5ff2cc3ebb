// trace_bench [FILE.obj] [RAYS]: builds the tree of a mesh (a torus without a file) and measures single rays on one
// thread, primary and after one and two diffuse bounces, through the binary and the wide tree, beside Embree's robust
// single-ray functions in the same run. With a file the camera is that of the Sponza jobs.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "accel/bvh/build_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "math/frame.h"
#include "tests/support/embree_scene.h"
#include "tests/support/meshes.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/walk_wide.h"

using namespace pertev;
using namespace pertev::test;

namespace {

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Seconds of the fastest of some runs.
template <class F>
double fastest(int runs, const F& f) {
    double best = 1e30;
    for (int i = 0; i < runs; ++i) {
        const double start = now_s();
        f();
        best = std::min(best, now_s() - start);
    }
    return best;
}

std::vector<Ray> primary_rays(uint32_t count, const Bounds3& bounds, bool is_sponza) {
    const Vec3 centre = bounds.centre(), size = bounds.size();
    const Vec3 eye = is_sponza ? Vec3{-110, 18, -2} : centre + Vec3{1.1f * size.x, 0.9f * size.y, 1.2f * size.z};
    const Vec3 target = is_sponza ? Vec3{60, 32, -4} : centre;
    const Vec3 forward = normalize(target - eye), right = normalize(cross(forward, {0, 1, 0}));
    const Vec3 up = cross(right, forward);
    std::vector<Ray> rays(count);
    const auto width = static_cast<uint32_t>(std::sqrt(static_cast<float>(count) * 16.0f / 9.0f));
    Random random(1);
    for (uint32_t i = 0; i < count; ++i) {
        const float w = static_cast<float>(width), h = static_cast<float>(count / width);
        const float x = (static_cast<float>(i % width) + random.unit()) / w * 2 - 1;
        const float y = 1 - (static_cast<float>(i / width) + random.unit()) / h * 2;
        const float tan_half = 0.57735f;
        rays[i].origin = eye;
        rays[i].direction = normalize(forward + x * tan_half * 16 / 9 * right + y * tan_half * up);
    }
    return rays;
}

std::vector<Ray> bounce(const std::vector<Ray>& rays, const std::vector<Hit>& hits, const TriangleMesh& mesh, float eps,
                        uint32_t seed) {
    std::vector<Ray> next;
    Random random(seed);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].instance == kNoHit) continue;
        const Vec3 a = mesh.corner(hits[i].primitive, 0), b = mesh.corner(hits[i].primitive, 1),
                   c = mesh.corner(hits[i].primitive, 2);
        Vec3 n = normalize(cross(b - a, c - a));
        if (!is_finite(n)) continue;
        if (dot(n, rays[i].direction) > 0) n = -n;
        const float r2 = random.unit(), phi = kTwoPi * random.unit(), r = sqrt(r2);
        Ray ray;
        ray.origin = rays[i].origin + hits[i].t * rays[i].direction + eps * n;
        ray.direction = normalize(make_frame(n).to_world({r * std::cos(phi), r * std::sin(phi), sqrt(1 - r2)}));
        next.push_back(ray);
    }
    return next;
}

template <class ClosestWalk, class AnyWalk, class Scene>
void measure(const char* name, const Scene& scene, const EmbreeScene& embree, const std::vector<Ray>& rays,
             std::vector<Hit>& hits) {
    const double m = static_cast<double>(rays.size()) * 1e-6;
    hits.resize(rays.size());
    const double closest_s = fastest(3, [&] {
        for (std::size_t i = 0; i < rays.size(); ++i) trace_closest<ClosestWalk>(scene, rays[i], AcceptAll{}, hits[i]);
    });
    uint64_t any = 0;
    const double any_s = fastest(3, [&] {
        any = 0;
        for (const Ray& ray : rays) any += trace_any<AnyWalk>(scene, ray, AcceptAll{}) ? 1 : 0;
    });
    std::vector<Hit> results(rays.size());
    const double embree_closest_s = fastest(3, [&] {
        for (std::size_t i = 0; i < rays.size(); ++i) results[i] = embree.closest(rays[i]);
    });
    uint64_t embree_any = 0;
    const double embree_any_s = fastest(3, [&] {
        embree_any = 0;
        for (const Ray& ray : rays) embree_any += embree.any(ray) ? 1 : 0;
    });
    uint64_t nodes = 0, triangles = 0, any_nodes = 0, any_triangles = 0, other = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Hit hit;
        trace_closest<ClosestWalk>(scene, rays[i], AcceptAll{}, hit, WalkCounter{&nodes, &triangles});
        trace_any<AnyWalk>(scene, rays[i], AcceptAll{}, WalkCounter{&any_nodes, &any_triangles});
        other +=
            results[i].instance != hit.instance || (hit.instance != kNoHit && results[i].primitive != hit.primitive);
    }
    const double n = static_cast<double>(rays.size());
    std::printf(
        "%-9s %7zu rays  closest %6.2f  Embree %6.2f Mrays/s  ratio %.2f | any %6.2f  Embree %6.2f  ratio %.2f | "
        "nodes and triangles a ray: %.1f %.1f, any %.1f %.1f; hit share %.3f, Embree's any %.3f; %llu other "
        "primitives\n",
        name, rays.size(), m / closest_s, m / embree_closest_s, embree_closest_s / closest_s, m / any_s,
        m / embree_any_s, embree_any_s / any_s, static_cast<double>(nodes) / n, static_cast<double>(triangles) / n,
        static_cast<double>(any_nodes) / n, static_cast<double>(any_triangles) / n, static_cast<double>(any) / n,
        static_cast<double>(embree_any) / n, static_cast<unsigned long long>(other));
}

} // namespace

int main(int argc, char** argv) {
    const bool has_file = argc > 1;
    const TriangleMesh mesh = has_file ? read_obj_geometry(argv[1]) : make_torus(600, 300);
    const auto count = static_cast<uint32_t>(argc > 2 ? std::atoi(argv[2]) : 500000);
    const BvhBuildSettings settings;

    const std::vector<BvhTriangle> triangles = triangles_of(mesh);
    Bvh bvh;
    const double build_s = fastest(3, [&] { bvh = build_bvh(triangles, settings); });
    std::printf("%zu triangles: built in %.1f ms, %zu nodes, depth %d, cost %.2f, %.0f bytes a triangle\n",
                triangles.size(), build_s * 1e3, bvh.nodes.size(), bvh.depth, static_cast<double>(bvh.sah_cost),
                static_cast<double>(bvh.nodes.size() * sizeof(BvhNode) + triangles.size() * sizeof(BvhTriangle)) /
                    static_cast<double>(triangles.size()));
    const EmbreeScene embree(mesh);
    const float eps = 2e-5f * length(bvh.bounds.size());
    WideBvh<kWideChildren> wide;
    const double widen_s = fastest(3, [&] { wide = make_wide_bvh<kWideChildren>(bvh, kSimdCollapse); });
    std::printf("wide tree: made in %.1f ms, %zu nodes\n", widen_s * 1e3, wide.nodes.size());
    const auto measure_all = [&]<class ClosestWalk, class AnyWalk>(const auto& scene) {
        std::vector<Hit> hits;
        std::vector<Ray> rays = primary_rays(count, bvh.bounds, has_file);
        measure<ClosestWalk, AnyWalk>("primary", scene, embree, rays, hits);
        rays = bounce(rays, hits, mesh, eps, 22);
        measure<ClosestWalk, AnyWalk>("diffuse1", scene, embree, rays, hits);
        rays = bounce(rays, hits, mesh, eps, 44);
        measure<ClosestWalk, AnyWalk>("diffuse2", scene, embree, rays, hits);
    };
    constexpr WalkOptions kClosest = {}, kAny = {.near_first = false}; // as pictures have them
    std::printf("binary walk\n");
    measure_all.operator()<WhileWhileWalk<kClosest>, WhileWhileWalk<kAny>>(SceneBvhView{.baked = view_of(bvh)});
    std::printf("wide walk\n");
    measure_all.operator()<Wide8SimdWalk<kClosest>, Wide8SimdWalk<kAny>>(HostTrees{.baked = view_of(wide)});
    return 0;
}
