#pragma once

// TwoNodeTree is a light tree of a root and two leaves, the two emissive instances of a scene: it selects lights by
// the shading context. The environment has its own share, and there are no punctual lights.
//
// Source: Conty Estevez, Kulla, "Importance Sampling of Many Lights with Adaptive Tree Splitting", HPG 2018, section 5:
// a node's importance is its power times the cosine towards it, divided by the squared distance.

#include "device/atomics.h"
#include "integrators/path/film_listener.h"
#include "tests/seams/path_rounds.h"

namespace pertev::test {

struct TwoNodeTree {
    static constexpr bool kReadsNormal = true;

    template <class ToKind>
    HD static bool draw(const LightSetView& view, const LightContext& context, SampleBits u, const ToKind& to) {
        const float sky = pmf_of_environment(view, context);
        float x = unit_interval(u.x);
        if (x < sky) {
            const auto column = static_cast<uint32_t>(to_int(0x1p24f * (x / sky), 0, (1 << 24) - 1)) << 8;
            return to.environment(sky, SampleBits{column, u.y});
        }
        x = (x - sky) / (1.0f - sky);
        const float first = share_of_first(view, context);
        const uint32_t node = x < first ? 0 : 1;
        const float rest = node == 0 ? x / first : (x - first) / (1.0f - first);
        const Emitter& emitter = view.emitters[node];
        const CdfDraw triangle = draw_ordered(view.triangles_of(node), u.y, bits_behind(u));
        const uint32_t light = emitter.first_triangle + view.triangle_order[emitter.first_triangle + triangle.index];
        return to.triangle(light, sample_uniform_triangle(Vec2{min(rest, 0x1.fffffep-1f), rest_of(triangle)}),
                           pmf_of_triangle(view, context, light));
    }
    HD static float pmf_of_triangle(const LightSetView& view, const LightContext& context, uint32_t light) {
        const uint32_t first = view.emitters[0].first_triangle;
        const uint32_t node = light >= first && light < first + view.emitters[0].triangle_count ? 0 : 1;
        const float share = share_of_first(view, context), sky = pmf_of_environment(view, context);
        const float of_node = (1.0f - sky) * (node == 0 ? share : 1.0f - share);
        return of_node *
               (view.triangles[light].pmf / cdf_pmf(view.choice, node)); // the light of the table, within the node
    }
    HD static float pmf_of_environment(const LightSetView& view, const LightContext&) {
        return view.has_environment() ? 0.3f : 0.0f;
    }

private:
    HD static float importance(const LightSetView& view, const LightContext& context, uint32_t node) {
        const EmissiveTriangle& triangle = view.triangles[view.emitters[node].first_triangle];
        const Vec3 to_node = triangle.a + 0.5f * (triangle.ab + triangle.ac) - context.point;
        const float size = length_squared(triangle.ab) + length_squared(triangle.ac);
        const float squared = max(length_squared(to_node), size);
        const float cosine =
            context.normal == Vec3{0, 0, 0} ? 1.0f : max(dot(to_node, context.normal) / sqrt(squared), 0.0f);
        return cdf_pmf(view.choice, node) * (cosine + 0.05f) / squared; // lights have an area
    }
    HD static float share_of_first(const LightSetView& view, const LightContext& context) {
        const float first = importance(view, context, 0);
        return first / (first + importance(view, context, 1));
    }
};

/// The feature of code that selects lights by the tree. The product has no such code.
inline constexpr Features kTwoNodeTree = 1u << 31;

/// A listener for emitters that paths hit. It tests that their density is that of the tree at the previous vertex,
/// except for the offset of the ray's origin.
struct DensityJob : PathJob {
    uint32_t *right, *wrong; // one counter each
};
class DensityListener : public PathListener<DensityListener> {
public:
    struct PathData {
        Vec3 point, normal;
        bool lets_through;
    };

    HD explicit DensityListener(const DensityJob& job) : job_(job) {}
    HD void restore(const PathData& kept) { kept_ = kept; }
    HD bool removes_emission(const PathState& path, const EmitterPoint& point, float pdf) {
        if (path.bsdf_pdf > 0) {
            const float off = abs(pdf - density_of(point)) / pdf;
            atomic_add(off < 1e-3f ? job_.right : job_.wrong, 1u);
        }
        return false;
    }
    template <class Vertex>
    HD void scattered(const PathState&, const Vertex& at, const BsdfSample&) {
        const Vec3 normal = at.surface.frame.normal;
        kept_ = {at.surface.position, dot(at.wo, normal) < 0 ? -normal : normal, at.surface.bsdf.lets_through()};
    }
    HD void save(PathData& kept) const { kept = kept_; }

private:
    HD float density_of(const EmitterPoint& point) const {
        const LightSetView& lights = job_.picture.scene.lights;
        const LightContext context = {kept_.point, kept_.normal, kept_.lets_through, kAtRest};
        if (point.kind() == SourceKind::Environment) {
            const Vec3 direction = {float_of(point.index), point.u, point.v};
            return find_environment<TwoNodeTree>(lights, context, direction, true).pdf;
        }
        const uint32_t light = light_of(lights, point.instance, point.index);
        const EmissiveTriangle& triangle = lights.triangles[light];
        const Vec3 position = triangle.a + (point.u * triangle.ab + point.v * triangle.ac);
        return pdf_light_hit<TwoNodeTree>(lights, light, context, position);
    }

    const DensityJob& job_;
    PathData kept_ = {};
};

using TableRounds = PathRounds<kPlainDiffuse, FilmListeners>;
using TreeRounds = PathRounds<kPlainDiffuse | kTwoNodeTree, FilmListeners>;
using DensityRounds = PathRounds<kPlainDiffuse | kTwoNodeTree, Listeners<DensityListener>, DensityJob>;

} // namespace pertev::test

namespace pertev {
template <>
struct LightChoice<kPlainDiffuse | test::kTwoNodeTree> : test::TwoNodeTree {};

extern template class test::PathRounds<kPlainDiffuse, FilmListeners>; // seam_stages.cu
extern template class test::PathRounds<kPlainDiffuse | test::kTwoNodeTree, FilmListeners>;
extern template class test::PathRounds<kPlainDiffuse | test::kTwoNodeTree, Listeners<test::DensityListener>,
                                       test::DensityJob>;
} // namespace pertev
