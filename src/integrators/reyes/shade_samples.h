#pragma once

// Last stage of a pass: each sample shows its nearest micropolygon. A micropolygon has a single colour, that of its
// middle, so it depends only on the scene and the camera, and samples of a pixel that share it are shaded once.
//
// A displaced micropolygon is lit with its own normal, rotated as interpolation rotates the normal of the undisplaced
// triangle, so that smooth meshes stay smooth.

#include "integrators/reyes/split_stages.h"
#include "render/first_hit.h"

namespace pertev {

/// A micropolygon, reconstructed from its triangle and its path of splits.
struct Micropolygon {
    DicedTriangle triangle;
    Piece piece;
    DicedPoint points[3];

    HD bool begin(const ReyesPass& pass, uint32_t number, uint64_t split_path) {
        if (!triangle.begin(pass.camera, pass.picture.scene, pass.displacements, number)) return false;
        piece = whole_triangle(number);
        for (;;) {
            for (int k = 0; k < 3; ++k) points[k] = triangle.point(pass.camera.is_perspective, piece.corners[k]);
            const uint32_t edges = piece.level < kMaxLevels ? long_edges(pass, triangle, points) : 0;
            if (edges == 0) return true;
            piece = child_of(piece, edges, child_on_path(split_path, piece.level));
        }
    }

    /// Displaced position in the world.
    HD DoubleVec3 world_position(Vec2 at) const {
        const MeshView& mesh = *triangle.mesh;
        const TriangleIndices i = triangle.indices;
        const auto u = static_cast<double>(at.x), v = static_cast<double>(at.y), w = 1 - u - v;
        const DoubleVec3 a = to_double(mesh.positions[i.a]), b = to_double(mesh.positions[i.b]),
                         c = to_double(mesh.positions[i.c]);
        DoubleVec3 p = {w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y, w * a.z + u * b.z + v * c.z};
        if (triangle.displacement != nullptr) {
            const DoubleVec3 by = triangle.moved(at);
            p = {p.x + by.x, p.y + by.y, p.z + by.z};
        }
        const Transform& m = triangle.placed->world_from_local;
        const DoubleVec3 t = to_double(m.translation);
        return {dot(to_double(m.row0), p) + t.x, dot(to_double(m.row1), p) + t.y, dot(to_double(m.row2), p) + t.z};
    }

    /// Surface at weights `at` of the triangle, where `inside` are the weights in the micropolygon itself.
    /// `direction` is unit, from the eye.
    HD Surface surface(const SceneView& scene, Vec2 at, Vec2 inside, Vec3 direction) const {
        const TriangleCorners& of = triangle.corners;
        Surface s = make_surface(scene, {0, at.x, at.y, of.instance, of.primitive}, direction);
        if (triangle.displacement == nullptr) return s;
        const DoubleVec3 a = world_position(piece.corners[0]);
        const DoubleVec3 ab = world_position(piece.corners[1]) - a, ac = world_position(piece.corners[2]) - a;
        const Vec3 bare = bare_normal();
        const bool is_turned = dot(bare, s.geometric_normal) < 0; // vertex normals define the other side as the
                                                                  // front
        const float sign = (triangle.placed->is_mirrored != 0) != is_turned ? -1.0f : 1.0f;
        const DoubleVec3 across = cross(ab, ac);
        const double length = ::sqrt(dot(across, across));
        const Vec3 normal = length > 0 ? sign * to_float(across / length) : s.geometric_normal;
        const double u = static_cast<double>(inside.x), v = static_cast<double>(inside.y);
        s.position =
            to_float(DoubleVec3{a.x + u * ab.x + v * ac.x, a.y + u * ab.y + v * ac.y, a.z + u * ab.z + v * ac.z});
        s.frame = make_frame(normalize_or(normal + (s.frame.normal - s.geometric_normal), normal));
        s.geometric_normal = normal;
        s.tilt = 0;
        return s;
    }

    /// The micropolygon's single colour towards the eye, W/(sr m2).
    HD Rgb color(const ReyesPass& pass) const {
        const CameraRays& camera = pass.picture.camera;
        constexpr float kThird = 1.0f / 3;
        const Vec2 middle = middle_of(piece);
        Vec3 direction = camera.axis;
        if (pass.camera.is_perspective) {
            direction = normalize_or(to_float(world_position(middle) - pass.camera.eye), camera.axis);
        }
        const Surface s = surface(pass.picture.scene, middle, {kThird, kThird}, direction);
        return local_light<ShadingVariant::General>(pass.picture.scene.lights, s, -direction, pass.light);
    }

private:
    /// Normal of the undisplaced triangle, by its winding.
    HD Vec3 bare_normal() const {
        const MeshView& mesh = *triangle.mesh;
        const Transform& m = triangle.placed->world_from_local;
        const TriangleIndices i = triangle.indices;
        const Vec3 a = mesh.positions[i.a], ab = transform_vector(m, mesh.positions[i.b] - a),
                   ac = transform_vector(m, mesh.positions[i.c] - a);
        const float size = max(max_component(abs(ab)), max_component(abs(ac)));
        const Vec3 across = cross((1.0f / size) * ab, (1.0f / size) * ac);
        return triangle.placed->is_mirrored != 0 ? -across : across;
    }
};

/// The stage that shades all samples of a pixel.
struct ShadeSamples {
    ReyesPass pass;
    FilmView film;

    HD void operator()(uint32_t pixel) const {
        const SampleLists& samples = pass.samples;
        Micropolygon seen;
        uint64_t split_path = kNoSplitPath;
        uint32_t number = kNoHit;
        Rgb color = {};
        for (uint32_t s = 0; s < samples.count; ++s) {
            const uint32_t i = s * samples.pixels() + pixel;
            constexpr float kStep = 1.0f / static_cast<float>(kSubpixels);
            const SamplePosition at = samples.positions[i];
            const Vec2 position = {kStep * static_cast<float>(at.x), kStep * static_cast<float>(at.y)};
            const Ray ray = make_camera_ray(pass.picture.camera.view, position, {});
            const uint64_t nearest = samples.nearest[i];
            if (nearest == kNothingThere) {
                add_no_first_hit(film, pixel, samples.first + s);
                add_radiance(film, pixel, seen_background(pass.picture, ray.direction));
                continue;
            }
            const auto triangle = static_cast<uint32_t>(nearest);
            if (triangle != number || samples.split_paths[i] != split_path) {
                number = triangle, split_path = samples.split_paths[i];
                if (!seen.begin(pass, number, split_path)) continue;
                color = seen.color(pass);
            }
            add_layers(pixel, samples.first + s, seen, position, ray);
            add_radiance(film, pixel, color);
        }
    }

private:
    HD void add_layers(uint32_t pixel, uint32_t sample, const Micropolygon& seen, Vec2 position, const Ray& ray) const {
        const bool is_background = shows_background(pass.picture.scene, seen.triangle.corners.instance);
        if (film.aovs == 0 && !is_background) return add_channel(film, pixel, kFilmHits, 1.0f);
        const PinholePoint corners[3] = {seen.points[0].position, seen.points[1].position, seen.points[2].position};
        const Vec2 inside = weights_at(corners, pass.camera.x_of(static_cast<double>(position.x)),
                                       pass.camera.y_of(static_cast<double>(position.y)));
        const Vec2* c = seen.piece.corners;
        const Vec2 at = c[0] + (inside.x * (c[1] - c[0]) + inside.y * (c[2] - c[0]));
        const TriangleCorners& of = seen.triangle.corners;
        const Hit hit = {0, at.x, at.y, of.instance, of.primitive};
        add_first_hit(film, pixel, sample, {ray.origin, ray.direction}, hit,
                      seen.surface(pass.picture.scene, at, inside, ray.direction), pass.picture);
    }
};

} // namespace pertev
