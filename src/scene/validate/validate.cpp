#include "scene/validate/validate.h"

#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "math/double_vec3.h"
#include "scene/shape_mesh.h"
#include "scene/tangents/make_tangents.h"
#include "scene/validate/validate_mesh.h"
#include "scene/validate/validate_parts.h"

namespace pertev {
namespace {

constexpr const char* kTooFar = "lies beyond 2^40 metres";

class Validator {
public:
    Validator(Scene& scene, const std::string& file, Sink& sink) : scene_(scene), file_(file), sink_(sink) {}

    void run() {
        references();
        validate_nodes(scene_, file_);
        validate_materials(scene_, file_, sink_);
        moves_ = may_move(scene_);
        meshes();
        report();
        const std::size_t all = scene_.instances.size();
        drop_empty_meshes();
        const std::size_t with_triangles = scene_.instances.size();
        drop_singular_instances();
        if (scene_.instances.empty()) {
            if (first_misplaced_.ends_with(kTooFar)) {
                throw Error(ErrorCode::OverLimit, FileLocation{file_},
                            fmt::format("{}; scale the scene down", first_misplaced_));
            }
            if (!first_misplaced_.empty()) throw bad(first_misplaced_);
            if (repairs_.too_far > 0) throw too_far("every triangle");
            throw no_geometry(all - with_triangles, with_triangles);
        }
        for (std::size_t i = 0; i < scene_.cameras.size(); ++i) camera(i);
        for (std::size_t i = 0; i < scene_.lights.size(); ++i) light(i);
        make_tangents(scene_, sink_);
    }

private:
    Error bad(const std::string& what) const { return Error(ErrorCode::BadInput, FileLocation{file_}, what); }
    Error too_far(const std::string& what) const {
        return Error(ErrorCode::OverLimit, FileLocation{file_},
                     fmt::format("{} {}; scale the scene down", what, kTooFar));
    }

    Error no_geometry(std::size_t without_triangles, std::size_t singular) const {
        std::vector<std::string> reasons;
        if (without_triangles > 0) {
            reasons.push_back(fmt::format("{} of meshes without valid triangles ({} is the first); expected triangles "
                                          "with an area and finite vertices",
                                          counted(without_triangles, "instance"), first_empty_mesh_));
        }
        if (singular > 0) {
            reasons.push_back(
                fmt::format("{} with a singular transform ({} is the first); expected scales other than 0",
                            counted(singular, "instance"), first_singular_));
        }
        if (reasons.empty())
            reasons.push_back(scene_.no_instances.empty() ? "no instance uses a mesh" : scene_.no_instances);
        return bad(fmt::format("the scene has no visible triangle: {}", fmt::join(reasons, "; ")));
    }

    static std::string name_of(std::size_t i, const Mesh& mesh) { return numbered("mesh", i, mesh.name, mesh.origin); }

    static std::string name_of(std::size_t i, const Instance& instance) {
        return numbered("instance", i, instance.name, origin_of(instance));
    }

    void references() const {
        if (scene_.instances.size() > kMaxInstances) {
            throw Error(ErrorCode::OverLimit, FileLocation{file_},
                        fmt::format("{} instances; the limit is {}", scene_.instances.size(), kMaxInstances));
        }
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& instance = scene_.instances[i];
            if (instance.mesh >= scene_.meshes.size()) {
                throw bad(fmt::format("{}: mesh {} is out of range; there are {}", name_of(i, instance), instance.mesh,
                                      scene_.meshes.size()));
            }
            if (instance.material >= scene_.materials.size()) {
                throw bad(fmt::format("{}: material {} is out of range; there are {}", name_of(i, instance),
                                      instance.material, scene_.materials.size()));
            }
        }
    }

    void meshes() {
        std::vector<bool> moves(scene_.meshes.size());
        for (std::size_t i = 0; i < moves_.size(); ++i) {
            if (moves_[i]) moves[scene_.instances[i].mesh] = true;
        }
        std::vector<MeshShape*> shapes(scene_.meshes.size());
        for (MeshShape& shape : scene_.shapes) {
            if (shape.mesh >= shapes.size() || (shape.node != kNoNode && shape.node >= scene_.nodes.size()) ||
                (shape.skin != kNoSkin && shape.skin >= scene_.skins.size())) {
                throw bad(fmt::format("the skin or morph targets of mesh {}: its mesh, node or skin is out of range",
                                      shape.mesh));
            }
            shapes[shape.mesh] = &shape;
        }
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
            sink_.check();
            Mesh& mesh = scene_.meshes[i];
            const MeshName of = {file_, name_of(i, mesh)};
            MeshShape* shape = shapes[i];
            repairs_ += repair_mesh(mesh, shape != nullptr && moves[i], of);
            if (shape == nullptr) continue;
            const std::size_t joints = shape->skin == kNoSkin ? 0 : scene_.skins[shape->skin].joints.size();
            const MeshRepairs repairs = repair_shape(*shape, mesh, joints, of);
            repairs_ += repairs;
            if (repairs.normals + repairs.tangents > 0) shape_at_rest(scene_, {&shape, 1});
        }
    }

    void report() {
        const auto text = [&](uint64_t count, const char* thing, const char* which, const char* done) {
            return fmt::format("{}: {} {} {} {}", file_, counted(count, thing), which, is_or_are(count), done);
        };
        const auto warn = [&](uint64_t count, const char* thing, const char* which, const char* done) {
            if (count > 0) sink_.warn(text(count, thing, which, done));
        };
        if (repairs_.not_finite > 0) {
            sink_.leave_out(text(repairs_.not_finite, "triangle", "with a vertex that is not finite", "left out"));
        }
        if (repairs_.too_far > 0) {
            sink_.leave_out(text(repairs_.too_far, "triangle", "with a vertex beyond 2^40 metres", "left out"));
        }
        warn(repairs_.without_area, "triangle", "without area", "left out");
        warn(repairs_.normals, "normal", "of length zero or not finite", "replaced by the geometric normal");
        warn(repairs_.tangents, "tangent", "of length zero or not finite", "replaced");
        warn(repairs_.texture_coordinates, "texture coordinate", "without a finite value", "set to 0");
        warn(repairs_.colors, "vertex colour", "outside [0, 1]", "clamped");
    }

    void drop_empty_meshes() {
        constexpr uint32_t dropped = 0xffffffffu;
        std::vector<uint32_t> renumbered(scene_.meshes.size(), dropped);
        uint32_t kept = 0;
        for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
            if (scene_.meshes[i].indices.empty()) {
                if (first_empty_mesh_.empty()) first_empty_mesh_ = name_of(i, scene_.meshes[i]);
                continue;
            }
            if (kept != i) scene_.meshes[kept] = std::move(scene_.meshes[i]);
            renumbered[i] = kept++;
        }
        scene_.meshes.resize(kept);
        std::erase_if(scene_.instances, [&](const Instance& i) { return renumbered[i.mesh] == dropped; });
        for (Instance& instance : scene_.instances) instance.mesh = renumbered[instance.mesh];
        std::erase_if(scene_.shapes, [&](const MeshShape& shape) { return renumbered[shape.mesh] == dropped; });
        for (MeshShape& shape : scene_.shapes) shape.mesh = renumbered[shape.mesh];
        moves_ = may_move(scene_);
    }

    /// Removes instances whose transform is singular, because glTF hides a node by a scale of 0. An instance that may
    /// move stays hidden, because it may appear at a time.
    void drop_singular_instances() {
        std::vector<Bounds3> bounds;
        for (const Mesh& mesh : scene_.meshes) bounds.push_back(bounds_of(mesh));
        std::size_t i = 0, dropped = 0;
        std::erase_if(scene_.instances, [&](const Instance& instance) {
            const std::size_t number = i++;
            if (const std::string fault = fault_of_transform(instance, bounds[instance.mesh]); !fault.empty()) {
                const std::string what = fmt::format("{} {}", name_of(number, instance), fault);
                if (first_misplaced_.empty()) first_misplaced_ = what;
                sink_.leave_out({FileLocation{file_}, fmt::format("{}; it is left out", what)});
                return true;
            }
            const bool drops = is_singular(instance.world_from_local) && !moves_[number];
            if (drops && dropped++ == 0) first_singular_ = name_of(number, instance);
            if (drops && is_flat(instance.world_from_local)) {
                sink_.leave_out({FileLocation{file_},
                                 fmt::format("{} has a singular transform, such as one scale of 0, and is left out",
                                             name_of(number, instance))});
            }
            return drops;
        });
        for (Instance& instance : scene_.instances) {
            if (!is_singular(instance.world_from_local)) continue;
            instance.is_hidden = true;
            instance.world_from_local = {};
        }
        if (dropped == 0) return;
        sink_.warn({FileLocation{file_},
                    fmt::format("{} with a singular transform, such as a scale of 0, hidden ({} is the first)",
                                counted(dropped, "instance"), first_singular_)});
    }

    /// Returns whether a singular transform maps space to a plane, where surfaces keep some area, and not to a line or
    /// a point.
    static bool is_flat(const Transform& m) {
        const Vec3 a = column(m, 0), b = column(m, 1), c = column(m, 2);
        return max_component(abs(cross(a, b)) + abs(cross(b, c)) + abs(cross(c, a))) > 0;
    }

    /// Returns why an instance cannot be placed by its transform; empty if it can.
    static std::string fault_of_transform(const Instance& instance, const Bounds3& local) {
        const Transform& m = instance.world_from_local;
        if (!is_finite(m)) return "has a transform that is not finite";
        return local.is_empty() || is_within_limits(m, local) ? "" : kTooFar;
    }

    static bool is_near(Vec3 p) { return is_finite(p) && max_component(abs(p)) <= kMaxCoordinate; }

    void camera(std::size_t i) const {
        const Camera& camera = scene_.cameras[i];
        const std::string of = numbered("camera", i, camera.name, camera.origin);
        if (!is_finite(camera.world_from_camera)) throw bad(of + ": its transform is not finite");
        if (is_singular(camera.world_from_camera)) throw bad(of + ": its transform is singular; no scale may be 0");
        if (!is_near(camera.world_from_camera.translation)) throw too_far(of);
        const bool is_flat = has_parallel_rays(camera.projection);
        if (!is_flat && !(camera.fov_y > 0 && camera.fov_y < kPi)) {
            throw bad(fmt::format("{}: its field of view is {} radians; expected between 0 and pi", of, camera.fov_y));
        }
        if (!is_finite(camera.ortho_height) ||
            (is_flat && !(camera.ortho_height > 0 && camera.ortho_height <= kMaxCoordinate))) {
            throw bad(fmt::format("{}: its view height is {}; expected above 0", of, camera.ortho_height));
        }
        if (!(camera.aspect >= 0 && is_finite(camera.aspect))) {
            throw bad(fmt::format("{}: its aspect is {}; expected above 0, or 0 for none", of, camera.aspect));
        }
        if (!(camera.aperture_radius >= 0 && camera.aperture_radius <= kMaxCoordinate)) {
            throw bad(fmt::format("{}: its aperture is {}; expected at least 0", of, camera.aperture_radius));
        }
        const ApertureShape& shape = camera.aperture;
        if (!is_blade_count(shape.blades)) {
            throw bad(fmt::format("{}: its aperture has {} blades; expected from {} to {}, or 0 for a disk", of,
                                  shape.blades, kMinBlades, kMaxBlades));
        }
        if (!(abs(shape.rotation_deg) <= kMaxApertureRotation) ||
            !(shape.ratio >= kMinApertureRatio && shape.ratio <= kMaxApertureRatio)) {
            throw bad(fmt::format("{}: its aperture is rotated by {} degrees and its ratio is {}; expected at most {} "
                                  "degrees, and a ratio from {} to {}",
                                  of, shape.rotation_deg, shape.ratio, kMaxApertureRotation, kMinApertureRatio,
                                  kMaxApertureRatio));
        }
        if (!(camera.focus_distance > 0 && camera.focus_distance <= kMaxCoordinate)) {
            throw bad(fmt::format("{}: its focus distance is {}; expected above 0", of, camera.focus_distance));
        }
    }

    void light(std::size_t i) {
        Light& light = scene_.lights[i];
        const std::string of = numbered("light", i, light.name, light.origin);
        const Rgb e = light.intensity;
        if (!(is_finite(e) && e.r >= 0 && e.g >= 0 && e.b >= 0)) {
            throw bad(fmt::format("{}: its intensity is ({}, {}, {}); expected finite numbers of at least 0", of, e.r,
                                  e.g, e.b));
        }
        const LightParts parts = parts_of(light.kind);
        if (parts.position) {
            if (!is_near(light.position)) throw too_far(of);
            if (!(light.range >= 0))
                throw bad(fmt::format("{}: its range is {}; expected at least 0", of, light.range));
        }
        if (!parts.direction) return;
        light.direction = normalize_safely(light.direction);
        if (parts.table) {
            light.up = normalize_safely(light.up);
            if (!is_oriented(light)) throw bad(of + ": its directions are zero, parallel or not finite");
            if (light.table == nullptr) throw bad(of + ": it has no table of intensities");
        }
        if (!is_finite(light.direction)) throw bad(of + ": its direction is zero or not finite");
        if (!parts.cone) return;
        if (!(light.cos_outer >= -1 && light.cos_inner <= 1 && light.cos_outer < light.cos_inner)) {
            throw bad(fmt::format("{}: the cosines of its cone are {} (inner) and {} (outer); expected outer < inner, "
                                  "both between -1 and 1",
                                  of, light.cos_inner, light.cos_outer));
        }
    }

    Scene& scene_;
    const std::string& file_;
    Sink& sink_;
    MeshRepairs repairs_;
    std::vector<bool> moves_;                                         // may_move of the instances
    std::string first_empty_mesh_, first_singular_, first_misplaced_; // locations in the file
};

} // namespace

void validate(Scene& scene, const std::string& file, Sink& sink) { Validator(scene, file, sink).run(); }

} // namespace pertev
