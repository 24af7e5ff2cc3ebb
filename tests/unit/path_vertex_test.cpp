// Path vertices: listeners receive each in order and do not change the light, and each feature mask selects the
// smallest variant that contains it.

#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "integrators/path/compiled_features.h"
#include "integrators/path/path_code.h"
#include "integrators/path/path_vertex.h"
#include "render/prepare_scene.h"
#include "tests/support/flat_scenes.h"

using namespace pertev;

namespace {

/// Records its calls with the depth of the path.
class Witness : public PathListener<Witness> {
public:
    struct PathData {
        uint32_t vertices = 0;
    };
    struct ShadowData {
        Rgb contribution;
    };

    explicit Witness(const PathJob&) {}
    void begins(const PathState&) { kept_ = {}; }
    void restore(const PathData& kept) { kept_ = kept; }
    void vertex(const PathState& path, const Hit&, Surface&) {
        ++kept_.vertices;
        record("vertex", path);
    }
    void missed(const PathState& path) { record("missed", path); }
    void emitted(const PathState& path, Rgb light) {
        record("emitted", path);
        found = light;
    }
    void direct(const PathState& path, const SurfaceVertex&, Vec3, const ShadowRay& shadow) {
        record("direct", path);
        shadow_data_ = {shadow.contribution};
    }
    void scattered(const PathState& path, const SurfaceVertex&, const BsdfSample&) { record("scattered", path); }
    void save(PathData& kept) const { kept = kept_; }
    void save_shadow_data(ShadowData& shadow_data) const { shadow_data = shadow_data_; }

    std::vector<std::string> events;
    Rgb found;

private:
    void record(const char* what, const PathState& path) {
        events.push_back(std::string(what) + " " + std::to_string(path.depth));
    }
    PathData kept_;
    ShadowData shadow_data_;
};

/// Receives the light that rays hit, and refuses shadow rays.
class Thief : public PathListener<Thief> {
public:
    explicit Thief(const PathJob&) {}
    bool removes_emission(const PathState&, const EmitterPoint& point, float) {
        point_ = point;
        return true;
    }
    bool samples_direct(const PathState&, const Hit&, const Surface&) { return false; }
    EmitterPoint point_;
};

/// A white, emissive floor under a bright sky.
struct LitFloor {
    Scene scene = glowing_floor();
    Messages messages;
    Queue queue = Queue::make_cpu();
    PreparedScene prepared;
    SceneOnDevice device;
    PathJob job = {};

    static Scene glowing_floor() {
        Scene scene;
        Material material = test::white(0.5f);
        material.emission = {1, 2, 3};
        test::add(scene, test::floor_at(0, 1), material);
        scene.environment.emplace();
        return scene;
    }
    LitFloor() : prepared(prepare_scene(scene, {}, messages)), device(queue, prepared) {
        job.picture.scene = device.view();
        job.settings.sampler = SamplerKind::Independent;
    }
};

PathState path_down() {
    PathState path;
    path.origin = {0.1f, 1, 0.2f};
    path.direction = {0, -1, 0};
    path.pixel = 7;
    return path;
}

constexpr Hit kFloor = {1, 0.3f, 0.3f, 0, 0};
constexpr Hit kNothing = {kInfinity, 0, 0, kNoHit, kNoHit};

template <Features... kMasks>
Features chosen(CompiledFor<kMasks...>, Features wanted) {
    Features found = ~0u;
    CompiledFor<kMasks...>::choose(wanted, [&]<Features kFeatures>() { found = kFeatures; });
    return found;
}

} // namespace

TEST_CASE("path vertex: a listener gets a vertex's events in order and does not change the light") {
    const LitFloor place;
    PathState alone, heard = path_down();
    ShadowRay shadow_alone, shadow_heard;
    bool wants_alone = false, wants_heard = false;
    Listeners<> nobody(place.job);
    Listeners<Witness> witness(place.job);
    while (!wants_alone && heard.sample < 100) { // until the light sample is the sky and not the floor itself
        ++heard.sample;
        alone = heard;
        REQUIRE(
            shade_vertex<kAllMaterials>(place.job, alone, kFloor, DrawOnDemand(), shadow_alone, wants_alone, nobody));
    }
    witness.begins(heard);
    CHECK(shade_vertex<kPlainDiffuse>(place.job, heard, kFloor, DrawOnDemand(), shadow_heard, wants_heard, witness));
    REQUIRE(wants_alone);
    CHECK(wants_heard);
    CHECK(heard.radiance == alone.radiance);
    CHECK(heard.throughput == alone.throughput);
    CHECK(heard.direction == alone.direction);
    CHECK(shadow_heard.contribution == shadow_alone.contribution);
    CHECK(shadow_heard.direction == shadow_alone.direction);
    CHECK(witness.events == std::vector<std::string>{"vertex 0", "emitted 0", "direct 0", "scattered 1"});
    CHECK(witness.found == Rgb{1, 2, 3});

    Listeners<Witness>::PathData kept;
    Listeners<Witness>::ShadowData shadow_data;
    witness.save(kept);
    witness.save_shadow_data(shadow_data);
    CHECK(kept.vertices == 1);
    CHECK(shadow_data.contribution == shadow_alone.contribution);

    Listeners<Witness> next(place.job);
    next.restore(kept);
    CHECK_FALSE(
        shade_vertex<kPlainDiffuse>(place.job, heard, kNothing, DrawOnDemand(), shadow_heard, wants_heard, next));
    CHECK_FALSE(wants_heard);
    CHECK(next.events == std::vector<std::string>{"missed 1", "emitted 1"});
    next.save(kept);
    CHECK(kept.vertices == 1);
}

TEST_CASE("path vertex: light taken by a listener is not added to the path, and other listeners get zero") {
    const LitFloor place;
    PathState path = path_down();
    ShadowRay shadow;
    bool asks = true;
    Listeners<Witness, Thief> both(place.job);
    CHECK(shade_vertex<kAllMaterials>(place.job, path, kFloor, DrawOnDemand(), shadow, asks, both));
    CHECK(path.radiance == Rgb{0, 0, 0});
    CHECK_FALSE(asks);
    CHECK(both.point_.instance == 0);
    CHECK(both.point_.u == 0.3f);
    CHECK(both.found == Rgb{0, 0, 0});
    CHECK(both.events == std::vector<std::string>{"vertex 0", "emitted 0", "scattered 1"});
    CHECK_FALSE(shade_vertex<kAllMaterials>(place.job, path, kNothing, DrawOnDemand(), shadow, asks, both));
    CHECK(path.radiance == Rgb{0, 0, 0});
    CHECK(both.point_.kind() == SourceKind::Environment);
}

TEST_CASE("path vertex: the variant of a mask of features is the smallest that covers all of them") {
    const FilmFeatures films;
    CHECK(chosen(films, 0) == kPlainDiffuse);
    CHECK(chosen(films, kTextured) == kDiffuse);
    CHECK(chosen(films, kAlpha) == kDiffuse);
    CHECK(chosen(films, kLayered) == kUnstacked);
    CHECK(chosen(films, kStacked) == kAllMaterials);
    CHECK(chosen(films, kStacked | kMoving) == (kAllMaterials | kMoving | kBatched | kMipMapped | kNested));
    CHECK(chosen(films, kMoving) == kMoving);
    CHECK(chosen(films, kTextured | kMoving) == (kDiffuse | kMoving));
    CHECK(chosen(FrameFeatures(), kMoving) == ~0u);
    CHECK_FALSE(is_compiled(PathOutput::Frames, kMoving));
    CHECK(chosen(LayerFeatures(), 0) == kUnstacked);
    CHECK(chosen(LayerFeatures(), kStacked) == (kAllMaterials | kMoving | kMipMapped | kNested));
    for (const ShadingVariant variant :
         {ShadingVariant::General, ShadingVariant::Unstacked, ShadingVariant::Diffuse, ShadingVariant::PlainDiffuse}) {
        CHECK(variant_of(features_of(variant)) == variant);
    }
}
