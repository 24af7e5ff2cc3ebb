// Tangents at the corners of a mesh, compared with the library mikktspace, and for input that it does not support.

#include "scene/tangents/corner_tangents.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "base/key_numbers.h"
#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace corner_tangents_test { // test files are compiled together

struct Case {
    std::string name;
    std::vector<Vec3> positions, normals;
    std::vector<Vec2> uv;
    std::vector<uint32_t> indices;
    std::vector<Vec4> tangents; // [corners] the results of mikktspace

    TangentMesh mesh() const { return {.positions = positions, .normals = normals, .uv = uv, .indices = indices}; }
};

const std::vector<Case> kStored = {
#include "tests/support/mikktspace_meshes.inl"
};

std::vector<Vec4> tangents_of(const TangentMesh& mesh) { return corner_tangents(mesh, make_tangent_groups(mesh)); }

/// Numbers each corner's vertex and tangent, so that corners which stay one vertex have equal numbers.
std::vector<uint32_t> numbers_of(const Case& made, const std::vector<Vec4>& tangents) {
    KeyNumbers<std::array<uint32_t, 5>> known(tangents.size());
    std::vector<uint32_t> numbers;
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        std::array<uint32_t, 5> key = {made.indices[i]};
        std::memcpy(key.data() + 1, &tangents[i], sizeof(Vec4));
        numbers.push_back(known.number_of(key));
    }
    return numbers;
}

float distance(Vec4 a, Vec4 b) {
    return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z), std::abs(a.w - b.w)});
}

/// Corners whose tangents are more than 1e-5 off.
int corners_off(const std::vector<Vec4>& tangents, const std::vector<Vec4>& expected) {
    int off = 0;
    for (std::size_t i = 0; i < tangents.size(); ++i) off += !(distance(tangents[i], expected[i]) <= 1e-5f);
    return off;
}

TEST_CASE("tangents of stored meshes equal MikkTSpace's and are shared by the same corners") {
    for (const Case& stored : kStored) {
        CAPTURE(stored.name);
        const std::vector<Vec4> tangents = tangents_of(stored.mesh());
        REQUIRE(tangents.size() == stored.tangents.size());
        CHECK(corners_off(tangents, stored.tangents) == 0);
        CHECK(numbers_of(stored, tangents) == numbers_of(stored, stored.tangents));
    }
}

TEST_CASE("tangents do not depend on which vertices the file shares") {
    for (const Case& stored : kStored) {
        CAPTURE(stored.name);
        Case apart;
        for (const uint32_t i : stored.indices) {
            apart.indices.push_back(static_cast<uint32_t>(apart.positions.size()));
            Vec3 p = stored.positions[i];
            if (p.x == 0 && apart.indices.size() % 2 == 0) p.x = -0.0f; // zeros of both signs are one number
            apart.positions.push_back(p);
            apart.normals.push_back(stored.normals[i]);
            apart.uv.push_back(stored.uv[i]);
        }
        CHECK(tangents_of(apart.mesh()) == tangents_of(stored.mesh()));
    }
}

TEST_CASE("a vertex of very many triangles takes time linear in their number") {
    Case fan;
    const uint32_t sides = 50'000;
    fan.positions.push_back({0, 0, 0});
    for (uint32_t i = 0; i < sides; ++i) {
        const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(sides);
        fan.positions.push_back({std::cos(angle), std::sin(angle), 0});
    }
    for (const Vec3 p : fan.positions) {
        fan.normals.push_back({0, 0, 1});
        fan.uv.push_back({p.x * p.x, p.y}); // mirrored at x = 0: two groups at the tip
    }
    for (uint32_t i = 0; i < sides; ++i) {
        for (const uint32_t corner : {0u, 1 + i, 1 + (i + 1) % sides}) fan.indices.push_back(corner);
        for (const uint32_t corner : {0u, 1u, 2u})
            fan.indices.push_back(corner); // adds one edge that as many triangles share
    }
    const std::vector<Vec4> tangents = tangents_of(fan.mesh());
    CHECK(tangents[6 * (sides / 8)].x > 0.9f);
    CHECK(tangents[6 * (sides / 2 - sides / 8)].x < -0.9f);
}

TEST_CASE("tangents of arbitrary numbers are unit and finite") {
    Random random(7);
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const auto number = [&] {
        const float wild[] = {0, -0.0f, 1, -1, 1e-38f, 1e-20f, 1e20f, -3e38f, inf, nan};
        return random.within(0, 1) < 0.7f ? random.within(-1, 1) : wild[random.below(10)];
    };
    for (int round = 0; round < 300; ++round) {
        Case wild;
        for (int i = 0; i < 8; ++i) {
            wild.positions.push_back({number(), number(), number()});
            wild.normals.push_back(random.direction());
            wild.uv.push_back({number(), number()});
        }
        for (int i = 0; i < 30; ++i) wild.indices.push_back(static_cast<uint32_t>(random.below(8)));
        for (const Vec4 t : tangents_of(wild.mesh())) {
            CHECK(std::abs(length(Vec3{t.x, t.y, t.z}) - 1) < 1e-4f);
            CHECK(std::abs(t.w) == 1);
        }
    }
}

} // namespace corner_tangents_test
