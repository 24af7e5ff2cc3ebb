#include "tests/support/instanced_scene.h"

#include "accel/builders/build_bvh.h"

namespace pertev::test {

std::vector<Hit> InstancedScene::hits_by_brute_force(bool with_baked) const {
    std::vector<Hit> hits(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        if (with_baked) trace_by_brute_force(baked, rays[i], kNoHit, AcceptSome{}, hits[i]);
        for (const PlacedBvh& p : placed) {
            const Ray local = transform_ray(inverse(p.world_from_local), rays[i]);
            trace_by_brute_force(meshes[p.blas], local, p.instance, AcceptSome{}, hits[i]);
        }
    }
    return hits;
}

InstancedScene make_instanced_scene(uint32_t ray_count) {
    InstancedScene s;
    s.meshes = {triangles_of(make_torus(16, 12)), make_soup(300, 0), make_soup(200, 1000.0f),
                triangles_of(make_sphere(0, {}, 1))};
    s.baked = triangles_of(make_torus(20, 16), 7);
    s.baked_tree = build_bvh(s.baked);
    for (const auto& mesh : s.meshes) s.trees.push_back(build_bvh(mesh));

    Random random(5);
    for (uint32_t i = 0; i < 60; ++i) {
        const uint32_t mesh = i % 4;
        const Vec3 axis = random.direction();
        const float w = random.within(-1, 1), sine = sqrt(1 - w * w);
        Transform place = make_rotation(sine * axis.x, sine * axis.y, sine * axis.z, w);
        if (i % 5 == 0) place = Transform{}; // the identity is exact, and has ties with its neighbours
        if (i % 3 == 0) place = compose(place, make_scale({0.5f, random.within(0.01f, 4), -1}));
        if (i % 7 == 0) place = compose(place, make_scale({1e4f, 1e4f, 1e4f}));
        place = compose(make_translation(i % 5 == 0 ? Vec3{} : random.point(-3, 3)), place);
        if (mesh == 2) place = compose(place, make_translation({-1000, 0, 1000})); // far from the mesh's origin
        s.placed.push_back({place, s.trees[mesh].bounds, mesh, i * 3 + 1});
    }
    s.top = build_tlas(s.placed);
    s.rays = stress_rays(ray_count, {"torus", s.baked, {}, 1}, 23);
    return s;
}

} // namespace pertev::test
