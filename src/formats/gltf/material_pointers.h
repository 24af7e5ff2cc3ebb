#pragma once

// The numbers of materials, and the transforms of their textures, that animations may change. Source:
// KHR_animation_pointer and the glTF 2.0 Asset Object Model, for the factors of the core material and of the extensions
// that are read.

#include <optional>
#include <string_view>

#include "formats/gltf/document.h"
#include "scene/scene.h"

namespace pertev::gltf {

inline constexpr float kAbbeNumberOfDispersion = 20; // that of a KHR_materials_dispersion of 1

struct MaterialPointer {
    uint32_t material = 0; // index in the file
    AnimatedPart part = AnimatedPart::MaterialNumbers;
    std::vector<uint8_t> numbers; // AnimationChannel::numbers
    std::size_t components = 1;   // number in a value of the file; 1 if it sets all numbers
    float scale = 1;              // factor of the values
    Rgb factor = {1, 1, 1};       // factor of a value that sets three numbers
    TextureTransform texture_at_rest;
};

/// Returns the part of a material that a JSON pointer names; nothing for another pointer.
std::optional<MaterialPointer> find_material_pointer(const Document& document, std::string_view pointer);

} // namespace pertev::gltf
