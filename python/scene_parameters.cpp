#include "python/scene_parameters.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "formats/files/parse_number.h"
#include "python/transform_values.h"
#include "scene/animation.h"
#include "scene/orient_light.h"
#include "scene/projection_features.h"
#include "scene/scene_origin.h"
#include "session/degrees.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

constexpr std::string_view kOwners[] = {"materials", "instances", "lights", "cameras", "environment"};

/// A parameter of some kind of owner.
struct Property {
    std::string_view name;
    std::vector<std::size_t> shape;
    double low = -0x1p40, high = 0x1p40; // ends of the range of all values
    std::function<bool(const Scene&, uint32_t)> is_there;
    std::function<std::vector<double>(const Scene&, uint32_t)> get;
    std::function<void(Scene&, uint32_t, std::span<const double>)> set;
    /// Returns why values in range cannot be set; empty: they can.
    std::function<std::string(const Scene&, uint32_t, std::span<const double>)> why_not = {};
};

std::vector<double> numbers(Vec3 v) { return {double(v.x), double(v.y), double(v.z)}; }
std::vector<double> numbers(Rgb c) { return {double(c.r), double(c.g), double(c.b)}; }
Vec3 vec3(std::span<const double> v) { return {float(v[0]), float(v[1]), float(v[2])}; }

bool is_anything(const Scene&, uint32_t) { return true; }

/// Numbers and colours of materials, by the table in scene/material.h.
std::vector<Property> of_materials() {
    std::vector<Property> properties;
    MaterialParameters any;
    visit_parameters(
        any,
        [&](float&, const char* name, float low, float high) {
            if (!properties.empty() && properties.back().name == name) {
                properties.back().shape = {3};
                return;
            }
            const auto values_of = [name](auto& material, const auto& visit) {
                std::size_t channel = 0;
                visit_parameters(
                    material,
                    [&](auto& value, const char* of, float, float) {
                        if (std::string_view(of) == name) visit(value, channel++);
                    },
                    [](auto&&...) {});
            };
            properties.push_back({.name = name,
                                  .shape = {},
                                  .low = double(low),
                                  .high = double(high),
                                  .is_there = is_anything,
                                  .get =
                                      [values_of](const Scene& scene, uint32_t i) {
                                          std::vector<double> values;
                                          values_of(scene.materials[i],
                                                    [&](float value, std::size_t) { values.push_back(double(value)); });
                                          return values;
                                      },
                                  .set =
                                      [values_of](Scene& scene, uint32_t i, std::span<const double> values) {
                                          values_of(scene.materials[i], [&](float& value, std::size_t channel) {
                                              value = float(values[channel]);
                                          });
                                      }});
        },
        [](auto&&...) {});
    return properties;
}

std::string why_no_place(const Scene& scene, uint32_t i, std::span<const double> values) {
    const Transform placed = transform_of(values, scene.origin_in_file);
    if (is_singular(placed)) return "the transform is singular";
    const bool is_near = is_within_limits(placed, bounds_of(scene.meshes[scene.instances[i].mesh]));
    return is_near ? "" : "the instance lies beyond 2^40 metres then";
}

void set_instance(Scene& scene, uint32_t i, std::span<const double> values) {
    scene.instances[i].world_from_local = transform_of(values, scene.origin_in_file);
    scene.instances[i].is_hidden = false;
}

std::string why_no_aim(const Scene& scene, uint32_t, std::span<const double> values) {
    return without_scale(transform_of(values, scene.origin_in_file)) ? "" : "the light has no direction";
}

void set_light(Scene& scene, uint32_t i, std::span<const double> values) {
    transform_light(transform_of(values, scene.origin_in_file), scene.lights[i]);
    scene.lights[i].direction = normalize_safely(scene.lights[i].direction);
}

void set_camera(Scene& scene, uint32_t i, std::span<const double> values) {
    scene.cameras[i].world_from_camera = *without_scale(transform_of(values, scene.origin_in_file));
}

Transform placed(const Light& light) {
    const bool has_table = parts_of(light.kind).table;
    const Vec3 up = has_table ? light.up : std::abs(light.direction.y) < 0.999f ? Vec3{0, 1, 0} : Vec3{0, 0, -1};
    Transform world_from_light = look_at({0, 0, 0}, light.direction, up);
    if (has_table && light.is_mirrored) {
        for (Vec3* const row : {&world_from_light.row0, &world_from_light.row1, &world_from_light.row2})
            row->x = -row->x;
    }
    world_from_light.translation = light.position;
    return world_from_light;
}

/// A numeric property of a scene's objects, read and written through `Member`.
template <auto Member>
Property of_member(std::string_view name, double low,
                   std::function<bool(const Scene&, uint32_t)> is_there = is_anything, double high = 0x1p40) {
    return {.name = name,
            .shape = {},
            .low = low,
            .high = high,
            .is_there = std::move(is_there),
            .get = [](const Scene& scene, uint32_t i) { return std::vector{double(Member(scene, i))}; },
            .set = [](Scene& scene, uint32_t i, std::span<const double> v) { Member(scene, i) = float(v[0]); }};
}

constexpr auto kRange = [](auto& scene, uint32_t i) -> auto& { return scene.lights[i].range; };
constexpr auto kAperture = [](auto& scene, uint32_t i) -> auto& { return scene.cameras[i].aperture_radius; };
constexpr auto kRotation = [](auto& scene, uint32_t i) -> auto& { return scene.cameras[i].aperture.rotation_deg; };
constexpr auto kRatio = [](auto& scene, uint32_t i) -> auto& { return scene.cameras[i].aperture.ratio; };
constexpr auto kFocus = [](auto& scene, uint32_t i) -> auto& { return scene.cameras[i].focus_distance; };
constexpr auto kHeight = [](auto& scene, uint32_t i) -> auto& { return scene.cameras[i].ortho_height; };

std::vector<Property> of_instances() {
    return {{.name = "transform",
             .shape = {4, 4},
             .is_there = is_anything,
             .get = [](const Scene& scene,
                       uint32_t i) { return values_of(scene.instances[i].world_from_local, scene.origin_in_file); },
             .set = set_instance,
             .why_not = why_no_place}};
}

std::vector<Property> of_lights() {
    const auto has_position = [](const Scene& scene, uint32_t i) { return parts_of(scene.lights[i].kind).position; };
    const auto has_direction = [](const Scene& scene, uint32_t i) { return parts_of(scene.lights[i].kind).direction; };
    return {
        {.name = "intensity",
         .shape = {3},
         .low = 0,
         .is_there = is_anything,
         .get = [](const Scene& scene, uint32_t i) { return numbers(scene.lights[i].intensity); },
         .set =
             [](Scene& scene, uint32_t i, std::span<const double> v) {
                 scene.lights[i].intensity = {float(v[0]), float(v[1]), float(v[2])};
             }},
        {.name = "position",
         .shape = {3},
         .is_there = has_position,
         .get =
             [](const Scene& scene, uint32_t i) {
                 const DoubleVec3 p = in_file(scene, scene.lights[i].position);
                 return std::vector{p.x, p.y, p.z};
             },
         .set =
             [](Scene& scene, uint32_t i, std::span<const double> v) {
                 scene.lights[i].position = in_scene(scene, {v[0], v[1], v[2]});
             }},
        {.name = "direction",
         .shape = {3},
         .is_there = has_direction,
         .get = [](const Scene& scene, uint32_t i) { return numbers(scene.lights[i].direction); },
         .set =
             [](Scene& scene, uint32_t i, std::span<const double> v) {
                 Light& light = scene.lights[i];
                 light.direction = normalize_safely(vec3(v));
                 orient_light(light);
             },
         .why_not = [](const Scene&, uint32_t, std::span<const double> v) -> std::string {
             return is_finite(normalize_safely(vec3(v))) ? "" : "expected a direction other than 0";
         }},
        {.name = "transform",
         .shape = {4, 4},
         .is_there = is_anything,
         .get = [](const Scene& scene, uint32_t i) { return values_of(placed(scene.lights[i]), scene.origin_in_file); },
         .set = set_light,
         .why_not = why_no_aim},
        of_member<kRange>("range", 0, has_position)};
}

std::vector<Property> of_cameras() {
    const auto has_angle = [](const Scene& scene, uint32_t i) {
        return has_angle_of_view(scene.cameras[i].projection);
    };
    const auto is_parallel = [](const Scene& scene, uint32_t i) {
        return has_parallel_rays(scene.cameras[i].projection);
    };
    return {
        {.name = "transform",
         .shape = {4, 4},
         .is_there = is_anything,
         .get = [](const Scene& scene,
                   uint32_t i) { return values_of(scene.cameras[i].world_from_camera, scene.origin_in_file); },
         .set = set_camera,
         .why_not = why_no_aim},
        {.name = "fov",
         .shape = {},
         .low = 0x1p-10,
         .high = 179.9,
         .is_there = has_angle,
         .get = [](const Scene& scene, uint32_t i) { return std::vector{double(degrees_for(scene.cameras[i].fov_y))}; },
         .set = [](Scene& scene, uint32_t i,
                   std::span<const double> v) { scene.cameras[i].fov_y = float(v[0]) * kRadiansPerDegree; }},
        of_member<kHeight>("view_height", 0x1p-20, is_parallel),
        of_member<kAperture>("aperture", 0),
        {.name = "aperture_blades",
         .shape = {},
         .low = 0,
         .high = kMaxBlades,
         .is_there = is_anything,
         .get = [](const Scene& scene, uint32_t i) { return std::vector{double(scene.cameras[i].aperture.blades)}; },
         .set = [](Scene& scene, uint32_t i,
                   std::span<const double> v) { scene.cameras[i].aperture.blades = uint32_t(v[0]); },
         .why_not = [](const Scene&, uint32_t, std::span<const double> v) -> std::string {
             const bool is_count = v[0] == std::floor(v[0]) && is_blade_count(uint32_t(v[0]));
             return is_count ? "" : "expected a whole number from 3 to 100, or 0";
         }},
        of_member<kRotation>("aperture_rotation", -1e6, is_anything, 1e6),
        of_member<kRatio>("aperture_ratio", kMinApertureRatio, is_anything, kMaxApertureRatio),
        of_member<kFocus>("focus", 0x1p-40)};
}

std::vector<Property> of_environment() {
    return {
        {.name = "scale",
         .shape = {3},
         .low = 0,
         .is_there = is_anything,
         .get = [](const Scene& scene, uint32_t) { return numbers(scene.environment->scale); },
         .set =
             [](Scene& scene, uint32_t, std::span<const double> v) {
                 scene.environment->scale = {float(v[0]), float(v[1]), float(v[2])};
             }},
        {.name = "rotation",
         .shape = {},
         .low = -1e6,
         .high = 1e6,
         .is_there = is_anything,
         .get = [](const Scene& scene,
                   uint32_t) { return std::vector{double(scene.environment->rotation) / double(kRadiansPerDegree)}; },
         .set = [](Scene& scene, uint32_t,
                   std::span<const double> v) { scene.environment->rotation = float(v[0]) * kRadiansPerDegree; }}};
}

const std::vector<Property>& properties_of(ParameterOwner owner) {
    static const std::vector<Property> all[] = {of_materials(), of_instances(), of_lights(), of_cameras(),
                                                of_environment()};
    return all[static_cast<std::size_t>(owner)];
}

const Property& property_of(const SceneParameter& parameter) {
    return *std::ranges::find(properties_of(parameter.owner), parameter.name, &Property::name);
}

/// Returns whether an animation changes what is set.
bool is_animated(const Scene& scene, const SceneParameter& parameter) {
    if (scene.animations.empty() || parameter.owner == ParameterOwner::Environment) return false;
    if (parameter.owner == ParameterOwner::Instance) return may_move(scene)[parameter.index];
    const bool is_light = parameter.owner == ParameterOwner::Light,
               is_material = parameter.owner == ParameterOwner::Material;
    const uint32_t node = is_material ? kNoNode
                          : is_light  ? scene.lights[parameter.index].node
                                      : scene.cameras[parameter.index].node;
    if (node != kNoNode && moving_nodes(scene)[node]) return true;
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            const bool is_of_it = is_material ? is_of_material(channel.part)
                                  : is_light  ? is_of_light(channel.part)
                                              : is_of_camera(channel.part);
            if (is_of_it && channel.target == parameter.index) return true;
        }
    }
    return false;
}

[[noreturn]] void fail(const std::string& path, const std::string& why) {
    throw Error(ErrorCode::BadInput, path, "", why);
}

} // namespace

SceneParameters::SceneParameters(const Scene& scene) {
    const auto list = [&](ParameterOwner owner, const auto& things) {
        Owners& owners = owners_[static_cast<std::size_t>(owner)];
        std::unordered_map<std::string, uint32_t> uses;
        for (const auto& thing : things) ++uses[thing.name];
        for (uint32_t i = 0; i < things.size(); ++i) {
            const std::string& name = things[i].name;
            const bool is_own = !name.empty() && uses[name] == 1 && !parse_whole_number(name);
            owners.names.push_back(is_own ? name : fmt::format("{}", i));
            owners.indices.emplace(owners.names.back(), i);
        }
    };
    list(ParameterOwner::Material, scene.materials);
    list(ParameterOwner::Instance, scene.instances);
    list(ParameterOwner::Light, scene.lights);
    list(ParameterOwner::Camera, scene.cameras);
    if (scene.environment) owners_[static_cast<std::size_t>(ParameterOwner::Environment)] = {{""}, {{"", 0}}};
}

std::vector<std::string> SceneParameters::paths(const Scene& scene) const {
    std::vector<std::string> paths;
    for (std::size_t owner = 0; owner < std::size(kOwners); ++owner) {
        for (uint32_t i = 0; i < owners_[owner].names.size(); ++i) {
            for (const Property& property : properties_of(static_cast<ParameterOwner>(owner))) {
                if (!property.is_there(scene, i)) continue;
                const std::string& name = owners_[owner].names[i];
                paths.push_back(fmt::format("{}/{}{}{}", kOwners[owner], name, name.empty() ? "" : "/", property.name));
            }
        }
    }
    return paths;
}

std::optional<SceneParameter> SceneParameters::find(const Scene& scene, std::string_view path) const {
    const std::size_t first = path.find('/'), last = path.rfind('/');
    if (first == std::string_view::npos) return std::nullopt;
    const auto owner = std::ranges::find(kOwners, path.substr(0, first));
    if (owner == std::end(kOwners)) return std::nullopt;
    const auto kind = static_cast<std::size_t>(owner - std::begin(kOwners));
    const std::string_view name = first == last ? "" : path.substr(first + 1, last - first - 1);
    const auto index = owners_[kind].indices.find(std::string(name));
    if (index == owners_[kind].indices.end()) return std::nullopt;
    return find(scene, static_cast<ParameterOwner>(kind), index->second, path.substr(last + 1));
}

std::optional<SceneParameter> SceneParameters::find(const Scene& scene, ParameterOwner owner, uint32_t index,
                                                    std::string_view name) {
    for (const Property& property : properties_of(owner))
        if (property.name == name && property.is_there(scene, index))
            return SceneParameter{owner, index, property.name};
    return std::nullopt;
}

std::vector<std::size_t> shape_of(const SceneParameter& parameter) { return property_of(parameter).shape; }

std::vector<double> read_parameter(const Scene& scene, const SceneParameter& parameter) {
    return property_of(parameter).get(scene, parameter.index);
}

void check_parameter(const Scene& scene, const SceneParameter& parameter, std::span<const double> values,
                     const std::string& path) {
    const Property& property = property_of(parameter);
    for (const double value : values) {
        if (value >= property.low && value <= property.high) continue; // not NaN
        fail(path, fmt::format("{} is out of range; expected {} to {}", value, limit_text(property.low),
                               limit_text(property.high)));
    }
    if (property.shape.size() == 2) {
        const double last[] = {0, 0, 0, 1};
        if (!std::equal(last, last + 4, values.begin() + 12))
            fail(path, "expected 0, 0, 0, 1 as the last row of a transform");
    }
    if (is_animated(scene, parameter)) fail(path, "an animation changes this parameter");
    if (!property.why_not) return;
    if (const std::string why = property.why_not(scene, parameter.index, values); !why.empty()) fail(path, why);
}

SceneUpdate write_parameter(Scene& scene, const SceneParameter& parameter, std::span<const double> values) {
    const Property& property = property_of(parameter);
    SceneUpdate update;
    const std::vector<double> before = property.get(scene, parameter.index);
    const bool was_hidden = parameter.owner == ParameterOwner::Instance && scene.instances[parameter.index].is_hidden;
    const bool emitted = parameter.owner == ParameterOwner::Material && scene.materials[parameter.index].is_emissive();
    property.set(scene, parameter.index, values);
    if (property.get(scene, parameter.index) == before && !was_hidden) return update;
    switch (parameter.owner) {
    case ParameterOwner::Material:
        update.materials_changed = true;
        update.lights_changed = emitted || scene.materials[parameter.index].is_emissive();
        break;
    case ParameterOwner::Instance:
        update.moved_instances = {parameter.index};
        break;
    case ParameterOwner::Light:
        update.lights_changed = true;
        break;
    case ParameterOwner::Camera:
        break;
    case ParameterOwner::Environment:
        update.environment_changed = true;
        break;
    }
    return update;
}

} // namespace pertev
