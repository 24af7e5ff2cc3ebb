#include "scene/validate/validate_mesh.h"

#include <atomic>
#include <cmath>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/parallel_for.h"
#include "math/double_vec3.h"
#include "math/frame.h"

namespace pertev {
namespace {

constexpr uint64_t kGrain = 1 << 14;

/// Returns the normal of a triangle times twice its area.
DoubleVec3 area_vector(Vec3 a, Vec3 b, Vec3 c) {
    return cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
}

Vec3 unit(DoubleVec3 v) { return to_float(v / std::sqrt(dot(v, v))); }

/// Returns the number of i in [0, count) for which body(i) is true.
template <class Body>
uint64_t count_in_parallel(uint64_t count, const Body& body) {
    std::atomic<uint64_t> total{0};
    parallel_for_ranges(count, kGrain, [&](uint64_t begin, uint64_t end) {
        uint64_t found = 0;
        for (uint64_t i = begin; i < end; ++i) found += body(i) ? 1 : 0;
        total += found;
    });
    return total;
}

void check_sizes(const Mesh& mesh, const MeshName& of) {
    const std::size_t count = mesh.positions.size();
    const auto check = [&](std::size_t size, const char* what) {
        if (size != 0 && size != count) {
            throw of.error(ErrorCode::BadInput, fmt::format("{} {} for {} vertices", size, what, count));
        }
    };
    check(mesh.normals.size(), "normals");
    check(mesh.tangents.size(), "tangents");
    for (const std::vector<Vec2>& uv : mesh.uv) check(uv.size(), "texture coordinates");
    check(mesh.colors.size(), "colours");
    if (mesh.indices.size() % 3 != 0) {
        throw of.error(ErrorCode::BadInput, fmt::format("{} indices; expected a multiple of 3", mesh.indices.size()));
    }
    if (mesh.indices.size() / 3 > kMaxTrianglesPerMesh) {
        throw of.error(ErrorCode::OverLimit,
                       fmt::format("{} triangles; the limit is {}", mesh.indices.size() / 3, kMaxTrianglesPerMesh));
    }
    parallel_for(mesh.indices.size(), kGrain, [&](uint64_t i) {
        if (mesh.indices[i] < count) return;
        throw of.error(ErrorCode::BadInput, fmt::format("triangle {}: vertex index {} is out of range; there are {} "
                                                        "vertices",
                                                        i / 3, mesh.indices[i], count));
    });
}

bool is_valid_position(Vec3 p) { return is_finite(p) && max_component(abs(p)) <= kMaxCoordinate; }

enum class Fault : uint8_t { None, NotFinite, TooFar, WithoutArea };

Fault fault_of(const Mesh& mesh, uint64_t triangle) {
    const uint32_t* i = mesh.indices.data() + 3 * triangle;
    const Vec3 a = mesh.positions[i[0]], b = mesh.positions[i[1]], c = mesh.positions[i[2]];
    if (!(is_finite(a) && is_finite(b) && is_finite(c))) return Fault::NotFinite;
    if (!(is_valid_position(a) && is_valid_position(b) && is_valid_position(c))) return Fault::TooFar;
    const DoubleVec3 area = area_vector(a, b, c);
    return area.x == 0 && area.y == 0 && area.z == 0 ? Fault::WithoutArea : Fault::None;
}

void drop_triangles(Mesh& mesh, bool reshaped, MeshRepairs& repairs) {
    const uint64_t count = mesh.indices.size() / 3;
    std::vector<Fault> faults(count);
    const uint64_t bad = count_in_parallel(count, [&](uint64_t i) {
        faults[i] = fault_of(mesh, i);
        if (reshaped && faults[i] == Fault::WithoutArea) faults[i] = Fault::None;
        return faults[i] != Fault::None;
    });
    if (bad == 0) return;
    uint64_t kept = 0;
    for (uint64_t i = 0; i < count; ++i) {
        repairs.too_far += faults[i] == Fault::TooFar;
        repairs.not_finite += faults[i] == Fault::NotFinite;
        repairs.without_area += faults[i] == Fault::WithoutArea;
        if (faults[i] != Fault::None) continue;
        for (int k = 0; k < 3; ++k) mesh.indices[3 * kept + k] = mesh.indices[3 * i + k];
        ++kept;
    }
    mesh.indices.resize(3 * kept);
}

/// Writes the area-weighted mean normal of the triangles at each vertex of `wanted`; +z if there is none.
void put_geometric_normals(const std::vector<Vec3>& positions, const std::vector<uint32_t>& indices,
                           const std::vector<bool>& wanted, std::vector<Vec3>& normals) {
    std::vector<DoubleVec3> sums(positions.size());
    for (std::size_t i = 0; i < indices.size(); i += 3) {
        const uint32_t* corner = indices.data() + i;
        if (!wanted[corner[0]] && !wanted[corner[1]] && !wanted[corner[2]]) continue;
        const DoubleVec3 area = area_vector(positions[corner[0]], positions[corner[1]], positions[corner[2]]);
        for (int k = 0; k < 3; ++k) {
            DoubleVec3& sum = sums[corner[k]];
            sum = {sum.x + area.x, sum.y + area.y, sum.z + area.z};
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (!wanted[i]) continue;
        const Vec3 normal = unit(sums[i]);
        normals[i] = is_finite(normal) ? normal : Vec3{0, 0, 1};
    }
}

uint64_t repair_normals(Mesh& mesh) {
    const uint64_t bad = count_in_parallel(mesh.normals.size(), [&](uint64_t i) {
        mesh.normals[i] = normalize_safely(mesh.normals[i]);
        return !is_finite(mesh.normals[i]);
    });
    if (bad == 0) return 0;
    std::vector<bool> wanted(mesh.normals.size());
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) wanted[i] = !is_finite(mesh.normals[i]);
    put_geometric_normals(mesh.positions, mesh.indices, wanted, mesh.normals);
    return bad;
}

uint64_t repair_tangents(Mesh& mesh) {
    return count_in_parallel(mesh.tangents.size(), [&](uint64_t i) {
        Vec4& t = mesh.tangents[i];
        const float handedness = t.w < 0 ? -1.0f : 1.0f;
        Vec3 direction = normalize_safely({t.x, t.y, t.z});
        const bool is_bad = !is_finite(direction);
        if (is_bad) direction = mesh.normals.empty() ? Vec3{1, 0, 0} : make_frame(mesh.normals[i]).tangent;
        t = {direction.x, direction.y, direction.z, handedness};
        return is_bad;
    });
}

void check_shape_sizes(const MeshShape& shape, const Mesh& mesh, const MeshName& of) {
    const std::size_t vertices = mesh.positions.size(), influences = vertices * shape.joints_per_vertex;
    const auto fits = [&](std::size_t size, bool wanted) { return size == (wanted ? vertices : 0); };
    bool fit = fits(shape.positions.size(), true) && fits(shape.normals.size(), !mesh.normals.empty()) &&
               fits(shape.tangents.size(), !mesh.tangents.empty());
    for (const MorphTarget& target : shape.targets) {
        for (const std::vector<Vec3>* offsets : {&target.positions, &target.normals, &target.tangents}) {
            fit = fit && (offsets->empty() || offsets->size() == vertices);
        }
    }
    if (!fit || shape.joints.size() != influences || shape.weights.size() != influences) {
        throw of.error(ErrorCode::BadInput,
                       fmt::format("the vertices of its morph targets or skin do not match its {}", vertices));
    }
}

void zero_invalid_positions(std::vector<Vec3>& positions) {
    parallel_for(positions.size(), kGrain, [&](uint64_t i) {
        if (!is_valid_position(positions[i])) positions[i] = {};
    });
}

void put_zeros_for_not_finite(std::vector<Vec3>& values) {
    parallel_for(values.size(), kGrain, [&](uint64_t i) {
        if (!is_finite(values[i])) values[i] = {};
    });
}

} // namespace

Error MeshName::error(ErrorCode code, const std::string& why) const {
    return {code, FileLocation{file}, fmt::format("{}: {}", name, why)};
}

MeshRepairs& MeshRepairs::operator+=(const MeshRepairs& other) {
    too_far += other.too_far;
    not_finite += other.not_finite;
    without_area += other.without_area;
    normals += other.normals;
    tangents += other.tangents;
    texture_coordinates += other.texture_coordinates;
    colors += other.colors;
    return *this;
}

MeshRepairs repair_mesh(Mesh& mesh, bool reshaped, const MeshName& of) {
    check_sizes(mesh, of);
    MeshRepairs repairs;
    drop_triangles(mesh, reshaped, repairs);
    zero_invalid_positions(mesh.positions);
    repairs.normals = repair_normals(mesh);
    repairs.tangents = repair_tangents(mesh);
    for (std::vector<Vec2>& uv : mesh.uv) {
        repairs.texture_coordinates += count_in_parallel(uv.size(), [&](uint64_t i) {
            if (is_finite(uv[i].x) && is_finite(uv[i].y)) return false;
            uv[i] = {};
            return true;
        });
    }
    repairs.colors = count_in_parallel(mesh.colors.size(), [&](uint64_t i) {
        const Vec4 c = mesh.colors[i];
        const Vec4 kept = {clamp(c.x, 0.0f, 1.0f), clamp(c.y, 0.0f, 1.0f), clamp(c.z, 0.0f, 1.0f),
                           clamp(c.w, 0.0f, 1.0f)};
        mesh.colors[i] = kept;
        return !(kept == c);
    });
    return repairs;
}

MeshRepairs repair_shape(MeshShape& shape, const Mesh& mesh, std::size_t joint_count, const MeshName& of) {
    check_shape_sizes(shape, mesh, of);
    for (std::size_t i = 0; i < shape.joints.size(); ++i) {
        if (!is_finite(shape.weights[i])) shape.weights[i] = 0;
        if (shape.joints[i] < joint_count) continue;
        throw of.error(ErrorCode::BadInput, fmt::format("vertex {} has joint {}; expected less than {}, the number of "
                                                        "the skin's joints",
                                                        i / shape.joints_per_vertex, shape.joints[i], joint_count));
    }
    zero_invalid_positions(shape.positions);
    for (MorphTarget& target : shape.targets) {
        for (std::vector<Vec3>* offsets : {&target.positions, &target.normals, &target.tangents}) {
            put_zeros_for_not_finite(*offsets);
        }
    }
    MeshRepairs repairs;
    std::vector<bool> wanted(shape.normals.size());
    for (std::size_t i = 0; i < shape.normals.size(); ++i) {
        wanted[i] = !is_finite(normalize_safely(shape.normals[i]));
        repairs.normals += wanted[i];
    }
    if (repairs.normals > 0) put_geometric_normals(shape.positions, mesh.indices, wanted, shape.normals);
    for (std::size_t i = 0; i < shape.tangents.size(); ++i) {
        Vec4& t = shape.tangents[i];
        t.w = t.w < 0 ? -1.0f : 1.0f;
        if (is_finite(normalize_safely({t.x, t.y, t.z}))) continue;
        const Vec3 across =
            shape.normals.empty() ? Vec3{1, 0, 0} : make_frame(normalize_safely(shape.normals[i])).tangent;
        t = {across.x, across.y, across.z, t.w};
        ++repairs.tangents;
    }
    return repairs;
}

} // namespace pertev
