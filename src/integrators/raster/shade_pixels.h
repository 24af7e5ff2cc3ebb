#pragma once

// Last stage of a rasterized sample: shades the visible triangles by Phong's terms: emission, an ambient light, and
// the light of each point, spot and directional light that the diffuse and glossy lobes of the BSDF scatter. There
// are no shadows; mirrors and glass are black.
//
// Sources: Gouraud, "Continuous Shading of Curved Surfaces", IEEE ToC 20(6), 1971; Phong, "Illumination for Computer
// Generated Pictures", CACM 18(6), 1975.

#include "integrators/raster/scan_triangles.h"
#include "render/first_hit.h"
#include "render/raster/local_light.h"

namespace pertev {

template <ShadingVariant kVariant>
struct ShadePixels {
    RasterPass pass;
    FilmView film;

    HD void operator()(uint32_t pixel) const {
        const uint64_t nearest = pass.depths[pixel];
        const auto row = static_cast<int32_t>(pixel / pass.camera.width),
                   column = static_cast<int32_t>(pixel % pass.camera.width);
        const Vec2 position = pass.picture_position(column, row);
        const Ray ray = make_camera_ray(pass.picture.camera.view, position, {});
        if (nearest == kNoDepth) {
            add_no_first_hit(film, pixel, pass.sample);
            return add_radiance(film, pixel, seen_background(pass.picture, ray.direction));
        }
        const auto depth = float_of(static_cast<uint32_t>(nearest >> 32));
        add_radiance(film, pixel, shade(pixel, static_cast<uint32_t>(nearest), depth, position, ray));
    }

private:
    HD Rgb shade(uint32_t pixel, uint32_t number, float depth, Vec2 position, const Ray& ray) const {
        const SceneView& scene = pass.picture.scene;
        TriangleCorners corners = {};
        if (!triangle_corners(pass.camera, scene, number, corners)) return {};
        const Vec2 weights = weights_at(corners.p, pass.camera.x_of(static_cast<double>(position.x)),
                                        pass.camera.y_of(static_cast<double>(position.y)));
        const RasterShading shading = pass.settings.display.shading;
        // The corners (gouraud), the middle of the triangle (flat), and the pixel, which layers always need.
        const Vec2 at[] = {{0, 0}, {1, 0}, {0, 1}, {1.0f / 3, 1.0f / 3}, weights};
        const float of_corner[] = {1 - weights.x - weights.y, weights.x, weights.y};
        Rgb sum = {};
        const int first = pass.settings.display.is_wireframe || shading == RasterShading::Phong ? 4
                          : shading == RasterShading::Gouraud                                   ? 0
                                                                                                : 3;
        for (int k = first; k < 5; ++k) {
            if (k == 3 && shading == RasterShading::Gouraud) continue;
            const Hit hit = {depth, at[k].x, at[k].y, corners.instance, corners.primitive};
            const Vec3 direction = k == 4 || !pass.camera.is_perspective
                                       ? ray.direction
                                       : normalize_or(position_of(hit) - ray.origin, ray.direction);
            Surface surface = make_surface<kVariant>(scene, hit, direction);
            if (k == 4) {
                add_first_hit(film, pixel, pass.sample, {ray.origin, ray.direction}, hit, surface, pass.picture);
                if (pass.settings.display.is_wireframe) return surface.albedo; // lines show their unlit colour
                if (shading != RasterShading::Phong) return sum;
            } else if (k == 3) {
                surface.frame = make_frame(surface.geometric_normal);
                surface.tilt = 0;
            }
            sum +=
                (k < 3 ? of_corner[k] : 1.0f) * local_light<kVariant>(scene.lights, surface, -direction,
                                                                      {pass.settings.ambient, pass.settings.max_depth});
        }
        return sum;
    }
    HD Vec3 position_of(const Hit& hit) const {
        const InstanceView& instance = pass.picture.scene.instances[hit.instance];
        const MeshView& mesh = pass.picture.scene.meshes[instance.mesh];
        const TriangleIndices i = triangle_indices(mesh, hit.primitive);
        return transform_point(instance.world_from_local, interpolate(mesh.positions, i, hit.u, hit.v));
    }
};

} // namespace pertev
