#include "session/survey/emitter_fronts.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "base/message_text.h"
#include "session/survey/cast_rays.h"

namespace pertev {
namespace {

constexpr std::size_t kMaxNames = 5;
constexpr std::size_t kMaxEmitters = 16;           // maximum number of tested emitters
constexpr std::size_t kMaxOfEmitter = 4;           // tested triangles per emitter, spread over its list
constexpr uint64_t kMaxSceneTriangles = 2'000'000; // a tenth of a second for 128 rays on one core
constexpr float kMuchMore = 20;                    // room behind per metre in front

bool is_one_sided_emitter(const Material& material) { return material.is_emitter() && !material.two_sided_emission; }

/// Two rays from the middle of each tested triangle: along its front normal, and along its back normal.
std::vector<SurveyRay> rays_from(const Scene& scene, const Instance& emitter) {
    const Mesh& mesh = scene.meshes[emitter.mesh];
    std::vector<SurveyRay> rays;
    const std::size_t count = mesh.triangle_count(), tested = std::min(count, kMaxOfEmitter);
    for (std::size_t k = 0; k < tested; ++k) {
        const uint32_t* index = mesh.indices.data() + 3 * (k * count / tested);
        const auto corner = [&](int i) { return transform_point(emitter.world_from_local, mesh.positions[index[i]]); };
        const Vec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
        const float size = max(max_component(abs(ab)), max_component(abs(ac)));
        const Vec3 across = cross((1.0f / size) * ab, (1.0f / size) * ac);
        if (!(length(across) > 0)) continue;
        const float sign = is_mirroring(emitter.world_from_local) ? -1.0f : 1.0f;
        const Vec3 normal = (sign / length(across)) * across;
        const Vec3 middle = a + (1.0f / 3) * (ab + ac), off = (1e-4f * size) * normal; // to leave the triangle itself
        rays.insert(rays.end(), {{middle + off, normal}, {middle - off, -normal}});
    }
    return rays;
}

/// Extent of `box` along the unit `direction` from `from`, metres; 0 if less than half of it lies there.
float reach_of(const Bounds3& box, Vec3 from, Vec3 direction) {
    const float middle = dot(direction, box.centre() - from);
    return middle > 0 ? middle + 0.5f * dot(abs(direction), box.size()) : 0;
}

void warn_of_turned_emitters(const Scene& scene, const std::vector<const Instance*>& emitters, const std::string& file,
                             Sink& sink) {
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) triangles += scene.meshes[instance.mesh].triangle_count();
    if (triangles > kMaxSceneTriangles) return;
    const Bounds3 box = bounds_of(scene);
    for (std::size_t i = 0; i < std::min(emitters.size(), kMaxEmitters); ++i) {
        sink.check();
        const std::vector<SurveyRay> rays = rays_from(scene, *emitters[i]);
        if (rays.empty()) continue;
        const std::vector<SurveyHit> hits = cast_rays(scene, rays);
        std::size_t turned = 0;
        float before = kInfinity, behind = kInfinity; // `behind` is the least distance to a surface there
        for (std::size_t k = 0; k < hits.size(); k += 2) {
            const float off = 0.5f * length(rays[k].origin - rays[k + 1].origin);
            const float front = off + hits[k].distance, back = off + hits[k + 1].distance;
            // No hit behind may mean the sky above an emitter that correctly shines down; then the scene's extent
            // counts.
            const float distance_text =
                back < kInfinity ? back : reach_of(box, rays[k + 1].origin, rays[k + 1].direction);
            if (!(kMuchMore * front < distance_text)) continue;
            ++turned;
            before = min(before, front);
            behind = min(behind, back);
        }
        if (2 * turned <= hits.size() / 2) continue; // most of the tested triangles
        const std::string distance_text = behind < kInfinity ? fmt::format("{:.3g} m", behind) : "most of the scene";
        sink.warn({FileLocation{file}, fmt::format("the front of the emitter {} faces a surface at {:.3g} m, and {} is "
                                                   "behind it: flip its faces, or set `two_sided_lights`",
                                                   shortened(emitters[i]->name), before, distance_text)});
    }
}

} // namespace

void report_emitter_fronts(const Scene& scene, const std::string& file, Sink& sink) {
    std::vector<const Instance*> emitters;
    std::string names;
    for (const Instance& instance : scene.instances) {
        if (instance.is_hidden || !is_one_sided_emitter(scene.materials[instance.material])) continue;
        emitters.push_back(&instance);
        if (emitters.size() <= kMaxNames) names += (names.empty() ? "" : ", ") + shortened(instance.name);
    }
    if (emitters.empty()) return;
    if (emitters.size() > kMaxNames) names += fmt::format(" and {} more", emitters.size() - kMaxNames);
    sink.note({FileLocation{file},
               fmt::format("{} with light only from the front face: {}; normals point to the front, or corners run "
                           "counter-clockwise there (`two_sided_lights`: both faces)",
                           counted(emitters.size(), "emitter"), names)});
    warn_of_turned_emitters(scene, emitters, file, sink);
}

} // namespace pertev
