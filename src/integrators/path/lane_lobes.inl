// BSDFs of shade_lanes.inl, in whose anonymous namespaces they are, for eight or sixteen vertices at once, with the
// bits that Bsdf (shading/bsdf.h) gives for each. `evaluate` is Bsdf::evaluate, and `draw` Bsdf::sample without the
// value.

namespace pertev {
namespace {

/// BsdfValue of lobes that are not delta.
struct Values {
    Rgbs f;
    Floats pdf; // 0: f is not set
};

/// Direction that a lobe has drawn.
struct DrawnDirections {
    Vec3s wi;
    Mask is_drawn;
};

/// One diffuse lobe.
struct DiffuseLobes {
    static constexpr bool kHasChoices = false; // draws by u_lobe
    Rgbs albedo;

    DiffuseLobes(const SceneView&, const LaneVertices&, Rgbs colors) : albedo(colors) {}

    void see_from(Vec3s) {}
    Values evaluate(Vec3s wo, Vec3s wi) const {
        const Floats pdf = select(wo.z * wi.z > 0, abs(wi.z) * kInvPi, Floats(0.0f));
        return {pdf * albedo, pdf};
    }
    DrawnDirections draw(Vec3s wo, Floats, Vec2Of<Floats> u) const {
        Vec3s wi = sample_cosine_hemisphere(u);
        wi.z = copysign(wi.z, wo.z);
        return {wi, true};
    }
};

/// The reflection of metallic-roughness, which is not smooth, on a diffuse lobe or none (make_metallic_roughness).
class GlossyLobes {
public:
    static constexpr bool kHasChoices = true;

    GlossyLobes(const SceneView& scene, const LaneVertices& vertices, Rgbs colors) {
        enum Field { kMetallic, kAlpha, kF0, kFields };
        Table<kFields> table;
        for (uint32_t lane = 0; lane < kLanes; ++lane) {
            const Hit& hit = *vertices.hits[lane];
            const InstanceView& instance = scene.instances[hit.instance];
            const MeshView& mesh = scene.meshes[instance.mesh];
            const MaterialParameters& material = scene.materials[instance.material];
            const TriangleIndices i = triangle_indices(mesh, hit.primitive);
            table.set(kMetallic, lane,
                      textured_share(scene, mesh, material.metallic, material.metallic_texture, i, hit.u, hit.v));
            table.set(kAlpha, lane, ggx_width_at(scene, hit));
            table.set(kF0, lane, f0_from_ior(material.ior));
        }
        const Floats metallic = table.get(kMetallic);
        reflection_ = {colors, metallic, table.get(kAlpha), table.get(kF0)};
        share_ = 1.0f - metallic;
        has_base_ = metallic < 1 && !is_black(colors);
        beneath_ = select(has_base_, share_ * max_component(colors), Floats(0.0f));
        average_ = reflection_.make_average();
    }

    /// Sets wo of the following calls.
    void see_from(Vec3s wo) {
        at_o_ = reflection_.albedo_at(abs(wo.z), average_);
        shares_ = reflection_.make_shares(average_, at_o_, beneath_, abs(wo.z));
    }
    Values evaluate(Vec3s wo, Vec3s wi) const {
        const Vec3s o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const auto at_i = reflection_.albedo_at(i.z, average_);
        const GgxReflectionOf<Floats> once = evaluate_ggx_reflection(o, i, reflection_.alpha);
        const Rgbs glossy = reflection_.value_of(once, i.z, average_, at_o_, at_i);
        const Floats cosine = i.z * kInvPi;
        const Floats near = 1.0f - at_o_.coat, far = 1.0f - at_i.coat, average = 1.0f - average_.coat;
        const Rgbs diffuse = (cosine * share_ * near * far / average) * reflection_.base_color;
        const Rgbs f = select(has_base_, glossy + diffuse, glossy);
        const Floats glossy_pdf = reflection_.pdf_of(once, i.z, shares_.specular, shares_.more);
        const Floats pdf = select(has_base_, glossy_pdf + shares_.beneath * cosine, glossy_pdf);
        return {f, select(wo.z * wi.z > 0, pdf, Floats(0.0f))};
    }
    DrawnDirections draw(Vec3s wo, Floats u_lobe, Vec2Of<Floats> u) const {
        const Mask is_beneath = u_lobe < shares_.beneath,
                   is_more = !is_beneath && u_lobe - shares_.beneath < shares_.more;
        const Vec3s o = {wo.x, wo.y, abs(wo.z)};
        const Vec3s reflected = normalize(reflect(o, sample_ggx_visible_normal(o, reflection_.alpha, u)));
        Vec3s wi = select(is_beneath, sample_cosine_hemisphere(u), reflected);
        if (const unsigned more = bit_mask(is_more); more != 0) wi = select(is_more, draw_more(more, u), wi);
        const Mask is_drawn = is_beneath || is_more || reflected.z > 0;
        wi.z = copysign(wi.z, wo.z);
        return {wi, is_drawn};
    }

private:
    /// Draws the few directions of light that bounces between microfacets, one by one.
    Vec3s draw_more(unsigned lanes, Vec2Of<Floats> u) const {
        Table<3> drawn = {};
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
            drawn.set(0, lane, sample_metal_lost(reflection_.alpha[lane], Vec2{u.x[lane], u.y[lane]}));
        }
        return drawn.vec3(0);
    }

    SchlickLobeOf<Floats> reflection_;
    Floats share_, beneath_; // share of the colour, and energy, of the diffuse lobe
    Mask has_base_;          // there is a diffuse lobe
    SchlickLobeOf<Floats>::Average average_;
    SchlickLobeOf<Floats>::Albedo at_o_;
    LayerSharesOf<Floats> shares_;
};

} // namespace
} // namespace pertev
