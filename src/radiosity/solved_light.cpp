#include "radiosity/solved_light.h"

#include <optional>
#include <span>
#include <vector>

#include "scene/intensity_table.h"

namespace pertev {
namespace {

template <class T>
void add_bytes(Hasher& hasher, const T& value) {
    hasher.add(std::as_bytes(std::span(&value, 1)));
}

template <class T>
void add_list(Hasher& hasher, const std::vector<T>& values) {
    hasher.add_value(static_cast<uint64_t>(values.size()));
    hasher.add(std::as_bytes(std::span(values)));
}

void add_size(Hasher& hasher, uint32_t width, uint32_t height) {
    hasher.add_value(width);
    hasher.add_value(height);
}

class SurfaceHasher {
public:
    explicit SurfaceHasher(const Scene& scene) : scene_(scene), images_(scene.images.size()) {}

    void add(const Mesh& mesh) {
        add_list(hasher_, mesh.normals); // they may say which side is the front
        for (std::size_t set = 0; set < mesh.uv.size(); ++set) {
            if (set < 2 || !mesh.uv[set].empty()) add_list(hasher_, mesh.uv[set]); // early solutions had two
        }
        add_list(hasher_, mesh.colors);
    }

    void add(const Material& material) {
        const bool is_unlit = material.is_unlit(); // seen by the camera alone
        const bool is_diffuse = material.kind == MaterialKind::Diffuse;
        const bool is_layered = material.kind == MaterialKind::MetallicRoughness;
        hasher_.add_value(static_cast<uint32_t>(is_unlit ? 1 : is_diffuse ? 2 : is_layered ? 3 : 0));
        if (is_diffuse || is_layered) {
            add_bytes(hasher_, material.base_color);
            add(material.base_color_texture);
        }
        if (is_layered) {
            hasher_.add_value(material.metallic);
            add(material.metallic_texture);
        }
        if (material.transmits()) {
            hasher_.add_value(material.transmission_weight);
            hasher_.add_value(static_cast<uint32_t>(material.thin_walled));
            add(material.transmission_texture);
        }
        if (material.has_rough_diffuse()) hasher_.add_value(material.base_diffuse_roughness);
        if (material.has_diffuse_transmission()) {
            hasher_.add_value(material.diffuse_transmission_weight);
            add(material.diffuse_transmission_texture);
        }
        if (material.is_emitter() && material.has_coat()) {
            for (const float value : {material.coat_weight, material.coat_roughness, material.coat_ior})
                hasher_.add_value(value);
            if (!(material.coat_color == Rgb{1, 1, 1})) add_bytes(hasher_, material.coat_color);
            add(material.coat_texture);
            add(material.coat_roughness_texture);
            if (material.coat_color_texture.has_image()) add(material.coat_color_texture);
        }
        hasher_.add_value(static_cast<uint32_t>(material.is_emitter()));
        if (material.is_emitter()) {
            add_bytes(hasher_, material.emission);
            add(material.emission_texture);
            hasher_.add_value(static_cast<uint32_t>(material.two_sided_emission));
        }
        hasher_.add_value(static_cast<uint32_t>(material.alpha_mode));
        if (material.alpha_mode == AlphaMode::Opaque) return;
        hasher_.add_value(material.alpha);
        hasher_.add_value(material.alpha_cutoff);
        add(material.alpha_texture);
        add(material.base_color_texture);
    }

    Hash128 result() const { return hasher_.result(); }

private:
    void add(const TextureRef& ref) {
        hasher_.add_value(static_cast<uint32_t>(ref.has_image()));
        if (!ref.has_image()) return;
        add_bytes(hasher_, of_image(static_cast<std::size_t>(ref.image)));
        const uint32_t how[] = {static_cast<uint32_t>(ref.wrap_s),
                                static_cast<uint32_t>(ref.wrap_t),
                                static_cast<uint32_t>(ref.filter),
                                ref.uv_set,
                                ref.is_srgb,
                                ref.channel};
        hasher_.add_values(std::span<const uint32_t>(how));
        const float matrix[] = {ref.m00, ref.m01, ref.m02, ref.m10, ref.m11, ref.m12};
        hasher_.add_values(std::span<const float>(matrix));
    }

    const Hash128& of_image(std::size_t number) {
        std::optional<Hash128>& known = images_[number];
        if (!known) {
            const TextureImage& image = scene_.images[number];
            Hasher hasher;
            add_size(hasher, image.rgba8.width, image.rgba8.height);
            add_list(hasher, image.rgba8.pixels);
            add_size(hasher, image.rgba_float.width, image.rgba_float.height);
            add_list(hasher, image.rgba_float.pixels);
            known = hasher.result();
        }
        return *known;
    }

    const Scene& scene_;
    Hasher hasher_;
    std::vector<std::optional<Hash128>> images_; // hashes of images that have been needed
};

Hash128 surfaces_hash(const Scene& scene) {
    std::vector<bool> is_used(scene.materials.size());
    for (const Instance& instance : scene.instances) is_used[instance.material] = true;
    SurfaceHasher hasher(scene);
    for (const Mesh& mesh : scene.meshes) hasher.add(mesh);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        if (is_used[i]) hasher.add(scene.materials[i]);
    }
    return hasher.result();
}

Hash128 lights_hash(const Scene& scene) {
    Hasher hasher;
    for (const Light& light : scene.lights) {
        hasher.add_value(static_cast<uint32_t>(light.kind));
        add_bytes(hasher, shown_intensity(light));
        const LightParts parts = parts_of(light.kind);
        if (parts.position) {
            add_bytes(hasher, light.position);
            hasher.add_value(light.range);
        }
        if (parts.direction) add_bytes(hasher, light.direction);
        if (parts.cone) {
            hasher.add_value(light.cos_inner);
            hasher.add_value(light.cos_outer);
        }
        if (parts.table) {
            hasher.add_value(light.table->hash);
            add_bytes(hasher, light.up);
            hasher.add_value(static_cast<uint32_t>(light.is_mirrored));
        }
    }
    hasher.add_value(static_cast<uint64_t>(scene.lights.size()));
    if (!scene.environment) return hasher.result();
    const Environment& environment = *scene.environment;
    add_bytes(hasher, environment.scale);
    add_size(hasher, environment.image.width, environment.image.height);
    add_list(hasher, environment.image.pixels);
    if (!environment.image.pixels.empty())
        hasher.add_value(environment.rotation); // otherwise it is rotationally symmetric
    return hasher.result();
}

} // namespace

SolvedLight solved_light(const Scene& scene) { return {surfaces_hash(scene), lights_hash(scene)}; }

} // namespace pertev
