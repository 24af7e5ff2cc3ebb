#pragma once

// What a surface is made of: plain numbers and texture references; shading/ turns them into BSDFs.

#include <array>
#include <cstdint>
#include <string>

#include "math/rgb.h"
#include "scene/texture.h"

namespace pertev {

enum class MaterialKind : uint8_t {
    Diffuse,           // Lambert; base_color is the albedo
    Conductor,         // GGX metal with complex index of refraction eta + i k
    Dielectric,        // GGX glass or water, reflection and refraction; base_color tints what is refracted
    MetallicRoughness, // glTF 2.0 appendix B: metal and (diffuse + dielectric coat) mixed by `metallic`
    Unlit,             // KHR_materials_unlit: base_color is emitted as it is, nothing is reflected
};

enum class AlphaMode : uint8_t { Opaque, Mask, Blend };

struct Material {
    std::string name, origin;
    MaterialKind kind = MaterialKind::Diffuse;

    Rgb base_color = {0.5f, 0.5f, 0.5f}; // [0, 1], linear; times the texture (alpha in .w of the texture)
    TextureRef base_color_texture;

    float alpha = 1;          // [0, 1]; times the base colour texture's alpha, the vertex colour's, and alpha_texture
    TextureRef alpha_texture; // one channel, for OBJ map_d; none for glTF
    AlphaMode alpha_mode = AlphaMode::Opaque;
    float alpha_cutoff = 0.5f; // Mask: hit where alpha >= cutoff

    float metallic = 0;  // [0, 1]; times metallic_texture's channel
    float roughness = 1; // [0, 1], perceptual: alpha_ggx = roughness^2; times roughness_texture's channel
    TextureRef metallic_texture, roughness_texture;

    float ior = 1.5f; // Dielectric and MetallicRoughness: inside over outside, >= 1
    Rgb eta = {0.2f, 0.92f, 1.1f}, k = {3.9f, 2.45f, 2.14f}; // Conductor; default gold

    Rgb emission = {0, 0, 0}; // W/(sr m2); times the texture
    TextureRef emission_texture;

    // The front of a triangle is where its corners run counter-clockwise in the mesh's own space, whatever its vertex
    // normals say; so a node that mirrors a mesh leaves it its front.
    bool two_sided_emission = false; // else the front alone gives light; of unlit materials both faces are seen
    bool double_sided = true;        // else rays from the camera pass the back; every other ray is stopped by it

    TextureRef normal_texture; // tangent space, x right, y up in texture space (OpenGL convention), linear
    float normal_scale = 1;

    std::array<const TextureRef*, 6> textures() const {
        return {&base_color_texture, &alpha_texture,    &metallic_texture,
                &roughness_texture,  &emission_texture, &normal_texture};
    }
    bool is_emissive() const { return max_component(emission) > 0; }
    /// Is looked for as a light. An unlit one is not: rays from the camera or a surface that meet it see its colour.
    bool is_lamp() const { return is_emissive() && kind != MaterialKind::Unlit; }
};

} // namespace pertev
