#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "shading/shading_frame.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace {

bool is_near(Vec3 a, Vec3 b, float within = 1e-5f) { return length(a - b) < within; }

void check_orthonormal(const Frame& frame) {
    CHECK(std::abs(dot(frame.tangent, frame.bitangent)) < 1e-5f);
    CHECK(std::abs(dot(frame.tangent, frame.normal)) < 1e-5f);
    CHECK(std::abs(dot(frame.bitangent, frame.normal)) < 1e-5f);
    CHECK(std::abs(length(frame.tangent) - 1) < 1e-5f);
    CHECK(std::abs(length(frame.bitangent) - 1) < 1e-5f);
}

} // namespace

TEST_CASE("shading frame: on an upright wall x of a normal map points right and y up") {
    // The wall lies in the plane z = 0, with its front towards +z; u grows to the right, v down (glTF).
    const Vec3 front = {0, 0, 1};
    const Frame frame = frame_with_tangent(front, {2, 0, 0}, 1);
    CHECK(is_near(frame.tangent, {1, 0, 0}));
    CHECK(is_near(frame.bitangent, {0, 1, 0}));
    CHECK(is_near(mapped_normal(frame, {0.5f, 0.5f, 1}, 1), front));
    CHECK(mapped_normal(frame, {0.8f, 0.5f, 0.8f}, 1).x > 0.5f);
    CHECK(mapped_normal(frame, {0.5f, 0.8f, 0.8f}, 1).y > 0.5f);
    CHECK(is_near(mapped_normal(frame, {1, 0.5f, 1}, 0.5f), normalize(Vec3{0.5f, 0, 1})));
    CHECK(is_near(mapped_normal(frame, {1, 0, 0.5f}, 0), front)); // a normal without direction changes nothing

    // With the image mirrored horizontally u grows to the left, and y is still up.
    const Frame mirrored = frame_with_tangent(front, {-1, 0, 0}, -1);
    CHECK(is_near(mirrored.tangent, {-1, 0, 0}));
    CHECK(is_near(mirrored.bitangent, {0, 1, 0}));
}

TEST_CASE("shading frame: a map at transformed coordinates has the frame of a mesh with these coordinates") {
    Random random(1);
    const Vec3 front = {0, 0, 1};
    const float any = 0.3f;
    CHECK(frame_of_transformed_map(frame_with_tangent(front, {any, any, 0}, -1), {2, 0}, {0, 0.5f}).tangent ==
          frame_with_tangent(front, {any, any, 0}, -1).tangent); // a scale is exact
    for (int i = 0; i < 500; ++i) {
        const Vec2 u_by = {random.within(-1, 1), random.within(-1, 1)},
                   v_by = {random.within(-1, 1), random.within(-1, 1)};
        const float det = u_by.x * v_by.y - u_by.y * v_by.x;
        if (std::abs(det) < 0.05f) continue;
        for (const float w : {1.0f, -1.0f}) {
            // u grows with x, and v with -w y. At w = 1 the image is upright on the wall.
            const Frame frame = frame_of_transformed_map(frame_with_tangent(front, {1, 0, 0}, w), u_by, v_by);
            check_orthonormal(frame);
            CHECK(frame.normal == front);
            const auto coordinates = [&](Vec3 p) {
                const Vec2 uv = {p.x, -w * p.y};
                return Vec2{u_by.x * uv.x + u_by.y * uv.y, v_by.x * uv.x + v_by.y * uv.y};
            };
            CHECK(coordinates(frame.tangent).x > 0);
            CHECK(std::abs(coordinates(frame.tangent).y) < 1e-5f);
            CHECK(coordinates(frame.bitangent).y < 0); // y is opposite to growing v
        }
    }
    for (const Vec2 v_by : {Vec2{2, 4}, {0, 0}}) { // without an inverse the frame is unchanged
        check_orthonormal(frame_of_transformed_map(frame_with_tangent(front, {1, 0, 0}, 1), {1, 2}, v_by));
    }
}

TEST_CASE("shading frame: tangents and normals without direction fall back to a valid frame") {
    const Vec3 normal = {0, 0.6f, 0.8f};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Vec4 tangent :
         {Vec4{0, 0, 0, 1}, {0, 0.6f, 0.8f, -1}, {0, -6, -8, 1}, {nan, 1, 1, 1}, {1e-30f, 0, 0, 1}}) {
        check_orthonormal(frame_with_tangent(normal, {tangent.x, tangent.y, tangent.z}, tangent.w));
    }
    const Transform identity;
    CHECK(world_normal(identity, {0, 0, 0}, normal) == normal);
    CHECK(world_normal(identity, {nan, 0, 0}, normal) == normal);
    CHECK(world_normal(identity, {0, -1, 0}, normal) == normal); // the normal is behind its face
    CHECK(is_near(world_normal(identity, {0, 2, 2}, normal), normalize(Vec3{0, 1, 1})));
}

TEST_CASE("shading frame: normals stay perpendicular under non-uniform scale") {
    const Transform world_from_local = compose(make_rotation(0, 0, 0.6f, 0.8f), make_scale({1, 5, 0.2f}));
    const Vec3 local_normal = normalize(Vec3{1, 1, 1}), local_tangent = {1, -1, 0};
    const Vec3 normal = normalize(transform_transposed(inverse(world_from_local), local_normal));
    const Vec3 world = world_normal(inverse(world_from_local), local_normal, normal);
    CHECK(std::abs(dot(world, transform_vector(world_from_local, local_tangent))) < 1e-5f);
    CHECK(std::abs(length(world) - 1) < 1e-6f);
}

TEST_CASE("shading frame: a corrected normal reflects light above the surface and moves as little as possible") {
    Random random(2);
    const Vec3 up = {0, 0, 1};
    int kept = 0, moved = 0;
    for (int i = 0; i < 100'000; ++i) {
        Vec3 wo = random.direction();
        wo.z = std::abs(wo.z);
        if (i % 4 == 0) wo = normalize(Vec3{wo.x, wo.y, 0.001f * wo.z});
        const Vec3 bent = random.direction();
        const Vec3 normal = valid_normal(bent, up, wo);
        const Vec3 mirrored = 2.0f * dot(wo, normal) * normal - wo;
        CHECK(std::abs(length(normal) - 1) < 1e-5f);
        CHECK(mirrored.z > -1e-7f);
        CHECK(dot(normal, up) > 0);
        CHECK(dot(normal, wo) > 0);
        if (normal == bent) {
            ++kept;
        } else {
            ++moved;
            CHECK(mirrored.z < 0.0101f); // just above
        }
        CHECK(valid_normal(up, up, wo) == up);
    }
    CHECK(kept > 15'000);
    CHECK(moved > 20'000);
    const Vec3 wo = normalize(Vec3{1, 0, 0.2f});
    CHECK(is_near(valid_normal(up, up, wo), up));
}
