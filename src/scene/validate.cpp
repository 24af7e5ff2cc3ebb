#include "scene/validate.h"

#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "scene/validate_materials.h"
#include "scene/validate_mesh.h"

namespace pertev {
namespace {

class Validator {
public:
    Validator(Scene& scene, const std::string& file, Messages& messages)
        : scene_(scene), file_(file), messages_(messages) {}

    void run() {
        references();
        validate_materials(scene_, file_, messages_);
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
            repairs_ +=
                repair_mesh(scene_.meshes[i], fmt::format("{}: {}", file_, numbered("mesh", i, scene_.meshes[i].name)));
        }
        report();
        drop_empty_meshes();
        if (scene_.instances.empty()) throw bad("no geometry: not one triangle to see");
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) instance(i);
        for (std::size_t i = 0; i < scene_.cameras.size(); ++i) camera(i);
        for (std::size_t i = 0; i < scene_.lights.size(); ++i) light(i);
    }

private:
    Error bad(const std::string& what) const { return Error(ErrorCode::BadInput, fmt::format("{}: {}", file_, what)); }
    Error too_far(const std::string& what) const {
        return Error(ErrorCode::OverLimit,
                     fmt::format("{}: {} lies further out than 2^40 metres; scale the scene down", file_, what));
    }

    void references() const {
        if (scene_.instances.size() > kMaxInstances) {
            throw Error(ErrorCode::OverLimit, fmt::format("{}: {} instances; the limit is {}", file_,
                                                          scene_.instances.size(), kMaxInstances));
        }
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& instance = scene_.instances[i];
            if (instance.mesh >= scene_.meshes.size()) {
                throw bad(fmt::format("{}: mesh {} is out of range; there are {}",
                                      numbered("instance", i, instance.name), instance.mesh, scene_.meshes.size()));
            }
            if (instance.material >= scene_.materials.size()) {
                throw bad(fmt::format("{}: material {} is out of range; there are {}",
                                      numbered("instance", i, instance.name), instance.material,
                                      scene_.materials.size()));
            }
        }
    }

    void report() {
        const auto say = [&](uint64_t count, const char* thing, const char* what) {
            if (count > 0) messages_.warn(fmt::format("{}: {} {}", file_, counted(count, thing), what));
        };
        say(repairs_.not_finite, "triangle", "with a vertex that is not finite: left out");
        say(repairs_.without_area, "triangle", "without area: left out");
        say(repairs_.normals, "normal", "of length zero or not finite: replaced by the surface's own");
        say(repairs_.tangents, "tangent", "of length zero or not finite: replaced");
        say(repairs_.texture_coordinates, "texture coordinate", "not finite: set to 0");
        say(repairs_.colors, "vertex colour", "outside [0, 1]: clamped");
    }

    void drop_empty_meshes() {
        constexpr uint32_t dropped = 0xffffffffu;
        std::vector<uint32_t> renumbered(scene_.meshes.size(), dropped);
        uint32_t kept = 0;
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
            if (scene_.meshes[i].indices.empty()) continue;
            if (kept != i) scene_.meshes[kept] = std::move(scene_.meshes[i]);
            renumbered[i] = kept++;
        }
        scene_.meshes.resize(kept);
        std::erase_if(scene_.instances, [&](const Instance& i) { return renumbered[i.mesh] == dropped; });
        for (Instance& instance : scene_.instances) instance.mesh = renumbered[instance.mesh];
    }

    void transform(const Transform& m, const std::string& of) const {
        const auto finite = [](const Transform& t) {
            return is_finite(t.row0) && is_finite(t.row1) && is_finite(t.row2) && is_finite(t.translation);
        };
        if (!finite(m)) throw bad(of + ": its transform is not finite");
        if (!finite(inverse(m))) throw bad(of + ": its transform is singular; no scale may be 0");
    }

    void instance(std::size_t i) {
        const Instance& instance = scene_.instances[i];
        const std::string of = numbered("instance", i, instance.name);
        transform(instance.world_from_local, of);
        if (bounds_.empty()) {
            for (const Mesh& mesh : scene_.meshes) bounds_.push_back(bounds_of(mesh));
        }
        const Bounds3& local = bounds_[instance.mesh];
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 p = {corner & 1 ? local.hi.x : local.lo.x, corner & 2 ? local.hi.y : local.lo.y,
                            corner & 4 ? local.hi.z : local.lo.z};
            if (!is_near(transform_point(instance.world_from_local, p))) throw too_far(of);
        }
    }

    static bool is_near(Vec3 p) { return is_finite(p) && max_component(abs(p)) <= kMaxCoordinate; }

    void camera(std::size_t i) const {
        const Camera& camera = scene_.cameras[i];
        const std::string of = numbered("camera", i, camera.name);
        transform(camera.world_from_camera, of);
        if (!is_near(camera.world_from_camera.translation)) throw too_far(of);
        if (camera.projection == Projection::Perspective && !(camera.fov_y > 0 && camera.fov_y < kPi)) {
            throw bad(fmt::format("{}: its angle of view is {} radians; it lies between 0 and pi", of, camera.fov_y));
        }
        if (camera.projection == Projection::Orthographic &&
            !(camera.ortho_height > 0 && camera.ortho_height <= kMaxCoordinate)) {
            throw bad(fmt::format("{}: the height of its view is {}; it is above 0", of, camera.ortho_height));
        }
        if (!(camera.aspect >= 0 && is_finite(camera.aspect))) {
            throw bad(fmt::format("{}: its aspect is {}; it is above 0, or 0 for none", of, camera.aspect));
        }
        if (!(camera.aperture_radius >= 0 && camera.aperture_radius <= kMaxCoordinate)) {
            throw bad(fmt::format("{}: its aperture is {}; it is 0 or above", of, camera.aperture_radius));
        }
        if (!(camera.focus_distance > 0 && camera.focus_distance <= kMaxCoordinate)) {
            throw bad(fmt::format("{}: its focus distance is {}; it is above 0", of, camera.focus_distance));
        }
    }

    void light(std::size_t i) {
        Light& light = scene_.lights[i];
        const std::string of = numbered("light", i, light.name);
        const Rgb e = light.intensity;
        if (!(is_finite(e) && e.r >= 0 && e.g >= 0 && e.b >= 0)) {
            throw bad(
                fmt::format("{}: its intensity is ({}, {}, {}); it is finite and not negative", of, e.r, e.g, e.b));
        }
        if (light.kind != LightKind::Directional) {
            if (!is_near(light.position)) throw too_far(of);
            if (!(light.range >= 0)) throw bad(fmt::format("{}: its range is {}; it is 0 or above", of, light.range));
        }
        if (light.kind == LightKind::Point) return;
        light.direction = normalize_safely(light.direction);
        if (!is_finite(light.direction)) throw bad(of + ": its direction is zero or not finite");
        if (light.kind == LightKind::Directional) return;
        if (!(light.cos_outer >= -1 && light.cos_inner <= 1 && light.cos_outer < light.cos_inner)) {
            throw bad(
                fmt::format("{}: the cosines of its cone are {} (inner) and {} (outer); outer is the smaller, both "
                            "within -1 and 1",
                            of, light.cos_inner, light.cos_outer));
        }
    }

    Scene& scene_;
    const std::string& file_;
    Messages& messages_;
    MeshRepairs repairs_;
    std::vector<Bounds3> bounds_; // of the meshes
};

} // namespace

void validate(Scene& scene, const std::string& file, Messages& messages) { Validator(scene, file, messages).run(); }

} // namespace pertev
