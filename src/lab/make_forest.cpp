#include "lab/make_forest.h"

#include "base/parallel_for.h"
#include "math/frame.h"
#include "math/portable_math.h"
#include "math/random.h"
#include "math/sampling.h"

namespace pertev {
namespace {

constexpr float kSide = 200; // side of the ground, metres
constexpr float kHills = 12; // amplitude of the ground's noise, metres
constexpr int kOctaves = 6;  // number of noise octaves, each with half the cell size and half the height of the one
                             // before
constexpr float kCell = 50;  // cell size of the coarsest octave, metres
constexpr uint32_t kTrunkSides = 6, kTrunkRings = 4;
constexpr uint32_t kTrunkTriangles = 2 * kTrunkSides * (kTrunkRings - 1); // 36

/// A stream of numbers in [0, 1) that belongs to one object: the n-th call returns the n-th number.
class Numbers {
public:
    Numbers(uint32_t kind, uint32_t index) : kind_(kind), index_(index) {}
    float next() { return static_cast<float>(hash_words(kind_, index_, count_++).x >> 8) * 0x1p-24f; }
    float between(float low, float high) { return low + next() * (high - low); }

private:
    uint32_t kind_, index_, count_ = 0;
};

// Chosen from a few candidates so that no leaves hide the record's camera and as many of its rays hit as in the
// record.
constexpr uint32_t kGroundNumbers = 1144, kTreeNumbers = 4, kLeafNumbers = 0x4c454146u;

/// Returns value noise in [0, 1): random values on a grid, blended smoothly.
float value_noise(float x, float z, uint32_t octave) {
    const float fx = floor(x), fz = floor(z);
    const auto corner = [&](int i, int j) {
        const uint32_t cx = static_cast<uint32_t>(to_int(fx, -(1 << 20), 1 << 20) + i);
        const uint32_t cz = static_cast<uint32_t>(to_int(fz, -(1 << 20), 1 << 20) + j);
        return static_cast<float>(hash_words(cx, cz, kGroundNumbers + octave).x >> 8) * 0x1p-24f;
    };
    const auto smooth = [](float t) { return t * t * (3.0f - 2.0f * t); };
    const float s = smooth(x - fx), t = smooth(z - fz);
    return lerp(lerp(corner(0, 0), corner(1, 0), s), lerp(corner(0, 1), corner(1, 1), s), t);
}

/// Returns the height of the ground in [0, kHills), metres.
float ground_height(float x, float z) {
    float sum = 0, weight = 1, total = 0, scale = 1.0f / kCell;
    for (int octave = 0; octave < kOctaves; ++octave) {
        sum += weight * value_noise(scale * x, scale * z, static_cast<uint32_t>(octave));
        total += weight;
        weight *= 0.5f;
        scale *= 2;
    }
    return kHills * (sum / total);
}

/// The section of the mesh's arrays that one piece of the forest fills. All sizes are known in advance, so pieces can
/// be made in parallel.
struct MeshPart {
    Vec3* positions;
    uint32_t* indices;
    uint32_t first_vertex; // index of positions[0] in the mesh
    uint32_t vertices = 0;

    uint32_t add_vertex(Vec3 p) {
        positions[vertices] = p;
        return first_vertex + vertices++;
    }
    void add_triangle(uint32_t a, uint32_t b, uint32_t c) {
        *indices++ = a;
        *indices++ = b;
        *indices++ = c;
    }
    void add_quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
        add_triangle(a, b, c);
        add_triangle(a, c, d);
    }
};

void make_ground(uint32_t quads, Mesh& mesh) {
    const uint32_t row = quads + 1;
    parallel_for(row, 8, [&](uint64_t j) {
        for (uint32_t i = 0; i < row; ++i) {
            const float x = kSide * (static_cast<float>(i) / static_cast<float>(quads) - 0.5f);
            const float z = kSide * (static_cast<float>(j) / static_cast<float>(quads) - 0.5f);
            mesh.positions[j * row + i] = {x, ground_height(x, z), z};
        }
    });
    parallel_for(quads, 8, [&](uint64_t j) {
        MeshPart part{nullptr, &mesh.indices[6 * j * quads], 0};
        for (uint32_t i = 0; i < quads; ++i) {
            const uint32_t a = static_cast<uint32_t>(j) * row + i;
            part.add_quad(a, a + row, a + row + 1, a + 1);
        }
    });
}

/// Adds a tapered prism, open at both ends, that starts slightly below the ground.
void add_trunk(MeshPart& part, Vec3 foot, float height, float radius) {
    uint32_t vertex[kTrunkRings][kTrunkSides];
    for (uint32_t ring = 0; ring < kTrunkRings; ++ring) {
        const float up = static_cast<float>(ring) / (kTrunkRings - 1);
        const float r = radius * (1.0f - 0.6f * up);
        for (uint32_t side = 0; side < kTrunkSides; ++side) {
            float sine, cosine;
            sin_cos_2pi(static_cast<float>(side) / kTrunkSides, sine, cosine);
            vertex[ring][side] = part.add_vertex(foot + Vec3{r * cosine, up * height, r * sine});
        }
    }
    for (uint32_t ring = 0; ring + 1 < kTrunkRings; ++ring) {
        for (uint32_t side = 0; side < kTrunkSides; ++side) {
            const uint32_t next = (side + 1) % kTrunkSides;
            part.add_quad(vertex[ring][side], vertex[ring + 1][side], vertex[ring + 1][next], vertex[ring][next]);
        }
    }
}

/// Adds a small rectangle of random orientation near the surface of the crown.
void add_leaf(MeshPart& part, Numbers& numbers, Vec3 centre, Vec3 radii) {
    const float around = numbers.next();
    const float height = numbers.between(-1, 1);
    const float out = sqrt(sqrt(numbers.next())); // density grows with the distance from the centre, so few leaves
                                                  // are inside
    const Vec3 place = out * direction_at_height(height, around);
    const Vec3 p = centre + Vec3{radii.x * place.x, radii.y * place.y, radii.z * place.z};
    const float turn = numbers.next();
    const float tilt = numbers.between(-1, 1);
    const float spin = numbers.next();
    const float half = numbers.between(0.06f, 0.12f);
    const Frame frame = make_frame(direction_at_height(tilt, turn));
    float sine, cosine;
    sin_cos_2pi(spin, sine, cosine);
    const Vec3 along = half * (cosine * frame.tangent + sine * frame.bitangent);
    const Vec3 across = 0.6f * half * (cosine * frame.bitangent - sine * frame.tangent);
    const uint32_t a = part.add_vertex(p - along - across), b = part.add_vertex(p + along - across);
    const uint32_t c = part.add_vertex(p + along + across), d = part.add_vertex(p - along + across);
    part.add_quad(a, b, c, d);
}

void make_tree(uint32_t tree, uint32_t leaves, MeshPart part) {
    Numbers numbers(kTreeNumbers, tree);
    const float x = numbers.between(-0.5f * kSide, 0.5f * kSide);
    const float z = numbers.between(-0.5f * kSide, 0.5f * kSide);
    const float height = numbers.between(5, 11);
    const float radius = numbers.between(1.6f, 3.2f);
    const float tall = radius * numbers.between(1.0f, 1.5f);
    const Vec3 foot = {x, ground_height(x, z) - 0.2f, z};
    add_trunk(part, foot, height, 0.03f * height);
    Numbers leaf_numbers(kLeafNumbers, tree);
    const Vec3 crown = foot + Vec3{0, height, 0};
    for (uint32_t i = 0; i < leaves; ++i) add_leaf(part, leaf_numbers, crown, {radius, tall, radius});
}

} // namespace

uint32_t ForestSettings::triangle_count() const {
    return 2 * ground_quads * ground_quads + trees * (kTrunkTriangles + 2 * leaves);
}

Mesh make_forest(const ForestSettings& settings) {
    const uint32_t ground_vertices = (settings.ground_quads + 1) * (settings.ground_quads + 1);
    const uint32_t tree_vertices = kTrunkRings * kTrunkSides + 4 * settings.leaves;
    const std::size_t ground_indices = std::size_t{6} * settings.ground_quads * settings.ground_quads;
    const std::size_t tree_indices = std::size_t{3} * (kTrunkTriangles + 2 * settings.leaves);
    Mesh mesh;
    mesh.name = "forest";
    mesh.positions.resize(ground_vertices + std::size_t{settings.trees} * tree_vertices);
    mesh.indices.resize(ground_indices + settings.trees * tree_indices);
    make_ground(settings.ground_quads, mesh);
    parallel_for(settings.trees, 4, [&](uint64_t tree) {
        const uint32_t first = ground_vertices + static_cast<uint32_t>(tree) * tree_vertices;
        make_tree(static_cast<uint32_t>(tree), settings.leaves,
                  {&mesh.positions[first], &mesh.indices[ground_indices + tree * tree_indices], first});
    });
    return mesh;
}

} // namespace pertev
