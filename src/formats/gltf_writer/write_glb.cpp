#include "formats/gltf_writer/write_glb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json_text.h"
#include "base/message_text.h"
#include "base/version.h"
#include "base/write_file_atomically.h"
#include "formats/gltf_writer/glb_parts.h"
#include "formats/gltf_writer/material_writer.h"
#include "formats/gltf_writer/texture_writer.h"
#include "math/frame.h"
#include "math/portable_math.h"
#include "scene/intensity_table.h"
#include "scene/suggested_setting.h"

namespace pertev {
namespace glb {
namespace {

/// Returns whether a light is a spot with an edge of its own course, as pbrt's and Mitsuba's are.
bool is_round_cone(const Light& light) {
    if (!parts_of(light.kind).table) return false;
    const IntensityTable& table = *light.table;
    return table.layout == TableLayout::Angles && table.values.width == 1 && table.first_angle == 0 &&
           table.last_angle < 0.5f * kPi;
}

/// Returns the spot of a round cone, whose inner cone is that of full intensity.
Light spot_of(Light light) {
    const IntensityTable& table = *light.table;
    constexpr float full = 0.999f;
    uint32_t row = 0;
    while (row + 2 < table.values.height && *table.values.at(0, row + 1) >= full) ++row;
    const float step = table.last_angle / static_cast<float>(table.values.height - 1);
    light.kind = LightKind::Spot;
    light.cos_inner = cos(step * static_cast<float>(row)), light.cos_outer = cos(table.last_angle);
    return light;
}

/// Returns an angle whose cosine is `cosine`, to the bit if an angle near it has that cosine.
float angle_of(float cosine) {
    const float near = acos(clamp(cosine, -1.0f, 1.0f));
    float below = near, above = near;
    for (int i = 0; i < 64; ++i) {
        if (cos(below) == cosine) return below;
        if (cos(above) == cosine) return above;
        below = max(std::nextafter(below, 0.0f), 0.0f), above = std::nextafter(above, 4.0f);
    }
    return near;
}

/// Returns length `i` of a list that starts at 1 and departs from it step by step. A reader that rounds once more than
/// the scene gives back a unit vector, to the bit, of one of these lengths.
float length_near_1(int i) { return 1 + static_cast<float>(i % 2 == 0 ? i / 2 : -i / 2) * 0x1p-23f; }
constexpr int kLengths = 256;

/// Returns the third column of a node in which a light shines along `direction`.
Vec3 back_of(Vec3 direction) {
    for (int i = 0; i < kLengths; ++i) {
        const Vec3 back = -length_near_1(i) * direction;
        if (normalize(-back) == direction) return back;
    }
    return -direction;
}

/// Returns the transform of a node whose camera has the rigid transform `rigid`.
Transform node_of_camera(const Transform& rigid) {
    Transform node = rigid;
    const Vec3 up = column(rigid, 1), back = back_of(-column(rigid, 2));
    node.row0.z = back.x, node.row1.z = back.y, node.row2.z = back.z;
    for (int i = 0; i < kLengths; ++i) {
        const Vec3 second = length_near_1(i) * up;
        node.row0.y = second.x, node.row1.y = second.y, node.row2.y = second.z;
        if (without_scale(node) == rigid) return node;
    }
    return rigid;
}

class SceneWriter {
public:
    SceneWriter(const Scene& scene, Sink& sink) : scene_(scene), sink_(sink), textures_(scene, parts_, sink) {}

    std::vector<std::byte> write() {
        for (std::size_t i = 0; i < scene_.materials.size(); ++i) {
            const Material& material = scene_.materials[i];
            const std::string owner = numbered("material", i, material.name, material.origin);
            parts_.add("materials", material_object(material, owner, textures_, parts_, sink_));
        }
        for (const Instance& instance : scene_.instances) add_instance(instance);
        for (std::size_t i = 0; i < scene_.cameras.size(); ++i) add_camera(scene_.cameras[i], i);
        for (const Light& light : scene_.lights) add_light(light);
        name_losses();
        std::vector<std::string> nodes;
        for (uint32_t i = 0; i < nodes_; ++i) nodes.push_back(fmt::format("{}", i));
        parts_.add("scenes", fmt::format(R"({{"nodes":[{}]}})", fmt::join(nodes, ",")));
        JsonMembers members;
        members.add("asset", fmt::format(R"({{"version":"2.0","generator":{}}})",
                                         json_string(fmt::format("pertev {}", version()))));
        if (!lights_.empty()) {
            parts_.use("KHR_lights_punctual");
            members.add("extensions",
                        fmt::format(R"({{"KHR_lights_punctual":{{"lights":[{}]}}}})", fmt::join(lights_, ",")));
        }
        return parts_.finish(members.add("scene", "0"));
    }

private:
    void add_node(const Transform& world, const std::string& name, const std::string& members) {
        JsonMembers node;
        if (!name.empty()) node.add("name", json_string(name));
        const Transform& m = world;
        const DoubleVec3 t = in_file(m.translation);
        const bool is_turned = !(m.row0 == Vec3{1, 0, 0} && m.row1 == Vec3{0, 1, 0} && m.row2 == Vec3{0, 0, 1});
        if (is_turned || t.x != 0 || t.y != 0 || t.z != 0) {
            node.add("matrix",
                     fmt::format("[{},{},{},0,{},{},{},0,{},{},{},0,{},{},{},1]", m.row0.x, m.row1.x, m.row2.x,
                                 m.row0.y, m.row1.y, m.row2.y, m.row0.z, m.row1.z, m.row2.z, t.x, t.y, t.z));
        }
        const std::string text = node.text();
        const std::string comma = node.is_empty() ? "" : ",";
        parts_.add("nodes", fmt::format("{}{}{}}}", text.substr(0, text.size() - 1), comma, members));
        ++nodes_;
    }

    void add_instance(const Instance& instance) {
        if (instance.is_background) return; // a ground that was made up
        const std::string members = fmt::format(R"("mesh":{})", mesh_of(instance.mesh, instance.material));
        Transform none; // a node without a scale is hidden
        none.row0 = none.row1 = none.row2 = {0, 0, 0};
        add_node(instance.is_hidden ? none : instance.world_from_local, instance.name, members);
    }

    /// Returns the mesh of the file for a mesh with a material.
    uint32_t mesh_of(uint32_t mesh, uint32_t material) {
        const auto [entry, is_new] = meshes_.try_emplace({mesh, material});
        if (!is_new) return entry->second;
        const Mesh& source = scene_.meshes[mesh];
        JsonMembers object;
        if (!source.name.empty()) object.add("name", json_string(source.name));
        const auto& [attributes, indices] = geometry_of(mesh);
        object.add("primitives",
                   fmt::format(R"([{{"attributes":{},"indices":{},"material":{}}}])", attributes, indices, material));
        return entry->second = parts_.add("meshes", object.text());
    }

    /// Returns the attributes and the accessor of the indices of a mesh.
    const std::pair<std::string, uint32_t>& geometry_of(uint32_t mesh) {
        const auto [entry, is_new] = geometries_.try_emplace(mesh);
        if (!is_new) return entry->second;
        const Mesh& source = scene_.meshes[mesh];
        JsonMembers members;
        const auto add = [&](const std::string& name, uint32_t accessor) {
            members.add(name.c_str(), fmt::format("{}", accessor));
        };
        add("POSITION", parts_.add_array(source.positions, true));
        if (!source.normals.empty()) add("NORMAL", parts_.add_array(source.normals));
        if (!source.tangents.empty()) add("TANGENT", parts_.add_array(source.tangents));
        for (std::size_t set = 0; set < kTextureSets; ++set) {
            if (!source.uv[set].empty()) add(fmt::format("TEXCOORD_{}", set), parts_.add_array(source.uv[set]));
        }
        if (!source.colors.empty()) add("COLOR_0", parts_.add_array(source.colors));
        entry->second = {members.text(), parts_.add_indices(source.indices)};
        return entry->second;
    }

    void add_camera(const Camera& camera, std::size_t number) {
        const std::string owner = numbered("camera", number, camera.name, camera.origin);
        if (is_light_meter(camera.projection))
            return sink_.leave_out(fmt::format("{} is lost: glTF has no light meter", owner));
        if (camera.lens != LensModel::Straight || camera.intrinsics || camera.aperture_radius > 0)
            sink_.leave_out(fmt::format("{}: its lens, calibration, aperture and focus are lost", owner));
        JsonMembers object, view;
        if (!camera.name.empty()) object.add("name", json_string(camera.name));
        constexpr float kNear = 0.01f, kFar = 1e6f; // the format requires a number, and nothing is clipped
        if (has_parallel_rays(camera.projection)) {
            if (!(camera.aspect > 0))
                sink_.leave_out(
                    fmt::format("{}: its shape follows the picture, which glTF's cannot; it becomes square", owner));
            const float half = 0.5f * camera.ortho_height, aspect = camera.aspect > 0 ? camera.aspect : 1.0f;
            view.add("xmag", json_float(half * aspect)).add("ymag", json_float(half)).add("zfar", json_float(kFar));
            object.add("type", R"("orthographic")").add("orthographic", view.add("znear", json_float(kNear)).text());
        } else {
            if (camera.aspect > 0) view.add("aspectRatio", json_float(camera.aspect));
            view.add("yfov", json_float(camera.fov_y)).add("znear", json_float(kNear));
            object.add("type", R"("perspective")").add("perspective", view.text());
        }
        const std::string members = fmt::format(R"("camera":{})", parts_.add("cameras", object.text()));
        add_node(node_of_camera(camera.world_from_camera), "", members);
    }

    void add_light(Light light) {
        if (light.is_hidden) {
            return sink_.leave_out(fmt::format("{}: it is hidden, and is lost",
                                               numbered("light", lights_.size(), light.name, light.origin)));
        }
        JsonMembers object;
        if (is_round_cone(light)) {
            sink_.leave_out(fmt::format("{}: its falloff is lost; it becomes a spot light of its cone",
                                        numbered("light", lights_.size(), light.name, light.origin)));
            light = spot_of(light);
        } else if (parts_of(light.kind).table) {
            sink_.leave_out(fmt::format("{}: the table of its intensity is lost; it becomes a point light of its power",
                                        numbered("light", lights_.size(), light.name, light.origin)));
            light.intensity = (0.25f / kPi) * (light.table->integral * light.intensity);
        }
        if (!light.name.empty()) object.add("name", json_string(light.name));
        const float strength = strength_of(light.intensity);
        const Rgb color = (1 / strength) * light.intensity;
        object.add("color", json_floats(std::array{color.r, color.g, color.b})).add_number("intensity", strength, 1);
        object.add_number("range", light.range, 0);
        switch (light.kind) {
        case LightKind::Point:
        case LightKind::Goniometric:
            object.add("type", R"("point")");
            break;
        case LightKind::Directional:
            object.add("type", R"("directional")");
            break;
        case LightKind::Spot:
            object.add("type", R"("spot")");
            object.add("spot",
                       fmt::format(R"({{"innerConeAngle":{},"outerConeAngle":{}}})",
                                   json_float(angle_of(light.cos_inner)), json_float(angle_of(light.cos_outer))));
            break;
        }
        const Frame frame = make_frame(-light.direction);
        const Vec3 x = frame.tangent, y = frame.bitangent, z = back_of(light.direction);
        Transform world = {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, {}};
        if (parts_of(light.kind).position) world.translation = light.position;
        add_node(world, "", fmt::format(R"("extensions":{{"KHR_lights_punctual":{{"light":{}}}}})", lights_.size()));
        lights_.push_back(object.text());
    }

    void name_losses() {
        const auto lose = [&](const std::string& what) { sink_.leave_out(what); };
        if (scene_.environment) lose("the environment is lost; `environment` gives a picture one");
        if (scene_.medium.is_there()) lose("the medium around the scene is lost");
        const bool nests = std::ranges::count_if(scene_.materials, &Material::encloses) > 1;
        if (nests && std::ranges::any_of(scene_.materials, &Material::has_relative_ior))
            lose("indices of refraction relative to a surrounding solid are taken as those over a vacuum");
        if (!scene_.animations.empty())
            lose(fmt::format("{} lost; the scene is written at rest", counted(scene_.animations.size(), "animation")));
        if (!scene_.shapes.empty()) lose("skins and morph targets are lost; the scene is written at rest");
        if (!scene_.variants.empty()) lose("variants of materials are lost; those that are shown are written");
        if (scene_.file_scenes.size() > 1) lose("the file's other scenes are lost");
        if (!scene_.suggested.empty()) {
            std::vector<std::string> texts;
            for (const SuggestedSetting& suggested : scene_.suggested) {
                const auto [setting, camera] = parts_of_suggested(suggested.name);
                texts.push_back(fmt::format("`{}={}`", setting, suggested.text));
                if (!camera.empty()) texts.back() += fmt::format(" of {}", shortened(camera));
            }
            lose(fmt::format("the settings that the file suggests are lost: {}", fmt::join(texts, " ")));
        }
    }

    DoubleVec3 in_file(Vec3 position) const { return scene_.origin_in_file + to_double(position); }

    const Scene& scene_;
    Sink& sink_;
    GlbParts parts_;
    TextureWriter textures_;
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> meshes_;        // by mesh and material
    std::map<uint32_t, std::pair<std::string, uint32_t>> geometries_; // by mesh
    std::vector<std::string> lights_;
    uint32_t nodes_ = 0;
};

} // namespace
} // namespace glb

std::vector<std::byte> encode_glb(const Scene& scene, Sink& sink) { return glb::SceneWriter(scene, sink).write(); }

void write_glb(const std::filesystem::path& path, const Scene& scene, Sink& sink) {
    write_file_atomically(path, encode_glb(scene, sink), sink);
}

} // namespace pertev
