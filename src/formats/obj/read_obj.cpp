#include "formats/obj/read_obj.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <system_error>
#include <unordered_map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/huge_pages.h"
#include "base/message_text.h"
#include "base/parallel_for.h"
#include "base/read_file.h"
#include "base/sink.h"
#include "formats/files/load_textures.h"
#include "formats/mesh/corner_numbers.h"
#include "formats/obj/bump_normals.h"
#include "formats/obj/parse_obj.h"
#include "formats/obj/read_mtl.h"
#include "scene/scene_origin.h"

namespace fs = std::filesystem;

namespace pertev {
namespace {

void warn_of_textures_without_coordinates(const Scene& scene, const ObjData& data, const std::string& file,
                                          Sink& sink) {
    std::set<uint32_t> materials;
    std::string first;
    for (std::size_t i = 0; i < data.groups.size(); ++i) {
        const uint32_t material = scene.instances[i].material;
        const std::vector<ObjCorner>& corners = data.groups[i].corners;
        if (scene.materials[material].textures().empty() || materials.contains(material) ||
            std::none_of(corners.begin(), corners.end(), [](const ObjCorner& c) { return c.uv == kNoIndex; })) {
            continue;
        }
        if (materials.empty()) first = data.groups[i].material;
        materials.insert(material);
    }
    if (materials.empty()) return;
    sink.warn(
        {FileLocation{file},
         fmt::format(
             "{} with a texture on faces without texture coordinates ({} is the first); the texel at (0, 0) is used",
             counted(materials.size(), "material"), shortened(first))});
}

/// Removes vertex colours from meshes with a colour texture, because scanners write the same colours to the vertices as
/// well.
void drop_colors_beside_textures(Scene& scene, const std::string& file, Sink& sink) {
    std::size_t dropped = 0;
    for (const Instance& instance : scene.instances) {
        std::vector<Vec4>& colors = scene.meshes[instance.mesh].colors;
        if (colors.empty() || !scene.materials[instance.material].base_color_texture.has_image()) continue;
        colors.clear();
        ++dropped;
    }
    if (dropped == 0) return;
    sink.leave_out({FileLocation{file}, "vertex colours are left out, because a texture defines the colour"});
}

Mesh make_mesh(const ObjGroup& group, const ObjData& data, Sink& sink) {
    Mesh mesh;
    mesh.name = group.name.empty() ? group.material : group.name;
    mesh.origin = fmt::format("line {}", group.line);
    CornerNumbers table(group.corners);
    reserve_on_huge_pages(mesh.indices, group.corners.size());
    bool has_uv = false, has_normal = false;
    for (const ObjCorner& corner : group.corners) {
        sink.check_at(mesh.indices.size());
        mesh.indices.push_back(table.number_of(corner));
        has_uv |= corner.uv != kNoIndex;
        has_normal |= corner.normal != kNoIndex;
    }
    const std::vector<ObjCorner>& vertices = table.keys();
    mesh.positions.reserve(vertices.size());
    for (const ObjCorner& v : vertices) mesh.positions.push_back(data.positions[v.position]);
    if (!data.colors.empty()) {
        mesh.colors.reserve(vertices.size());
        for (const ObjCorner& v : vertices) mesh.colors.push_back(data.colors[v.position]);
    }
    if (has_normal) { // zero where there is none: validate() puts the geometric one
        mesh.normals.reserve(vertices.size());
        for (const ObjCorner& v : vertices) {
            mesh.normals.push_back(v.normal == kNoIndex ? Vec3{} : data.normals[v.normal]);
        }
    }
    if (has_uv) {
        mesh.uv[0].reserve(vertices.size());
        for (const ObjCorner& v : vertices) {
            const Vec2 uv = v.uv == kNoIndex ? Vec2{0, 1} : data.uvs[v.uv];
            mesh.uv[0].push_back({uv.x, 1 - uv.y});
        }
    }
    return mesh;
}

/// Turns those triangles round whose vertex normals point behind them: the winding defines the front of an emitter.
void wind_after_normals(Mesh& mesh) {
    if (mesh.normals.empty()) return;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        uint32_t* corner = mesh.indices.data() + i;
        const Vec3 a = mesh.positions[corner[0]];
        const Vec3 across = cross(mesh.positions[corner[1]] - a, mesh.positions[corner[2]] - a);
        const Vec3 sum = mesh.normals[corner[0]] + mesh.normals[corner[1]] + mesh.normals[corner[2]];
        if (dot(across, sum) < 0) std::swap(corner[1], corner[2]);
    }
}

std::vector<fs::path> find_material_files(const ObjMaterialFiles& line, const fs::path& obj, const FileAccess& access,
                                          Sink& sink) {
    const FileLocation location = {obj.string(), line.line};
    bool is_refused = false; // true once a refused file has been reported
    const auto find = [&](const std::string& name) -> std::optional<fs::path> {
        try {
            return access.find(location, name, sink);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::BadInput) throw;
            sink.leave_out(error.remark().and_then("; its materials are grey"));
            is_refused = true;
            return std::nullopt;
        }
    };
    if (const std::optional<fs::path> whole = find(line.names)) return {*whole};
    if (is_refused) return {};
    std::vector<fs::path> found;
    std::istringstream names(line.names);
    for (std::string name; names >> name;) {
        is_refused = false;
        if (const std::optional<fs::path> path = find(name)) {
            found.push_back(*path);
        } else if (!is_refused) {
            sink.leave_out(
                {location, fmt::format("there is no material file {}; its materials are grey", shortened(name))});
        }
    }
    return found;
}

/// The materials that an OBJ file names, and their textures. Those of its first mtllib, which in most files is the only
/// one and is at the top, are read concurrently with the geometry if there is a thread for them. A fault of the
/// geometry is then reported after they have been read.
class MaterialsBeside {
public:
    /// Makes an object that all arguments must outlive.
    MaterialsBeside(const fs::path& obj, const FileAccess& access, TextureLoader& loader, Sink& sink)
        : obj_(obj), access_(access), loader_(loader), sink_(sink) {}

    /// Starts to read the materials of the first mtllib statement. It is called at most once, and throws nothing.
    void start(const ObjMaterialFiles& line) {
        if (thread_count() == 1) return;
        try {
            first_ = std::async(std::launch::async, [this, line, threads = Threads()] {
                const UseThreads use(threads);
                read(line);
                loader_.decode();
            });
        } catch (const std::system_error&) { // no thread is left
        }
    }
    /// Waits for the first materials, reads those of the other `lines`, and returns all.
    std::map<std::string, MtlMaterial> finish(const std::vector<ObjMaterialFiles>& lines) {
        const bool is_first_read = first_.valid();
        if (is_first_read) {
            while (first_.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) sink_.check();
            first_.get();
        }
        for (std::size_t i = is_first_read ? 1 : 0; i < lines.size(); ++i) read(lines[i]);
        return std::move(materials_);
    }

private:
    void read(const ObjMaterialFiles& line) {
        if (line.names.empty()) return;
        for (const fs::path& path : find_material_files(line, obj_, access_, sink_)) {
            if (seen_.insert(path).second) materials_.merge(read_mtl(path, loader_, sink_));
        }
    }

    const fs::path& obj_;
    const FileAccess& access_;
    TextureLoader& loader_;
    Sink& sink_;
    std::map<std::string, MtlMaterial> materials_;
    std::set<fs::path> seen_;
    std::future<void> first_; // the last member: it is waited for before the others go
};

Material grey_material(const std::string& name, const ObjData& data) {
    Material material;
    material.name = name;
    if (!data.colors.empty()) material.base_color = grey(1); // the vertex colours replace it
    return material;
}

/// Adds an instance for each group, and the materials that they name: grey ones where no file has them, which is
/// reported.
void add_groups(const ObjData& data, const std::map<std::string, MtlMaterial>& materials, const std::string& file,
                const ReadOptions& options, Scene& scene, Sink& sink) {
    std::unordered_map<std::string_view, uint32_t> numbers; // index of each material
    std::size_t unknown = 0;
    std::string first_unknown;
    for (uint32_t i = 0; i < data.groups.size(); ++i) {
        const std::string& name = data.groups[i].material;
        const auto [number, is_new] = numbers.try_emplace(name, static_cast<uint32_t>(scene.materials.size()));
        if (is_new) {
            const auto known = materials.find(name);
            if (known != materials.end()) {
                scene.materials.push_back(known->second.material);
            } else {
                scene.materials.push_back(grey_material(name, data));
                if (!name.empty() && unknown++ == 0) first_unknown = name;
            }
        }
        scene.instances.push_back({.name = data.groups[i].name.empty() ? name : data.groups[i].name,
                                   .mesh = i,
                                   .material = number->second,
                                   .world_from_local = {}});
    }

    if (data.groups.empty()) {
        scene.no_instances =
            fmt::format("{} but no face; expected a line such as f 1 2 3", counted(data.positions.size(), "position"));
        const std::vector<std::string> left_out = sink.messages().left_out();
        if (!left_out.empty()) scene.no_instances += fmt::format("; left out: {}", left_out.front());
    }

    if (unknown > 0 && !options.geometry_only) {
        sink.leave_out({FileLocation{file}, fmt::format("{} that {} in no .mtl file ({} is the first) {} grey",
                                                        counted(unknown, "material"), is_or_are(unknown),
                                                        shortened(first_unknown), is_or_are(unknown))});
    }
}

/// Finishes the materials, whose images are there: maps that may be heights or normals become normals.
void finish_materials(const std::map<std::string, MtlMaterial>& materials, Scene& scene) {
    std::vector<BumpUse> bumps;
    std::vector<float> multipliers; // each bump has one
    for (uint32_t i = 0; i < scene.materials.size(); ++i) {
        Material& material = scene.materials[i];
        const auto known = materials.find(material.name);
        if (known == materials.end()) continue;
        MtlMaterial finished = known->second;
        finished.material = material;
        finish_mtl_material(finished, scene.images);
        material = finished.material;
        if (!finished.normal_may_be_height) continue;
        bumps.push_back({i, finished.bump_channel});
        multipliers.push_back(finished.bump_multiplier);
    }
    const std::vector<bool> had_heights = convert_bumps(bumps, scene);
    for (std::size_t i = 0; i < bumps.size(); ++i) {
        if (had_heights[i]) scene.materials[bumps[i].material].normal_scale = multipliers[i];
    }
}

/// Makes the scene. `loader` has the textures of `materials`.
Scene make_scene(const ObjData& data, const std::map<std::string, MtlMaterial>& materials, TextureLoader& loader,
                 const std::string& file, const ReadOptions& options, Sink& sink) {
    Scene scene;
    set_origin(data.box, scene);
    scene.meshes.resize(data.groups.size());
    add_groups(data, materials, file, options, scene, sink);
    parallel_invoke([&] { loader.load_into(scene); },
                    [&] {
                        parallel_for(data.groups.size(), 1, [&](uint64_t i) {
                            scene.meshes[i] = make_mesh(data.groups[i], data, sink);
                            const Material& material = scene.materials[scene.instances[i].material];
                            if (material.is_emissive()) wind_after_normals(scene.meshes[i]);
                        });
                    });
    finish_materials(materials, scene);
    warn_of_textures_without_coordinates(scene, data, file, sink);
    drop_colors_beside_textures(scene, file, sink);
    return scene;
}

} // namespace

Scene read_obj(const fs::path& path, const FileAccess& access, const ReadOptions& options, Sink& sink) {
    PartMessages of_materials(sink); // reported after those of the geometry
    TextureLoader loader(access, of_materials);
    loader.shrink_to(options.max_texture_size);
    MaterialsBeside beside(path, access, loader, of_materials);
    const ObjData data = parse_obj(read_file(path), path.string(), sink, [&](const ObjMaterialFiles& line) {
        if (!options.geometry_only) beside.start(line);
    });
    std::map<std::string, MtlMaterial> materials;
    try {
        if (!options.geometry_only) materials = beside.finish(data.material_files);
    } catch (...) {
        sink.add_all(of_materials);
        throw;
    }
    sink.add_all(of_materials);
    loader.report_to(sink);
    return make_scene(data, materials, loader, path.string(), options, sink);
}

Scene read_obj(const fs::path& path, const ObjTexts& texts, const FileAccess& access, const ReadOptions& options,
               Sink& sink) {
    const ObjData data = parse_obj(texts.geometry, path.string(), sink);
    TextureLoader loader(access, sink);
    loader.shrink_to(options.max_texture_size);
    std::map<std::string, MtlMaterial> materials;
    if (!options.geometry_only) materials = read_mtl(texts.materials, path, loader, sink);
    return make_scene(data, materials, loader, path.string(), options, sink);
}

} // namespace pertev
