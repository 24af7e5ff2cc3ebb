#include "tests/support/embree_scene.h"

#include <algorithm>

namespace pertev::test {
namespace {

RTCRay embree_ray(const Ray& r) {
    return {.org_x = r.origin.x,
            .org_y = r.origin.y,
            .org_z = r.origin.z,
            .tnear = r.t_min,
            .dir_x = r.direction.x,
            .dir_y = r.direction.y,
            .dir_z = r.direction.z,
            .time = 0,
            .tfar = r.t_max,
            .mask = 0xffffffffu,
            .id = 0,
            .flags = 0};
}

} // namespace

EmbreeScene::EmbreeScene(const TriangleMesh& mesh) : device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<Vec3*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                         sizeof(Vec3), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), v);
    auto* k = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                             3 * sizeof(uint32_t), mesh.triangle_count()));
    std::copy(mesh.indices.begin(), mesh.indices.end(), k);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    rtcCommitScene(scene_);
}

EmbreeScene::~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

Hit EmbreeScene::closest(const Ray& ray) const {
    RTCRayHit result = {};
    result.ray = embree_ray(ray);
    result.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if PERTEV_EMBREE == 4
    rtcIntersect1(scene_, &result);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &result);
#endif
    if (result.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {.t = ray.t_max};
    return {result.ray.tfar, result.hit.u, result.hit.v, 0, result.hit.primID};
}

bool EmbreeScene::any(const Ray& ray) const {
    RTCRay result = embree_ray(ray);
#if PERTEV_EMBREE == 4
    rtcOccluded1(scene_, &result);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_, &context, &result);
#endif
    return result.tfar < 0;
}

} // namespace pertev::test
