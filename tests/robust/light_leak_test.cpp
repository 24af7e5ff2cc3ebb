// A closed shape under a sky of radiance 1000 is black from inside. A ray that starts on the wrong side of a wall
// makes a lit pixel. Boxes are small and large, near the file's origin and far from it, rotated and not, with and
// without a distant object, and positioned by vertices, a node and instances. Other shapes have sharp edges and uneven
// triangles.

#include <doctest/doctest.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Ways in which a file positions the shape.
enum class Placing {
    Vertices,  // vertices at the shape's position
    Node,      // moved by the node's transform and baked
    Instances, // with a second instance, so that each has its own space
    FarMesh,   // far vertices with a second instance, thus far from the origin in its own space, too
};
constexpr Placing kPlacings[] = {Placing::Vertices, Placing::Node, Placing::Instances, Placing::FarMesh};

struct Placement {
    float size_m;
    Vec3 at;
    Transform turn; // about its middle
    Placing placing = Placing::Vertices;
    Vec3 other_at = {}; // position of a second object of this shape; none if {0, 0, 0}
};

const Transform kTurns[] = {{}, make_rotation(0.48f, 0.6f, 0, 0.64f)};

struct Shape {
    std::vector<Vec3> positions; // about its centre, with a size of about 1
    std::vector<uint32_t> indices;
};

Shape cube() {
    Shape shape;
    for (int i = 0; i < 8; ++i) {
        shape.positions.push_back({i & 1 ? 0.5f : -0.5f, i & 2 ? 0.5f : -0.5f, i & 4 ? 0.5f : -0.5f});
    }
    shape.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                     2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return shape;
}

/// A floor and a roof that meet at the edge x = y = -0.5 at an angle with the tangent `slope`.
Shape wedge(float slope) {
    Shape shape;
    for (const float z : {-0.5f, 0.5f}) {
        for (const Vec3 p : {Vec3{-0.5f, -0.5f, z}, {0.5f, -0.5f, z}, {0.5f, slope - 0.5f, z}}) {
            shape.positions.push_back(p);
        }
    }
    shape.indices = {0, 2, 1, 3, 4, 5, 0, 1, 3, 1, 4, 3, 0, 3, 2, 2, 3, 5, 1, 2, 4, 2, 5, 4};
    return shape;
}

Mesh mesh_of(const Shape& shape, const Transform& place) {
    Mesh mesh;
    for (const Vec3 p : shape.positions) mesh.positions.push_back(transform_point(place, p));
    mesh.indices = shape.indices;
    return mesh;
}

Transform transform_of(const Placement& place) {
    const Transform sized = make_scale({place.size_m, place.size_m, place.size_m});
    return compose(make_translation(place.at), compose(place.turn, sized));
}

Scene scene_of(const Shape& shape, const Placement& place) {
    Scene scene;
    scene.bakes_small_meshes = false;
    scene.materials.push_back({{.base_color = grey(0.8f)}, "grey"});
    const Transform m = transform_of(place);
    const bool is_node = place.placing == Placing::Node || place.placing == Placing::Instances;
    scene.meshes.push_back(mesh_of(shape, is_node ? Transform{} : m));
    scene.instances.push_back({"closed", 0, 0, is_node ? m : Transform{}});
    if (place.placing == Placing::Instances || place.placing == Placing::FarMesh) {
        const Transform beside = make_translation({4 * place.size_m, 0, 0});
        scene.instances.push_back({"beside", 0, 0, compose(beside, is_node ? m : Transform{})});
    }
    if (place.other_at != Vec3{}) {
        scene.meshes.push_back(mesh_of(shape, {}));
        scene.instances.push_back({"far away", 1, 0, make_translation(place.other_at)});
    }
    scene.environment = Environment{.image = {}, .scale = grey(1000)};
    return scene;
}

/// A view from one point in the shape's coordinates to another.
struct View {
    Vec3 from, to;
    float fov_y;
};

/// `scene` outlives it.
PreparedScene prepared_of(const Scene& scene) {
    Messages messages;
    return prepare_scene(scene, {}, messages);
}

uint64_t lit_pixels(const PreparedScene& scene, const Placement& place, const View& view, uint32_t side,
                    uint32_t samples, uint32_t max_depth) {
    const Transform m = transform_of(place);
    Camera camera;
    camera.world_from_camera =
        look_at(transform_point(m, view.from), transform_point(m, view.to), normalize(Vec3{0.1f, 1, 0.05f}));
    camera.fov_y = view.fov_y;
    RenderSettings settings;
    settings.width = settings.height = side;
    settings.samples = samples;
    settings.path.max_depth = max_depth;
    Queue queue = requested_queue();
    const Image picture = render_picture(queue, scene, camera, settings).picture;
    uint64_t lit = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); i += 3) lit += picture.pixels[i] > 0 ? 1 : 0;
    return lit;
}

/// Returns the size of a view so narrow that one of thousands of samples starts within rounding of an edge. In a
/// picture of the whole scene it would be one of millions. The precision of the file's coordinates limits how narrow
/// it can be.
float narrow(const Placement& place) {
    return min(0.3f, max(2e-4f, 2e-6f * max_component(abs(place.at)) / place.size_m));
}

/// Returns views of the whole box, two edges and a corner.
uint64_t lit_pixels_of_box(const Placement& place) {
    const Scene box = scene_of(cube(), place);
    const PreparedScene scene = prepared_of(box);
    const Vec3 eye = {0.11f, -0.07f, 0.13f};
    const auto samples = static_cast<uint32_t>(effort(8, 256));
    uint64_t lit = lit_pixels(scene, place, {eye, {0.5f, 0.5f, -0.5f}, 1.5f}, 32, samples, 16);
    for (const Vec3 target : {Vec3{0.5f, 0.5f, -0.03f}, {-0.5f, 0.2f, 0.5f}, {0.5f, -0.5f, -0.5f}}) {
        lit += lit_pixels(scene, place, {eye, target, narrow(place)}, 32, samples, 4);
    }
    return lit;
}

/// Tests all positions and rotations of the shape.
template <class LitPixels>
void check_black(Placement place, const LitPixels& lit_pixels_there) {
    CAPTURE(place.size_m);
    CAPTURE(place.at.x);
    for (const Placing placing : kPlacings) {
        CAPTURE(static_cast<int>(placing));
        for (const Transform& turn : kTurns) {
            CAPTURE((turn == Transform{}));
            place.placing = placing, place.turn = turn;
            CHECK(lit_pixels_there(place) == 0);
        }
    }
}

} // namespace

// If origins are moved only along the normal, 72 of the 96 cases below have lit pixels, up to 401 of a box's 4096.

TEST_CASE("no light leaks into a closed box of any position and size") {
    for (const auto& [size_m, at] : {std::pair{2.0f, Vec3{0, 0, 0}},
                                     {2.0f, Vec3{1300, 0, 0}},
                                     {2.0f, Vec3{-700, 300, 1000}},
                                     {0.002f, Vec3{10, 0, 0}},
                                     {0.002f, Vec3{5, -7, 6}},
                                     {2e5f, Vec3{1e8f, 0, 0}}}) {
        check_black({size_m, at, {}}, lit_pixels_of_box);
    }
}

TEST_CASE("no light leaks into a box in a scene with a distant object") {
    for (const auto& [size_m, at, other_at] : {std::tuple{2.0f, Vec3{1300, 0, 0}, Vec3{-1300, 0, 0}},
                                               {2.0f, Vec3{0.3f, 0, 0}, Vec3{900, 10, 2600}},
                                               {0.002f, Vec3{10, 0, 0}, Vec3{-10, 0, 0}}}) {
        check_black({size_m, at, {}, Placing::Vertices, other_at}, lit_pixels_of_box);
    }
}

TEST_CASE("pictures of closed boxes, small or far away, have no lit pixel") {
    for (const auto& [size_m, at] : {std::pair{2.0f, Vec3{1300, 0, 0}}, {0.002f, Vec3{10, 0, 0}}}) {
        for (const Transform& turn : kTurns) {
            const Placement place = {size_m, at, turn};
            const View view = {{0.11f, -0.07f, 0.13f}, {0.5f, 0.5f, -0.5f}, 1.5f};
            CHECK(lit_pixels(prepared_of(scene_of(cube(), place)), place, view, 128,
                             static_cast<uint32_t>(effort(2, 256)), 16) == 0);
        }
    }
}

TEST_CASE("no light leaks in at the sharp edge of a wedge") {
    for (const float slope : {0.9f, 0.36f}) { // 42 and 20 degrees
        CAPTURE(slope);
        const Shape shape = wedge(slope);
        check_black({2, {3, 4, 5}, {}}, [&](const Placement& place) {
            const Vec3 eye = {0.2f, 0.3f * slope - 0.5f, 0.13f};
            const Scene closed = scene_of(shape, place);
            const PreparedScene scene = prepared_of(closed);
            return lit_pixels(scene, place, {eye, {-0.5f, -0.5f, 0.03f}, 1e-4f}, 32, 32, 4) +
                   lit_pixels(scene, place, {eye, {-0.5f, -0.5f, 0.03f}, 1e-2f}, 32, 32, 4);
        });
    }
}

TEST_CASE("no light leaks into a bumpy tube of very uneven triangles") {
    const TriangleMesh torus = make_torus(400, 200);
    const Shape shape = {torus.positions, torus.indices};
    check_black({1, {1300, 0, 0}, {}}, [&](const Placement& place) {
        return lit_pixels(prepared_of(scene_of(shape, place)), place, {{1, 0, 0}, {1.3f, 0.2f, 0.5f}, 1.5f}, 64,
                          static_cast<uint32_t>(effort(4, 64)), 6);
    });
}
