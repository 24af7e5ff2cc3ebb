// Rows of form factors by hemicubes (radiosity/hemicube.h). Emitters are patches like others; the environment and
// lights that no triangle is are found by shadow rays.

#include <memory>

#include "base/error.h"
#include "radiosity/hemicube.h"
#include "radiosity/light_rays.h"

namespace pertev {
namespace {

using PlacedCorners = HemicubeScene::PlacedCorners;

constexpr uint64_t kWorkOfTriangle = 8, kWorkOfCheck = 1u << 17; // work between two queries of the watch

std::vector<PlacedCorners> all_triangles(const SceneView& scene) {
    std::vector<PlacedCorners> all;
    all.reserve(scene.triangle_count);
    for (uint32_t instance = 0; instance < scene.instance_count; ++instance) {
        const InstanceView& placed = scene.instances[instance];
        if (placed.is_hidden != 0) continue;
        const uint32_t count = scene.first_triangle[instance + 1] - scene.first_triangle[instance];
        const MeshView& mesh = scene.meshes[placed.mesh];
        for (uint32_t primitive = 0; primitive < count; ++primitive) {
            const TriangleIndices i = triangle_indices(mesh, primitive);
            const auto world_position = [&](uint32_t v) {
                return transform_point(placed.world_from_local, mesh.positions[v]);
            };
            all.push_back({{world_position(i.a), world_position(i.b), world_position(i.c)}, instance, primitive});
        }
    }
    return all;
}

struct SeenAt {
    uint32_t instance, primitive;
    float u, v;
};

class HemicubeRows final : public RowMaker {
public:
    HemicubeRows(const RowScene& scene, const RadiositySettings& settings, const HemicubeScene& hemicube)
        : scene_(scene), seed_(settings.seed), hemicube_(hemicube) {
        if (scene.scene.view().lights.choice.starts != nullptr) rays_.count = max(settings.rays / 4, kMinPatchRays);
    }

    void make(const Patch& patch, uint32_t number, FormFactorRow& row) override {
        row.clear();
        const SceneView& view = scene_.scene.view();
        const WorldTriangle triangle = world_triangle(view, patch, patch.corners.middle());
        const Frame frame = make_frame(normal_of(view, patch, triangle));
        const SampleKey key = {number, 0, seed_};
        for (uint32_t face = 0; face < HemicubePixels::kFaces; ++face) {
            if (scene_.is_over()) return;
            add_face(hemicube_.pixels.face(frame, face), patch, triangle.position, frame.normal, key, row);
        }
        if (rays_.count > 0) add_light_rays(scene_, patch, key, rays_, row);
        row.sort();
    }

private:
    void add_face(const HemicubePixels::Face& face, const Patch& patch, Vec3 middle, Vec3 normal, SampleKey key,
                  FormFactorRow& row) {
        const SceneView& view = scene_.scene.view();
        depths_.assign(std::size_t(face.width) * face.height, 1e300);
        seen_.resize(depths_.size());
        uint64_t work = 0; // pixels, about
        for (const PlacedCorners& placed : hemicube_.triangles) {
            if (work > kWorkOfCheck) {
                if (scene_.is_over()) return;
                work = 0;
            }
            work += kWorkOfTriangle;
            if (placed.instance == patch.instance && placed.primitive == patch.primitive) continue;
            const Vec3 corners[] = {placed.at[0] - middle, placed.at[1] - middle, placed.at[2] - middle};
            if (!(max(dot(corners[0], normal), max(dot(corners[1], normal), dot(corners[2], normal))) > 0)) continue;
            HemicubeTriangle seen;
            if (!project_to_face(face, corners, seen)) continue;
            draw(face, placed, seen, key);
            work += uint64_t(seen.x1 - seen.x0) * (seen.y1 - seen.y0);
        }
        for (std::size_t pixel = 0; pixel < depths_.size(); ++pixel) {
            if (!(depths_[pixel] < 1e300)) continue;
            const SeenAt& at = seen_[pixel];
            const auto row_of = static_cast<uint32_t>(pixel / face.width);
            const auto column = static_cast<uint32_t>(pixel % face.width);
            const auto x = static_cast<float>(pixel_coordinate(column, face.width, -1, 2));
            const auto y = static_cast<float>(pixel_coordinate(row_of, face.height, face.lowest, 1 - face.lowest));
            const uint32_t side =
                hit_side(view, at.instance, at.primitive, face.forward + x * face.right + y * face.up);
            Vec3 weights = {1.0f - at.u - at.v, at.u, at.v};
            const PatchCode hit_patch =
                scene_.sources.view().find(face_of(view, at.instance, at.primitive, side), weights);
            if (is_patch(hit_patch)) row.factors.push_back({number_of(hit_patch), face.shares[pixel]});
        }
    }

    /// Draws a triangle. A pixel keeps the nearest; of two at one depth, the first.
    void draw(const HemicubePixels::Face& face, const PlacedCorners& placed, const HemicubeTriangle& seen,
              SampleKey key) {
        const SceneView& view = scene_.scene.view();
        for (uint32_t row = seen.y0; row < seen.y1; ++row) {
            const double y = pixel_coordinate(row, face.height, face.lowest, 1 - face.lowest);
            for (uint32_t column = seen.x0; column < seen.x1; ++column) {
                const std::size_t pixel = std::size_t(row) * face.width + column;
                double weights[3], depth;
                if (!seen.covers(pixel_coordinate(column, face.width, -1, 2), y, weights, depth)) continue;
                if (!(depth < depths_[pixel])) continue;
                const auto u = static_cast<float>(weights[1]), v = static_cast<float>(weights[2]);
                if (view.any_alpha != 0) {
                    const uint32_t coin = coin_key({key.stream, static_cast<uint32_t>(pixel), key.seed}, 0, false);
                    if (!AcceptHit{view, {}, {}, coin}.passes_alpha(placed.instance, placed.primitive, u, v)) continue;
                }
                depths_[pixel] = depth;
                seen_[pixel] = {placed.instance, placed.primitive, u, v};
            }
        }
    }

    RowScene scene_;
    uint32_t seed_;
    const HemicubeScene& hemicube_;
    LightRays rays_;
    std::vector<double> depths_;
    std::vector<SeenAt> seen_;
};

} // namespace

std::size_t max_hemicube_bytes(uint32_t resolution) {
    return std::size_t(resolution) * resolution * (sizeof(double) + sizeof(SeenAt));
}

HemicubeScene::HemicubeScene(const SceneView& scene, uint32_t resolution)
    : triangles(all_triangles(scene)), pixels(resolution) {}

std::unique_ptr<RowMaker> make_hemicube_rows(const RowScene& scene, const RadiositySettings& settings,
                                             const HemicubeScene& hemicube) {
    return std::make_unique<HemicubeRows>(scene, settings, hemicube);
}

} // namespace pertev
