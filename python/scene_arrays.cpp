#include "python/scene_arrays.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "python/argument_fields.h"
#include "python/scene_parameters.h"
#include "python/transform_values.h"
#include "scene/metals.h"
#include "scene/scene_origin.h"
#include "session/degrees.h"

namespace nb = nanobind;

namespace pertev {
namespace {

using Names = std::map<std::string, uint32_t>;

uint32_t named(const Names& names, const std::string& name, const std::string& path) {
    const auto found = names.find(name);
    if (found == names.end()) throw Error(ErrorCode::BadInput, path, name, "there is no object with this name");
    return found->second;
}

template <class To, std::size_t Size>
std::vector<To> packed(const std::vector<float>& values) {
    std::vector<To> packed(values.size() / Size);
    static_assert(sizeof(To) == Size * sizeof(float));
    std::ranges::copy(values, reinterpret_cast<float*>(packed.data()));
    return packed;
}

Mesh mesh_of(ArgumentFields& fields) {
    Mesh mesh;
    const ArrayArgument vertices = fields.needed("vertices"), faces = fields.needed("faces");
    mesh.positions = packed<Vec3, 3>(vertices.of_shape({ArrayArgument::kAny, 3}).floats());
    const std::size_t count = mesh.positions.size();
    mesh.indices = faces.of_shape({ArrayArgument::kAny, 3}).indices(count);
    if (const auto normals = fields.array("normals")) {
        mesh.normals = packed<Vec3, 3>(normals->of_shape({count, 3}).floats());
        for (Vec3& normal : mesh.normals) normal = normalize_safely(normal);
    }
    if (const auto uv = fields.array("uv")) mesh.uv[0] = packed<Vec2, 2>(uv->of_shape({count, 2}).floats());
    if (const auto colors = fields.array("colors")) {
        std::vector<float> values = colors->of_shape({count, 4}).floats();
        if (colors->is_uint8()) {
            for (float& value : values) value /= 255;
        } else if (colors->is_whole() && std::ranges::any_of(values, [](float value) { return value > 1; })) {
            colors->fail("expected uint8, or numbers from 0 to 1");
        }
        mesh.colors = packed<Vec4, 4>(values);
    }
    return mesh;
}

/// Returns an image with four channels; one channel is repeated.
TextureImage image_of(const ArrayArgument& array) {
    const std::size_t channels = array.axes() == 2 ? 1 : array.axes() == 3 ? array.length(2) : 0;
    if (channels != 1 && channels != 3 && channels != 4) {
        array.fail("expected the shape (height, width), or (height, width, channels) with 1, 3 or 4 channels");
    }
    if (array.length(0) == 0 || array.length(1) == 0) array.fail("the image has no pixels");
    const auto expand = [&]<class Value>(const std::vector<Value>& values, Value opaque) {
        std::vector<Value> pixels;
        pixels.reserve(values.size() / channels * 4);
        for (std::size_t i = 0; i < values.size(); i += channels) {
            for (std::size_t c = 0; c < 3; ++c) pixels.push_back(values[i + (channels == 1 ? 0 : c)]);
            pixels.push_back(channels == 4 ? values[i + 3] : opaque);
        }
        return pixels;
    };
    TextureImage image;
    const auto height = static_cast<uint32_t>(array.length(0)), width = static_cast<uint32_t>(array.length(1));
    if (array.is_uint8()) {
        image.rgba8 = {width, height, expand(array.bytes(), uint8_t(255))};
    } else if (array.is_whole()) {
        array.fail("the array's dtype is neither uint8 nor a float");
    } else {
        image.rgba_float = {width, height, 4, expand(array.floats(), 1.0f)};
    }
    return image;
}

Material material_of(ArgumentFields& fields, std::vector<TextureImage>& images) {
    Material material;
    material.kind = MaterialKind::MetallicRoughness;
    visit_choices(material, [&](auto& choice, const char* name, std::initializer_list<const char*> names) {
        const std::string otherwise = names.begin()[static_cast<int>(choice)];
        choice = static_cast<std::remove_reference_t<decltype(choice)>>(fields.one_of(name, otherwise, names));
    });
    if (const std::string name = fields.text("metal", ""); !name.empty()) {
        const MeasuredMetal* const metal = find_metal(name);
        if (metal == nullptr) {
            throw Error(ErrorCode::BadInput, fields.path_of("metal"), name, "expected one of " + names_of_metals());
        }
        material.kind = MaterialKind::Conductor;
        material.eta = metal->eta;
        material.k = metal->k;
    }
    fields.flag("double_sided", material.double_sided);
    fields.flag("two_sided_emission", material.two_sided_emission);
    fields.flag("thin_walled", material.thin_walled);
    fields.flag("has_relative_ior", material.has_relative_ior);
    std::map<std::string_view, std::vector<float*>> numbers;
    std::vector<const char*> names;
    visit_parameters(
        material,
        [&](float& value, const char* name, float, float) {
            if (numbers[name].empty()) names.push_back(name);
            numbers[name].push_back(&value);
        },
        [&](TextureRef& texture, const char* name) {
            const auto array = fields.array(name);
            if (!array) return;
            texture.image = static_cast<int32_t>(images.size());
            const std::string_view slot = name;
            texture.is_srgb =
                array->is_uint8() && (slot == "base_color_texture" || slot == "emission_texture" ||
                                      slot == "specular_color_texture" || slot == "fuzz_color_texture" ||
                                      slot == "coat_color_texture" || slot == "diffuse_transmission_color_texture");
            images.push_back(image_of(*array));
            images.back().name = fields.path_of(name);
        });
    for (const char* name : names) {
        const std::vector<float*>& values = numbers[name];
        const auto given = values.size() == 1 ? fields.finite(name, {}) : fields.finite(name, {3});
        for (std::size_t i = 0; given && i < values.size(); ++i) *values[i] = static_cast<float>((*given)[i]);
    }
    return material;
}

Light light_of(ArgumentFields& fields, DoubleVec3 origin) {
    Light light;
    light.kind = static_cast<LightKind>(fields.one_of("kind", "point", {"point", "spot", "directional"}));
    const LightParts parts = parts_of(light.kind);
    fields.color("intensity", light.intensity);
    if (const auto transform = fields.transform("transform")) transform_light(transform_of(*transform, origin), light);
    if (parts.position) {
        if (const auto at = fields.point("position")) light.position = to_float(*at - origin);
        fields.number("range", light.range);
    }
    if (parts.direction) {
        fields.vector("direction", light.direction);
        light.direction = normalize_safely(light.direction);
    }
    if (parts.cone) {
        float inner = 0, outer = 45; // degrees from the axis
        fields.number("inner_cone", inner);
        fields.number("outer_cone", outer);
        for (const auto& [name, angle] : {std::pair("inner_cone", inner), {"outer_cone", outer}})
            if (!(angle >= 0 && angle <= 180))
                refuse_argument(fields.path_of(name), fmt::format("expected 0 to 180 degrees, not {:g}", angle));
        if (inner > outer)
            refuse_argument(fields.path_of("inner_cone"), fmt::format("expected at most the outer cone, {:g}", outer));
        light.cos_inner = cos(inner * kRadiansPerDegree);
        light.cos_outer = min(cos(outer * kRadiansPerDegree), light.cos_inner - kSharpestEdge);
    }
    return light;
}

Camera camera_of(ArgumentFields& fields, DoubleVec3 origin) {
    Camera camera;
    const auto transform = fields.transform("transform");
    const auto eye = fields.point("eye"), target = fields.point("target");
    Vec3 up = {0, 1, 0};
    fields.vector("up", up);
    if (transform && (eye || target)) refuse_argument(fields.path(), "expected a transform, or an eye and a target");
    if (eye.has_value() != target.has_value()) refuse_argument(fields.path(), "expected both an eye and a target");
    if (transform) {
        const auto rigid = without_scale(transform_of(*transform, origin));
        if (!rigid) refuse_argument(fields.path_of("transform"), "the camera has no direction");
        camera.world_from_camera = *rigid;
    } else if (eye) {
        camera.world_from_camera = look_at(to_float(*eye - origin), to_float(*target - origin), up);
        if (!is_finite(camera.world_from_camera))
            refuse_argument(fields.path_of("target"), "the target must differ from the eye, and its direction from up");
        camera.focus_distance = length(to_float(*target - *eye));
    }
    camera.projection =
        static_cast<Projection>(fields.one_of("projection", "perspective", {"perspective", "orthographic"}));
    float fov_deg = 45;
    fields.number("fov", fov_deg);
    camera.fov_y = fov_deg * kRadiansPerDegree;
    fields.number("view_height", camera.ortho_height);
    fields.number("aspect", camera.aspect);
    if (!(camera.aspect >= 0)) refuse_argument(fields.path_of("aspect"), "expected at least 0");
    fields.number("aperture", camera.aperture_radius);
    float blades = 0;
    fields.number("aperture_blades", blades);
    if (!(blades >= 0 && blades <= float(kMaxBlades) && blades == std::floor(blades) &&
          is_blade_count(uint32_t(blades))))
        refuse_argument(fields.path_of("aperture_blades"), "expected a whole number from 3 to 100, or 0");
    camera.aperture.blades = uint32_t(blades);
    fields.number("aperture_rotation", camera.aperture.rotation_deg);
    fields.number("aperture_ratio", camera.aperture.ratio);
    fields.number("focus", camera.focus_distance);
    return camera;
}

std::optional<Environment> environment_of(nb::handle value) {
    if (value.is_none()) return std::nullopt;
    const ArrayArgument array(value, "environment");
    Environment environment;
    if (array.has_shape({3})) {
        if (array.is_uint8()) array.fail("the array's dtype is no float; a radiance is");
        const std::vector<float> color = array.floats();
        environment.scale = {color[0], color[1], color[2]};
    } else {
        if (!array.has_shape({ArrayArgument::kAny, ArrayArgument::kAny, 3}))
            array.fail("expected the shape (3,) or (height, width, 3)");
        if (array.is_whole()) array.fail("the array's dtype is no float; a radiance is");
        environment.image = {static_cast<uint32_t>(array.length(1)), static_cast<uint32_t>(array.length(0)), 3,
                             array.floats()};
    }
    const auto is_light = [](float x) { return std::isfinite(x) && x >= 0; };
    const Rgb& scale = environment.scale;
    if (!is_light(scale.r) || !is_light(scale.g) || !is_light(scale.b) ||
        !std::ranges::all_of(environment.image.pixels, is_light)) {
        array.fail("expected a finite radiance of at least 0");
    }
    return environment;
}

/// Calls make(name, fields) for each object of a group.
void for_each(const nb::dict& parts, const char* group,
              const std::function<void(const std::string&, ArgumentFields&)>& make) {
    const nb::object objects = nb::borrow(parts[group]);
    if (objects.is_none()) return;
    if (!nb::isinstance<nb::dict>(objects)) refuse_argument(group, "expected a dictionary of objects by their names");
    for (const auto& [key, value] : nb::borrow<nb::dict>(objects)) {
        const std::string name = text_argument(key, group);
        if (!nb::isinstance<nb::dict>(value)) {
            const bool is_mesh = group == std::string_view("meshes"),
                       is_instance = group == std::string_view("instances");
            refuse_argument(fmt::format("{}/{}", group, name),
                            fmt::format("expected a dictionary{}", is_mesh
                                                                       ? R"(, as {"vertices": (N, 3), "faces": (M, 3)})"
                                                                   : is_instance ? R"(, as {"mesh": "a mesh's name"})"
                                                                                 : ""));
        }
        ArgumentFields fields(value, fmt::format("{}/{}", group, name));
        make(name, fields);
        fields.refuse_others();
    }
}

/// Numbers of an object, which are checked once the scene is there.
struct GivenNumbers {
    ParameterOwner owner;
    uint32_t index;
    std::string path;
    std::vector<std::pair<std::string, std::vector<double>>> numbers;
};

/// Throws Error(BadInput) for a number that scene.params would refuse.
void check_given(const Scene& scene, const std::vector<GivenNumbers>& given) {
    for (const GivenNumbers& of : given) {
        for (const auto& [name, values] : of.numbers) {
            const auto parameter = SceneParameters::find(scene, of.owner, of.index, name);
            if (parameter) check_parameter(scene, *parameter, values, fmt::format("{}/{}", of.path, name));
        }
    }
}

/// The box of all instances in double, whose middle is the origin of a far scene.
DoubleBounds3 box_of(const Scene& scene, const std::vector<std::vector<double>>& transforms) {
    DoubleBounds3 box;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Bounds3 local = bounds_of(scene.meshes[scene.instances[i].mesh]);
        if (local.is_empty()) continue;
        const std::vector<double>& m = transforms[i];
        for (int corner = 0; corner < 8; ++corner) {
            const double x = double(corner & 1 ? local.hi.x : local.lo.x),
                         y = double(corner & 2 ? local.hi.y : local.lo.y),
                         z = double(corner & 4 ? local.hi.z : local.lo.z);
            box.extend(DoubleVec3{m[0] * x + m[1] * y + m[2] * z + m[3], m[4] * x + m[5] * y + m[6] * z + m[7],
                                  m[8] * x + m[9] * y + m[10] * z + m[11]});
        }
    }
    return box;
}

} // namespace

Scene scene_of_arrays(const nb::dict& parts) {
    Scene scene;
    Names meshes, materials;
    std::vector<GivenNumbers> given;
    const auto keep = [&](ParameterOwner owner, std::size_t count, const ArgumentFields& fields) {
        given.push_back({owner, static_cast<uint32_t>(count - 1), fields.path(), fields.numbers()});
    };
    for_each(parts, "meshes", [&](const std::string& of, ArgumentFields& fields) {
        meshes.emplace(of, static_cast<uint32_t>(scene.meshes.size()));
        scene.meshes.push_back(mesh_of(fields));
        scene.meshes.back().name = of;
    });
    for_each(parts, "materials", [&](const std::string& of, ArgumentFields& fields) {
        materials.emplace(of, static_cast<uint32_t>(scene.materials.size()));
        scene.materials.push_back(material_of(fields, scene.images));
        scene.materials.back().name = of;
        keep(ParameterOwner::Material, scene.materials.size(), fields);
    });
    std::optional<uint32_t> grey;
    std::vector<std::vector<double>> transforms;
    for_each(parts, "instances", [&](const std::string& of, ArgumentFields& fields) {
        Instance instance;
        instance.name = of;
        instance.mesh = named(meshes, fields.text("mesh", ""), fields.path_of("mesh"));
        if (const std::string material = fields.text("material", ""); !material.empty()) {
            instance.material = named(materials, material, fields.path_of("material"));
        } else {
            if (!grey) grey = static_cast<uint32_t>(scene.materials.size());
            if (*grey == scene.materials.size()) scene.materials.emplace_back().name = "grey";
            instance.material = *grey;
        }
        transforms.push_back(fields.transform("transform").value_or(values_of(Transform(), {0, 0, 0})));
        scene.instances.push_back(std::move(instance));
    });
    set_origin(box_of(scene, transforms), scene);
    const DoubleVec3 origin = scene.origin_in_file;
    for (std::size_t i = 0; i < transforms.size(); ++i) {
        scene.instances[i].world_from_local = transform_of(transforms[i], origin);
    }
    for_each(parts, "lights", [&](const std::string& of, ArgumentFields& fields) {
        scene.lights.push_back(light_of(fields, origin));
        scene.lights.back().name = of;
        keep(ParameterOwner::Light, scene.lights.size(), fields);
    });
    for_each(parts, "cameras", [&](const std::string& of, ArgumentFields& fields) {
        scene.cameras.push_back(camera_of(fields, origin));
        scene.cameras.back().name = of;
        keep(ParameterOwner::Camera, scene.cameras.size(), fields);
    });
    scene.environment = environment_of(parts["environment"]);
    check_given(scene, given);
    return scene;
}

} // namespace pertev
