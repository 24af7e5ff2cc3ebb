#include "device_scene/scene_on_device.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel_for.h"
#include "device_scene/crossed_surfaces.h"
#include "device_scene/interior_of_light.h"
#include "device_scene/pack_texels.h"
#include "device_scene/part_arrays.h"
#include "image/srgb_table.h"
#include "shading/lobes/fresnel.h"
#include "shading/shading_groups.h"

namespace pertev {
namespace {

// Each list below defines the contents of a part. Arrays that are made only for the device are parameters, so that
// they outlive the list.

/// Returns the arrays of all geometry but the vertices of meshes with a pose, which belong to DeformingMeshes.
PartArrays list_geometry(const PlacedScene& prepared, std::vector<MeshView>& meshes, SceneView& view) {
    const Scene& scene = *prepared.scene;
    PartArrays arrays;
    meshes.resize(scene.meshes.size());
    std::vector<bool> deforms(meshes.size());
    for (std::size_t i = 0; i < prepared.poses.size(); ++i) deforms[scene.shapes[i].mesh] = true;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        if (!deforms[i]) {
            arrays.add(mesh.positions, meshes[i].positions);
            arrays.add(mesh.normals, meshes[i].normals);
            arrays.add(mesh.tangents, meshes[i].tangents);
        }
        for (std::size_t set = 0; set < kTextureSets; ++set) arrays.add(mesh.uv[set], meshes[i].uv[set]);
        arrays.add(mesh.colors, meshes[i].colors);
        arrays.add(mesh.indices, meshes[i].indices);
    }
    arrays.add(meshes, view.meshes);
    return arrays;
}

struct Instances {
    std::vector<InstanceView> views;
    std::vector<uint32_t> passing;        // see SceneView
    std::vector<uint32_t> first_triangle; // see SceneView
};

/// Returns Instance::layers_above; 0 if a layer has been moved since, or has another number of triangles.
uint16_t layers_above(const Scene& scene, std::size_t instance) {
    const auto triangles = [&](std::size_t i) { return scene.meshes[scene.instances[i].mesh].triangle_count(); };
    const uint32_t count = scene.instances[instance].layers_above;
    if (count > instance || count > UINT16_MAX) return 0;
    for (uint32_t k = 1; k <= count; ++k) {
        if (triangles(instance - k) != triangles(instance)) return 0;
        if (!(scene.instances[instance - k].world_from_local == scene.instances[instance].world_from_local)) return 0;
    }
    return static_cast<uint16_t>(count);
}

PartArrays list_instances(const PlacedScene& prepared, const std::vector<bool>& is_thin_wall, Instances& instances,
                          SceneView& view) {
    const Scene& scene = *prepared.scene;
    view.any_alpha = 0;
    view.any_unlit = 0;
    view.any_hidden_back = 0;
    view.centre = prepared.centre;
    // Relative to the file's origin; in a far scene positions stay relative to the scene's own, because floats could
    // not distinguish them there.
    view.position_shift = scene.is_far ? prepared.centre : to_float(scene.origin_in_file + to_double(prepared.centre));
    instances.views.reserve(scene.instances.size());
    instances.passing.resize((scene.instances.size() + 31) / 32);
    view.instance_count = static_cast<uint32_t>(scene.instances.size());
    view.background = 0;
    view.triangle_count = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Transform world_from_local = moved_to(instance.world_from_local, prepared.centre);
        const Material& material = scene.materials[instance.material];
        instances.first_triangle.push_back(static_cast<uint32_t>(view.triangle_count));
        view.triangle_count += scene.meshes[instance.mesh].triangle_count();
        const uint16_t has_alpha = material.alpha_mode != AlphaMode::Opaque ? 1 : 0;
        const uint16_t hides_back = material.double_sided ? 0 : 1;
        const uint16_t is_wall = !is_thin_wall.empty() && is_thin_wall[i] ? 1 : 0;
        if (instance.is_background) view.background = static_cast<uint32_t>(i) + 1;
        view.any_alpha |= has_alpha;
        view.any_unlit |= material.is_unlit() ? 1u : 0u;
        view.any_hidden_back |= hides_back;
        instances.passing[i / 32] |= uint32_t(has_alpha | hides_back | is_wall) << i % 32;
        instances.views.push_back({world_from_local, inverse(world_from_local), instance.mesh, instance.material,
                                   has_alpha, hides_back, uint16_t(is_mirroring(world_from_local)),
                                   uint16_t(instance.is_hidden), uint16_t(prepared.is_baked[i] ? 1 : 0),
                                   layers_above(scene, i), is_wall});
    }
    instances.first_triangle.push_back(static_cast<uint32_t>(view.triangle_count));
    if (view.triangle_count > UINT32_MAX) instances.first_triangle.clear();
    PartArrays arrays;
    arrays.add(instances.views, view.instances);
    arrays.add(instances.passing, view.passing);
    arrays.add(instances.first_triangle, view.first_triangle);
    static const MotionKeys none;
    const MotionKeys& motions = prepared.motions != nullptr ? *prepared.motions : none;
    arrays.add(motions.keys, view.motions.keys);
    arrays.add(motions.pivots, view.motions.pivots);
    arrays.add(motions.of_instance, view.motions.of_instance);
    view.motions.segments = motions.segments;
    return arrays;
}

SolidAbsorption absorption_of(std::span<const MaterialParameters> materials) {
    SolidAbsorption absorption = SolidAbsorption::None;
    for (const MaterialParameters& material : materials) {
        if (material.absorbs())
            absorption = max(absorption, material.is_emitter() ? SolidAbsorption::OfEmitters : SolidAbsorption::Some);
    }
    return absorption;
}

struct Materials {
    std::vector<MaterialParameters> parameters;
    std::vector<uint8_t> groups; // SceneView::shading_groups
};

/// Returns the least alpha that counts as at least the cutoff. Alpha is a product of a factor, bilinear texels and a
/// vertex's alpha, and each of these rounds by at most 2^-23 of itself, so a value that equals the cutoff exactly may
/// come out slightly below it. One step of a 16-bit texel is 32 times more than this. A cutoff above 1 hides
/// everything.
float alpha_that_reaches(float cutoff) { return cutoff > 1 ? cutoff : (1.0f - 0x1p-21f) * cutoff; }

/// Returns what the device has of a material. The base colour of a conductor, which its index replaces, is the
/// reflectance at normal incidence there, for the layer `albedo`.
MaterialParameters parameters_for_device(const Material& material) {
    MaterialParameters parameters = material;
    parameters.alpha_cutoff = alpha_that_reaches(material.alpha_cutoff);
    if (material.kind == MaterialKind::Conductor) {
        parameters.base_color = fresnel_conductor(1.0f, material.eta, material.k);
        if (material.alpha_mode == AlphaMode::Opaque) parameters.base_color_texture = {}; // else its alpha counts
    }
    return parameters;
}

PartArrays list_materials(const Scene& scene, Materials& materials, SceneView& view) {
    for (const Material& material : scene.materials) materials.parameters.push_back(parameters_for_device(material));
    materials.groups = shading_groups(materials.parameters);
    const bool has_tables = std::ranges::any_of(scene.lights, [](const Light& l) { return parts_of(l.kind).table; });
    view.variant = has_tables ? ShadingVariant::General : variant_of(materials.parameters);
    view.absorption = absorption_of(materials.parameters);
    PartArrays arrays;
    arrays.add(materials.parameters, view.materials);
    arrays.add(materials.groups, view.shading_groups);
    return arrays;
}

/// Images as they are on the device.
struct Textures {
    std::vector<PackedTexels> packed; // [images]
    std::vector<float> linear_from_srgb;
};

PartArrays list_textures(const Scene& scene, Textures& textures, std::vector<TextureImageView>& images,
                         SceneView& view) {
    PartArrays arrays;
    images = views_of_images(scene);
    textures.packed.resize(images.size());
    const std::span<const float> of_bytes = srgb_decode_table();
    textures.linear_from_srgb.assign(of_bytes.begin(), of_bytes.end());
    for (std::size_t i = 0; i < images.size(); ++i) {
        const std::vector<float>& floats = scene.images[i].rgba_float.pixels;
        PackedTexels& packed = textures.packed[i];
        if (!floats.empty()) packed = pack_texels(floats), images[i].depth = packed.depth;
        arrays.add(scene.images[i].rgba8.pixels, images[i].rgba8);
        arrays.add(packed.words, images[i].rgba16);
        arrays.add(packed.words.empty() ? std::span<const float>(floats) : std::span<const float>(),
                   images[i].rgba_float);
        if (packed.depth != TexelDepth::Srgb16 || textures.linear_from_srgb.size() > kSrgbBytes) continue;
        const std::span<const float> of_words = srgb_words_table();
        textures.linear_from_srgb.insert(textures.linear_from_srgb.end(), of_words.begin(), of_words.end());
    }
    arrays.add(images, view.images);
    arrays.add(textures.linear_from_srgb, view.linear_from_srgb);
    return arrays;
}

/// Returns which images have sRGB-encoded colours for some material.
std::vector<bool> find_srgb_images(const Scene& scene) {
    std::vector<bool> are_srgb(scene.images.size());
    for (const Material& material : scene.materials) {
        for (const TextureRef* texture : material.textures()) {
            if (texture->is_srgb) are_srgb[static_cast<std::size_t>(texture->image)] = true;
        }
    }
    return are_srgb;
}

void add_table(PartArrays& arrays, const GuidedCdf& table, GuidedCdfView& view) {
    arrays.add(table.starts, view.starts);
    arrays.add(table.guide, view.guide);
}

PartArrays list_lights(const LightSetData& lights, LightSetView& view) {
    PartArrays arrays;
    add_table(arrays, lights.choice, view.choice);
    visit_arrays(lights, view, [&](const auto& array, auto& pointer) { arrays.add(array, pointer); });
    return arrays;
}

PartArrays list_environment(const EnvironmentData* environment, EnvironmentView& view) {
    PartArrays arrays;
    if (environment == nullptr) return arrays;
    arrays.add(environment->pixels, view.pixels);
    arrays.add(environment->row_bounds, view.row_bounds);
    add_table(arrays, environment->rows, view.rows);
    add_table(arrays, environment->columns, view.columns);
    return arrays;
}

} // namespace

ShadingVariant shading_variant(const Scene& scene) {
    Materials materials;
    SceneView view = {};
    list_materials(scene, materials, view);
    return view.variant;
}

SceneOnDevice::SceneOnDevice(Queue& queue, const PlacedScene& prepared) { update(queue, prepared, kAllParts); }

void SceneOnDevice::update(Queue& queue, const PlacedScene& prepared, uint32_t parts) {
    if ((parts & kPartShapes) != 0) update_shapes(queue, prepared);
    if ((parts & (kPartShapes | kPartGeometry)) != 0) update_geometry(queue, prepared);
    if ((parts & kPartPoses) != 0) update_poses(prepared);
    bool has_other_walls = false;
    if ((parts & (kPartGeometry | kPartInstances | kPartMaterials)) != 0) {
        std::vector<bool> walls = find_thin_walls(prepared);
        has_other_walls = walls != thin_walls_;
        thin_walls_ = std::move(walls);
    }
    if ((parts & kPartInstances) != 0 || has_other_walls) update_instances(queue, prepared);
    if ((parts & kPartMaterials) != 0) update_materials(queue, *prepared.scene);
    if ((parts & kPartGeometry) != 0) closed_meshes_.clear();
    if ((parts & (kPartGeometry | kPartInstances | kPartMaterials)) != 0) {
        update_nesting(queue, prepared);
        const bool may_have_other_media = has_media(*prepared.scene) || view_.has_media != 0;
        if ((parts & (kPartGeometry | kPartInstances)) != 0 || has_other_walls || may_have_other_media) {
            update_crossed(queue, prepared);
        }
    }
    if ((parts & kPartTextures) != 0) update_textures(queue, *prepared.scene);
    if ((parts & kPartLights) != 0) update_lights(queue, prepared); // after the textures, which it reads
    if ((parts & (kPartGeometry | kPartInstances | kPartMaterials | kPartLights)) != 0) {
        update_interiors(queue, prepared);
    }
    if ((parts & kPartEnvironment) != 0) update_environment(queue, prepared);
    update_micromaps(queue, *prepared.scene, parts);
}

/// Updates opacity micromaps on a GPU. A CPU has none, because there texture lookups cost less than making micromaps.
void SceneOnDevice::update_micromaps(Queue& queue, const Scene& scene, uint32_t parts) {
    if (!queue.is_cuda()) return;
    constexpr uint32_t kMadeOf = kPartShapes | kPartGeometry | kPartMaterials | kPartTextures;
    try {
        if ((parts & (kMadeOf | kPartInstances)) != 0) micromaps_.update(queue, scene, view_, (parts & kMadeOf) != 0);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OutOfMemory) throw;
        micromaps_ = OpacityMicromaps(); // the picture is the same without
    }
    view_.micromaps = micromaps_.of_instances();
}

void SceneOnDevice::update_shapes(Queue& queue, const PlacedScene& prepared) {
    const uint64_t version = deforming_.version();
    deforming_ = DeformingMeshes(); // freed before the new ones, so that both need not fit
    deforming_ = DeformingMeshes(queue, prepared, version);
}

void SceneOnDevice::update_geometry(Queue& queue, const PlacedScene& prepared) {
    std::vector<MeshView> meshes;
    const PartArrays arrays = list_geometry(prepared, meshes, view_);
    deforming_.point(meshes);
    arrays.upload(queue, geometry_, "geometry");
    deforming_.set_meshes(meshes);
    if (deforming_.is_empty()) meshes.clear();
    meshes_ = std::move(meshes);
}

void SceneOnDevice::update_instances(Queue& queue, const PlacedScene& prepared) {
    Instances instances;
    list_instances(prepared, thin_walls_, instances, view_).upload(queue, instances_, "instances");
}

void SceneOnDevice::update_materials(Queue& queue, const Scene& scene) {
    Materials materials;
    list_materials(scene, materials, view_).upload(queue, materials_, "materials");
    variant_ = view_.variant;
}

void SceneOnDevice::update_nesting(Queue& queue, const PlacedScene& prepared) {
    nested_ = NestedSolids(*prepared.scene, prepared.centre, closed_meshes_);
    view_.nesting = {};
    view_.variant = nested_.is_empty() ? variant_ : ShadingVariant::General;
    PartArrays arrays;
    arrays.add(nested_.ranks(), view_.nesting.ranks);
    arrays.add(nested_.instances(), view_.nesting.solids);
    arrays.upload(queue, nesting_, "nested solids");
}

/// Updates what a ray crosses straight on its way: media, their clear boundaries, and thin walls.
void SceneOnDevice::update_crossed(Queue& queue, const PlacedScene& prepared) {
    const CrossedSurfaces boundaries = find_medium_boundaries(prepared);
    const CrossedSurfaces walls = surfaces_of_thin_walls(prepared, thin_walls_);
    PartArrays arrays;
    const auto add = [&](const CrossedSurfaces& surfaces, CrossedSurfacesView& view) {
        view = {view_of(surfaces.tree)};
        arrays.add(surfaces.tree.nodes, view.tree.nodes);
        arrays.add(surfaces.tree.triangles, view.tree.triangles);
        arrays.add(surfaces.triangles, view.triangles);
    };
    add(boundaries, view_.boundaries);
    add(walls, view_.thin_walls);
    view_.has_media = has_media(*prepared.scene) ? 1 : 0;
    view_.surroundings = nullptr;
    std::vector<MaterialParameters> around(view_.has_media);
    if (!around.empty()) around[0].medium = prepared.scene->medium;
    arrays.add(around, view_.surroundings);
    arrays.upload(queue, crossed_, "boundaries of media, and thin walls");
}

/// Finds the solids that hold each light, whose particles begin in their media.
void SceneOnDevice::update_interiors(Queue& queue, const PlacedScene& prepared) {
    view_.nesting.of_lights = nullptr;
    if (view_.has_media == 0 || nested_.is_empty()) return;
    const std::vector<EmissiveTriangle>& triangles = prepared.lights.triangles;
    const std::vector<PunctualLight>& punctual = prepared.lights.punctual;
    std::vector<Uint2> found(triangles.size() + punctual.size());
    parallel_for(triangles.size(), 16, [&](uint64_t i) {
        const EmissiveTriangle& light = triangles[i];
        const InteriorList list = nested_.at(point_before(light));
        const uint32_t own = nested_.ranks()[light.instance];
        found[i] = (own == 0 ? list : list.without(own)).words();
    });
    for (std::size_t i = 0; i < punctual.size(); ++i) {
        found[triangles.size() + i] = nested_.at(punctual[i].position).words();
    }
    PartArrays arrays;
    arrays.add(found, view_.nesting.of_lights);
    arrays.upload(queue, interiors_, "media of lights");
}

void SceneOnDevice::update_textures(Queue& queue, const Scene& scene) {
    mip_maps_.reset(); // made of the former ones
    Textures textures;
    list_textures(scene, textures, images_, view_).upload(queue, textures_, "textures");
    are_srgb_ = find_srgb_images(scene);
    view_.lights.images = view_.images; // lights read textures too
    view_.lights.linear_from_srgb = view_.linear_from_srgb;
}

void SceneOnDevice::make_mip_maps(Queue& queue) {
    if (mip_maps_ || images_.empty()) return;
    mip_maps_.emplace(queue, images_, are_srgb_, view_.linear_from_srgb);
    view_.images = mip_maps_->images();
}

void SceneOnDevice::update_lights(Queue& queue, const PlacedScene& prepared) {
    const EnvironmentView environment = view_.lights.environment;
    view_.lights = view_of(prepared.lights, view_.images, view_.linear_from_srgb);
    view_.lights.environment = environment;
    list_lights(prepared.lights, view_.lights).upload(queue, lights_, "lights");
    light_tree_ = prepared.lights.tree;
    const uint32_t tree_lights = view_.lights.tree.light_count;
    view_.lights.tree = {}; // the memory of the last one is used again
    view_.lights.tree.light_count = tree_lights;
}

void SceneOnDevice::make_light_tree(Queue& queue) {
    if (view_.lights.tree.nodes != nullptr || view_.lights.tree.light_count == 0) return;
    const LightTreeData& data = light_tree_->get();
    PartArrays arrays;
    LightTreeView& view = view_.lights.tree;
    arrays.add(std::span<const LightTreeNode>(data.nodes), view.nodes);
    arrays.add(data.leaf_of_light, view.leaf_of_light);
    arrays.add(data.instances, view.instances);
    arrays.add(data.leaf_of_triangle, view.leaf_of_triangle);
    arrays.upload(queue, light_nodes_, "light tree");
}

void SceneOnDevice::update_environment(Queue& queue, const PlacedScene& prepared) {
    const EnvironmentData* environment = prepared.lights.environment.get();
    EnvironmentView& view = view_.lights.environment;
    view = environment != nullptr ? view_of(*environment) : EnvironmentView{};
    list_environment(environment, view).upload(queue, environment_, "environment");
}

std::size_t predicted_bytes(const PlacedScene& prepared, bool on_cuda) {
    Queue queue = Queue::make_dry_run(on_cuda);
    const SceneOnDevice scene(queue, prepared);
    return queue.allocated_bytes();
}

} // namespace pertev
