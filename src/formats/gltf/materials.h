#pragma once

// Converts glTF materials to Scene materials, in the order of their first use; unused ones are not read. An
// unreadable property is left out, and the rest of the material is read.
//
// Source: glTF 2.0 section 3.9; KHR_materials_emissive_strength, KHR_materials_ior, KHR_materials_unlit,
// KHR_materials_pbrSpecularGlossiness; KHR_materials_variants. material_layers.cpp reads
// KHR_materials_clearcoat, _sheen, _specular, _transmission, _volume, _dispersion, _anisotropy, _iridescence,
// _diffuse_transmission and _retroreflection. Occlusion textures are not read, because a path tracer computes what they
// approximate.

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/gltf/leave_out.h"
#include "formats/gltf/specular_glossiness.h"
#include "formats/gltf/textures.h"
#include "scene/scene.h"

namespace pertev::gltf {

class Materials {
public:
    /// Reads materials on demand. A null `textures` leaves all materials out: every surface is then the same grey.
    /// `animated` has the JSON pointers of what animations change: a factor among them is read with all that belongs to
    /// it, even where it has no effect at rest.
    Materials(const Document& document, Textures* textures, std::set<std::string> animated, Scene& scene, Sink& sink)
        : document_(document), textures_(textures), animated_(std::move(animated)), scene_(scene), sink_(sink),
          by_index_(document.table("materials").size()) {}

    /// Index in scene.materials of the material of `primitive` in the scene's variant; glTF's default material if it
    /// names none.
    uint32_t material_of(const JsonValue& primitive);

    uint32_t default_material();

    /// Index in scene.materials of a material of the file; nothing if no primitive has it.
    std::optional<uint32_t> index_of(uint32_t number) const { return by_index_.at(number); }

    /// Finishes materials of KHR_materials_pbrSpecularGlossiness after the scene's images have been decoded. `limit`
    /// is the maximum number of bytes of the images that this makes.
    void convert_textures(uint64_t limit);

private:
    /// Runs `read`. If a member of `source` cannot be read, only that member is left out.
    template <class Read>
    void attempt_at(const JsonValue& source, const Read& read) const {
        read_or_leave_out(fmt::format("this property of {}", source.pointer()), sink_, read);
    }
    /// Returns whether an animation changes a factor "EXTENSION/NAME" of a material.
    bool is_animated(const JsonValue& source, std::string_view factor) const;
    bool changes_metal(const JsonValue& source) const;
    std::optional<JsonValue> material_in_variant(const JsonValue& primitive) const;
    uint32_t add(Material material);
    Material read(const JsonValue& material);
    void read_metallic_roughness(const JsonValue& pbr, Material& material);
    void read_emission(const JsonValue& source, Material& material);
    void read_specular_glossiness(const JsonValue& source, Material& material);
    void read_alpha(const JsonValue& source, Material& material) const;
    void read_specular(const JsonValue& source, Material& material);
    void read_transmission(const JsonValue& source, Material& material);
    /// Reads one without effect only if it `changes`.
    static void read_attenuation(const JsonValue& volume, bool changes, Material& material);
    void read_dispersion(const JsonValue& source, Material& material);
    void read_anisotropy(const JsonValue& source, Material& material);
    void read_retroreflection(const JsonValue& source, Material& material);
    void read_thin_film(const JsonValue& source, Material& material);
    void read_diffuse_transmission(const JsonValue& source, Material& material);
    void read_scatter(const JsonValue& source, Material& material);
    void read_coat(const JsonValue& source, Material& material);
    void read_fuzz(const JsonValue& source, Material& material);
    void read_ior(const JsonValue& source, Material& material) const;
    TextureRef read_texture(const JsonValue& parent, std::string_view key, bool is_srgb);
    /// Reads a slot that uses one channel of its image, which is linear.
    TextureRef read_channel(const JsonValue& parent, std::string_view key, uint8_t channel);

    const Document& document_;
    Textures* textures_;
    std::set<std::string> animated_;
    Scene& scene_;
    Sink& sink_;
    std::vector<std::optional<uint32_t>> by_index_;
    std::vector<PendingGloss> pending_;
    std::optional<uint32_t> default_; // glTF's default material, or the grey without materials
};

} // namespace pertev::gltf
