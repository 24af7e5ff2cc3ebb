// Light selection of shade_lanes.inl, in whose anonymous namespaces it is: lights for eight or sixteen receivers at
// once, with the bits that sample_light gives for each (shading/light_set.h, shading/chosen_by_tree.h), and what holes
// of emitters and thin walls leave of their light.

namespace pertev {
namespace {

/// Holds a LightSample of each receiver.
struct Lights {
    Mask arrives, is_delta, has_distance, is_triangle;
    Vec3s wi, point, normal;
    Vec2Of<Floats> weights; // barycentrics of the second and third vertex of a triangle
    Rgbs radiance;
    Floats pdf;
    TriangleId targets[kLanes];
};

/// Holds the selected lights: the data of a triangle and of the draws that select its point, the numbers for a
/// constant environment, or the whole sample of another kind.
struct LightTable {
    enum Field { kA = 0, kAb = 3, kAc = 6, kRadiance = 9, kPdf = 12, kRestX, kOwnedX, kRestY, kOwnedY, kFields };
    static constexpr int kPoint = kA, kWi = kAb; // for another kind of light
    Table<kFields> table;
    WordTable x, y; // triangle: the binary places of both rests; constant environment: its pair of numbers
    TriangleId targets[kLanes];
    uint32_t numbers[kLanes]; // light numbers, for triangles
    unsigned arrive = 0, are_triangles = 0, are_mirrored = 0, are_two_sided = 0, are_delta = 0, have_distance = 0;
    unsigned are_varied = 0;   // triangle whose radiance depends on the point or the direction
    unsigned are_constant = 0; // constant environment
    unsigned are_in_tree = 0;  // triangle that a tree has selected: kRestX and kRestY are both rests
};

/// Enters the lights that lanes select.
struct LightOfLane {
    const LightSetView& view;
    LightTable& to;
    uint32_t lane;

    /// Enters into the lane the light that ChosenByPower draws.
    void enter(Vec3 receiver, SampleBits u) const {
        const LightDraw draw = select_light(view, u);
        switch (draw.kind) {
        case SourceKind::Triangle:
            return enter_triangle(draw);
        case SourceKind::Punctual:
        case SourceKind::Environment:
            enter_source(receiver, draw.source, u);
        }
    }
    /// Enters into the lane a light that is no triangle.
    void enter_source(Vec3 receiver, const CdfDraw& source, SampleBits u) const {
        const float pmf = cdf_pmf(source.owned);
        switch (view.kind_of(source.index)) {
        case SourceKind::Punctual:
            return enter_punctual(receiver, source.index - view.emitter_count, pmf);
        case SourceKind::Triangle: // excluded by the caller
        case SourceKind::Environment:
            break;
        }
        const SampleBits rest = {number_of_rest(source), u.y};
        if (view.environment.is_constant) return enter_constant_environment(pmf, rest);
        LightSample sample;
        if (at(receiver, sample, [&](const auto& to_sample) { return to_sample.environment(pmf, rest); }))
            enter(sample);
    }
    /// Enters into the lane a light that a tree has selected, with its probability among all lights.
    void enter_near(Vec3 receiver, const LightTreeDraw& draw, float pmf, SampleBits u) const {
        if (draw.light == LightTreeDraw::kNoLeaf) return;
        if (draw.light >= view.triangle_count) return enter_punctual(receiver, draw.light - view.triangle_count, pmf);
        enter_triangle(draw.light, pmf);
        to.table.set(F::kRestX, lane, draw.rest), to.table.set(F::kRestY, lane, unit_interval(u.y));
        to.are_in_tree |= 1u << lane;
    }

private:
    using F = LightTable;

    /// Calls `draw` with the functions that sample lights of each kind for the receiver.
    template <class Draw>
    bool at(Vec3 receiver, LightSample& sample, const Draw& draw) const {
        const LightContext context(receiver);
        const EmittersAtRest at_rest;
        return draw(SampleOfKind<EmitterVariant::Coated, EmittersAtRest>{view, context, at_rest, sample});
    }
    void enter_punctual(Vec3 receiver, uint32_t number, float pmf) const {
        LightSample sample;
        if (at(receiver, sample, [&](const auto& to_sample) { return to_sample.punctual(number, pmf); })) enter(sample);
    }
    void enter_triangle(const LightDraw& draw) const {
        enter_triangle(draw.light, view.triangles[draw.light].pmf);
        to.table.set(F::kRestX, lane, static_cast<float>(draw.source.rest));
        to.table.set(F::kOwnedX, lane, static_cast<float>(draw.source.owned));
        to.table.set(F::kRestY, lane, static_cast<float>(draw.triangle.rest));
        to.table.set(F::kOwnedY, lane, static_cast<float>(draw.triangle.owned));
        to.x.at[lane] = draw.source.more, to.y.at[lane] = draw.triangle.more;
    }
    void enter_triangle(uint32_t light, float pmf) const {
        const EmissiveTriangle& from = view.triangles[light];
        const SurfaceEmission& surface = view.emissions[from.material];
        const Rgb radiance = surface.emission;
        const unsigned bit = 1u << lane;
        if (surface.texture.has_image() || surface.coat_weight > 0) to.are_varied |= bit;
        to.numbers[lane] = light;
        to.table.set(F::kA, lane, from.a), to.table.set(F::kAb, lane, from.ab), to.table.set(F::kAc, lane, from.ac);
        to.table.set(F::kRadiance, lane, radiance);
        to.table.set(F::kPdf, lane, pmf);
        to.targets[lane] = {from.instance, from.primitive};
        to.are_triangles |= bit, to.have_distance |= bit;
        if (from.is_mirrored != 0) to.are_mirrored |= bit;
        if (from.is_two_sided != 0) to.are_two_sided |= bit;
        if (!is_black(radiance)) to.arrive |= bit;
    }
    void enter_constant_environment(float pmf, SampleBits rest) const {
        const float pdf = pmf * (0.25f * kInvPi);
        if (view.environment.rows.starts == nullptr || !(pdf > 0)) return; // black
        to.table.set(F::kRadiance, lane, view.environment.constant), to.table.set(F::kPdf, lane, pdf);
        to.x.at[lane] = rest.x, to.y.at[lane] = rest.y;
        to.targets[lane] = {kNoLight, kNoLight};
        to.arrive |= 1u << lane, to.are_constant |= 1u << lane;
    }
    void enter(const LightSample& sample) const {
        const unsigned bit = 1u << lane;
        to.table.set(F::kPoint, lane, sample.light_point), to.table.set(F::kWi, lane, sample.wi);
        to.table.set(F::kRadiance, lane, sample.radiance), to.table.set(F::kPdf, lane, sample.pdf);
        to.targets[lane] = {sample.instance, sample.primitive};
        to.arrive |= bit;
        if (sample.is_delta) to.are_delta |= bit;
        if (sample.distance < kInfinity) to.have_distance |= bit;
    }
};

/// Sets the radiance of lanes whose emitters have textures or coats, and returns the lanes that are dark.
unsigned vary_radiance(const LightSetView& view, const LightTable& drawn, Vec2Of<Floats> b, Vec3s normal, Vec3s wi,
                       Rgbs& radiance) {
    alignas(64) float channels[3][kLanes];
    radiance.r.store(channels[0]), radiance.g.store(channels[1]), radiance.b.store(channels[2]);
    unsigned dark = 0;
    for (unsigned rest = drawn.are_varied; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
        const EmissiveTriangle& t = view.triangles[drawn.numbers[lane]];
        const float u = b.x[lane], v = b.y[lane];
        const Vec2 uv = (1.0f - u - v) * t.uv0 + u * t.uv1 + v * t.uv2;
        const Rgb light = emitted_radiance<EmitterVariant::Coated>(view, t.material, uv,
                                                                   {normal.x[lane], normal.y[lane], normal.z[lane]},
                                                                   {wi.x[lane], wi.y[lane], wi.z[lane]});
        channels[0][lane] = light.r, channels[1][lane] = light.g, channels[2][lane] = light.b;
        if (is_black(light)) dark |= 1u << lane;
    }
    radiance = {Floats::load(channels[0]), Floats::load(channels[1]), Floats::load(channels[2])};
    return dark;
}

/// Draws lights as draw_from_tree, for lanes of receivers.
class TreeDraws {
public:
    TreeDraws(const LightTreeView& tree, const LightReceiverOf<Floats>& to) : tree_(tree), to_(to) {}

    void begin(uint32_t lane, uint64_t number, uint64_t width) {
        descents_[lane] = {number, width};
        going_ |= 1u << lane;
    }
    /// Draws a light for each lane that has begun.
    void finish() {
        const LightTreeNode& root = tree_.nodes[kLightTreeRoot];
        next_.fill(kLightTreeRoot + 1); // a pair of nodes for lanes that have not begun
        for (unsigned rest = going_; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
            const bool is_dark = root.is_leaf() && !(importance_of(root, receiver_of(lane)).most > 0);
            is_dark ? end(lane) : go_to(lane, root);
        }
        while (going_ != 0) {
            alignas(64) float shares[kLanes];
            left_probability(importances(0), importances(1)).store(shares);
            for (unsigned rest = going_; rest != 0; rest &= rest - 1) {
                const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
                const float p = shares[lane];
                if (p < 0) {
                    end(lane);
                } else {
                    go_to(lane, tree_.nodes[next_[lane] + (descents_[lane].goes_right(p) ? 1 : 0)]);
                }
            }
        }
    }

    std::array<LightTreeDraw, kLanes> draws;

private:
    void end(uint32_t lane) { going_ &= ~(1u << lane); }
    void go_to(uint32_t lane, const LightTreeNode& node) {
        if (node.is_instance()) {
            const LightTreeInstance& instance = tree_.instances[node.number()];
            move_receiver(lane, local_receiver(instance, receiver_of(lane)));
            first_lights_[lane] = instance.first_light;
            next_[lane] = tree_.nodes[instance.root].next; // a shared subtree has two leaves or more
        } else if (node.is_leaf()) {
            draws[lane] = descents_[lane].at(first_lights_[lane] + node.number());
            end(lane);
        } else {
            next_[lane] = node.next;
        }
    }
    LightReceiver receiver_of(uint32_t lane) const {
        return {{to_.point.x[lane], to_.point.y[lane], to_.point.z[lane]},
                {to_.normal.x[lane], to_.normal.y[lane], to_.normal.z[lane]}};
    }
    void move_receiver(uint32_t lane, const LightReceiver& to) {
        Table<6> lanes;
        const Floats* const now[] = {&to_.point.x,  &to_.point.y,  &to_.point.z,
                                     &to_.normal.x, &to_.normal.y, &to_.normal.z};
        for (int i = 0; i < 6; ++i) now[i]->store(lanes.at[i]);
        lanes.set(0, lane, to.point), lanes.set(3, lane, to.normal);
        to_ = {lanes.vec3(0), lanes.vec3(3)};
    }
    LightImportanceOf<Floats> importances(uint32_t child) const {
        static_assert(offsetof(LightTreeNode, power) == 12 && offsetof(LightTreeNode, radius) == 16);
        std::array<const float*, kLanes> rows;
        for (uint32_t lane = 0; lane < kLanes; ++lane) rows[lane] = &tree_.nodes[next_[lane] + child].centre.x;
        Floats columns[8];
        load_columns(rows, columns);
        const LightNodeOf<Floats> node = {
            {columns[0], columns[1], columns[2]}, columns[3], columns[4], bits_of(columns[5]), bits_of(columns[6])};
        return importance_of(node, to_);
    }

    const LightTreeView& tree_;
    LightReceiverOf<Floats> to_; // in the space of a shared subtree, once a lane is there
    std::array<LightTreeDescent, kLanes> descents_;
    std::array<uint32_t, kLanes> next_, first_lights_ = {};
    unsigned going_ = 0;
};

/// Enters the lights that ChosenByTree::draw draws, for the receivers of `lanes`.
void enter_by_tree(const LightSetView& view, unsigned lanes, const LightReceiverOf<Floats>& to,
                   const SampleBitsOf<Words>& u, LightTable& drawn) {
    const uint32_t of_near = ChosenByTree::numbers_of_near(view);
    TreeDraws near(view.tree, to);
    unsigned are_near = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
        const SampleBits bits = {u.x[lane], u.y[lane]};
        const uint32_t more = bits_behind(bits), number = bits.x >> 1;
        if (number < of_near) {
            near.begin(lane, uint64_t(number) << 32 | more, uint64_t(of_near) << 32);
            are_near |= 1u << lane;
        } else {
            const Vec3 receiver = {to.point.x[lane], to.point.y[lane], to.point.z[lane]};
            LightOfLane{view, drawn, lane}.enter_source(receiver, draw_ordered(view.choice, bits.x, more), bits);
        }
    }
    near.finish();
    for (; are_near != 0; are_near &= are_near - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(are_near));
        const Vec3 receiver = {to.point.x[lane], to.point.y[lane], to.point.z[lane]};
        const LightTreeDraw& draw = near.draws[lane];
        LightOfLane{view, drawn, lane}.enter_near(receiver, draw, cdf_pmf(of_near) * draw.pmf, {u.x[lane], u.y[lane]});
    }
}

/// Samples lights as sample_light, for the receivers of `lanes`. `normal_of_context` is that of their contexts.
template <Features kFeatures>
void sample_lights(const LightSetView& view, unsigned lanes, Vec3s position, Vec3s normal_of_context,
                   const SampleBitsOf<Words>& u, Lights& lights) {
    LightTable drawn;
    if constexpr ((kFeatures & kLightTree) != 0) {
        enter_by_tree(view, lanes, {position, normal_of_context}, u, drawn);
    } else {
        for (; lanes != 0; lanes &= lanes - 1) {
            const auto lane = static_cast<uint32_t>(__builtin_ctz(lanes));
            const Vec3 receiver = {position.x[lane], position.y[lane], position.z[lane]};
            LightOfLane{view, drawn, lane}.enter(receiver, {u.x[lane], u.y[lane]});
        }
    }
    const auto& table = drawn.table;
    lights.arrives = Mask::of_bits(drawn.arrive);
    lights.is_delta = Mask::of_bits(drawn.are_delta);
    lights.has_distance = Mask::of_bits(drawn.have_distance);
    lights.is_triangle = Mask::of_bits(drawn.are_triangles);
    lights.radiance = table.rgb(LightTable::kRadiance);
    lights.wi = table.vec3(LightTable::kWi), lights.point = table.vec3(LightTable::kA);
    lights.pdf = table.get(LightTable::kPdf);
    lights.normal = {0, 0, 0};
    for (uint32_t lane = 0; lane < kLanes; ++lane) lights.targets[lane] = drawn.targets[lane];
    if (drawn.are_constant != 0) {
        const Vec3s wi = sample_constant_environment<Floats>(view.environment, {drawn.x.get(), drawn.y.get()});
        lights.wi = select(Mask::of_bits(drawn.are_constant), wi, lights.wi);
    }
    if (drawn.are_triangles == 0) return;
    // The next lines repeat LightDraw::weights.
    const auto rest_at = [&](int rest, const WordTable& more) {
        return rest_of<Floats>(table.get(rest), table.get(rest + 1), more.get());
    };
    Vec2Of<Floats> rests = {rest_at(LightTable::kRestX, drawn.x), rest_at(LightTable::kRestY, drawn.y)};
    if constexpr ((kFeatures & kLightTree) != 0) {
        const Mask is_in_tree = Mask::of_bits(drawn.are_in_tree);
        rests.x = select(is_in_tree, table.get(LightTable::kRestX), rests.x);
        rests.y = select(is_in_tree, table.get(LightTable::kRestY), rests.y);
    }
    const Vec2Of<Floats> b = sample_uniform_triangle(rests);
    // The rest repeats triangle_light_at.
    const Vec3s ab = table.vec3(LightTable::kAb), ac = table.vec3(LightTable::kAc);
    const Vec3s point = lights.point + (b.x * ab + b.y * ac);
    const Vec3s to_light = point - position;
    const Floats distance_squared = length_squared(to_light), distance = sqrt(distance_squared);
    const Vec3s wi = to_light / distance;
    const Vec3s normal = cross(ab, ac);
    const Mask emits =
        Mask::of_bits(drawn.are_two_sided) || (dot(normal, wi) < 0) == !Mask::of_bits(drawn.are_mirrored);
    const Floats pdf = lights.pdf * triangle_pdf(normal, wi, distance_squared);
    const Mask is_triangle = lights.is_triangle;
    lights.arrives = lights.arrives && (!is_triangle || (emits && pdf > 0 && is_finite(pdf)));
    if (drawn.are_varied != 0) {
        const unsigned dark = vary_radiance(view, drawn, b, normal, wi, lights.radiance);
        lights.arrives = lights.arrives && !Mask::of_bits(dark);
    }
    lights.weights = b;
    lights.point = select(is_triangle, point, lights.point);
    lights.wi = select(is_triangle, wi, lights.wi);
    lights.normal = select(is_triangle, normalize(normal), lights.normal);
    lights.pdf = select(is_triangle, pdf, lights.pdf);
}

/// Returns the scene of all lanes, whose paths are of one.
const SceneView& scene_of(const PathJob& job, const LaneVertices& vertices) {
    return job.picture.scene_of(vertices.paths[0]->pixel);
}

/// Returns the lanes whose light is not in a transparent part of an emitter.
unsigned without_holes(const PathJob& job, unsigned lanes, const LaneVertices& vertices, const Lights& lights) {
    const SceneView& scene = scene_of(job, vertices);
    if (scene.any_alpha == 0) return lanes;
    for (unsigned rest = lanes & bit_mask(lights.is_triangle); rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
        const PathState& path = *vertices.paths[lane];
        const uint32_t key = coin_key(sample_key<kBatched>(job, path.pixel, path.sample), path.depth, true);
        LightSample light;
        light.instance = lights.targets[lane].instance, light.primitive = lights.targets[lane].primitive;
        light.b1 = lights.weights.x[lane], light.b2 = lights.weights.y[lane];
        if (is_hole(scene, light, key)) lanes &= ~(1u << lane);
    }
    return lanes;
}

/// Lets the light of `lanes` through the thin walls on their shadow rays, of which `rays` has origin, direction and
/// t_max, as sample_direct does. `behind` gets the lanes with walls. Returns the lanes whose light still arrives. It is
/// called, because few scenes need its code, and it is long.
[[gnu::noinline]] unsigned pass_thin_walls(const PathJob& job, unsigned lanes, const LaneVertices& vertices,
                                           const float (&rays)[kLanes][8], Rgbs& arriving, unsigned& behind) {
    Table<3> table;
    arriving.r.store(table.at[0]), arriving.g.store(table.at[1]), arriving.b.store(table.at[2]);
    for (unsigned rest = lanes; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint32_t>(__builtin_ctz(rest));
        const float* const row = rays[lane];
        const Ray ray = {{row[0], row[1], row[2]}, 0.0f, {row[3], row[4], row[5]}, row[6]};
        const PassedWalls walls = pass_thin_walls(scene_of(job, vertices), ray);
        const uint32_t scatterings = vertices.paths[lane]->depth + 1 + walls.count;
        if (is_black(walls.transmittance) || scatterings > job.settings.max_depth) lanes &= ~(1u << lane);
        if (walls.count != 0) behind |= 1u << lane;
        table.set(0, lane, walls.transmittance * Rgb{table.at[0][lane], table.at[1][lane], table.at[2][lane]});
    }
    arriving = table.rgb(0);
    return lanes;
}

} // namespace
} // namespace pertev
