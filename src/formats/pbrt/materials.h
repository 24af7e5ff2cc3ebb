#pragma once

// Materials of pbrt-v4 and v3 as those of Pertev. All have microfacets of GGX and lose what one bounce loses, as there.
// A material that Pertev has only nearly is the nearest one, with a warning.

#include <functional>
#include <string>

#include "formats/described/make_surface.h"
#include "formats/described/surface.h"
#include "formats/pbrt/context.h"
#include "formats/pbrt/textures.h"

namespace pertev::pbrt {

using described::Surface; // a device's Surface would hide it

/// Finds a named material for a mixture, with its location for messages; null after a warning if there is none.
using FindMaterial = std::function<const Surface*(const std::string& name, const FileLocation& from)>;

/// The parts that materials are made from.
struct MaterialSource {
    const std::string& type;
    Parameters& parameters;
    Textures& textures;
    const Context& context;
    const FindMaterial& find;
};

/// Reads a material. One whose type is unknown, or that is unreadable, is grey, with a warning.
Surface read_material(const MaterialSource& source);

/// Reads a type that only pbrt-v3 has; nothing if it has none of this name.
std::optional<Surface> read_version_3_material(const MaterialSource& source);
/// Returns the types of pbrt-v3.
std::span<const std::string_view> version_3_materials();

/// Reads roughness, uroughness, vroughness and remaproughness. pbrt-v3 remaps a roughness of 0 to 0.22.
void read_roughness(const MaterialSource& source, double missing, std::string_view prefix, Surface& surface);
/// Reads the roughness of glass, which is smooth in pbrt-v3 too if it is 0 along both u and v.
void read_glass_roughness(const MaterialSource& source, Surface& surface);
/// Reads a subsurface material as a medium in a body of glass, in which paths scatter at random.
Surface read_subsurface(const MaterialSource& source);
/// Reads the bump map or normal map that all materials may have.
void read_bumps(const MaterialSource& source, Surface& surface);
/// Returns the index if it is in [least, kMostIor]. Otherwise it is left out, and `least` is used for one that only a
/// bubble can have, else `missing`.
float usable_ior(float ior, float least, float missing, const MaterialSource& source);
/// Warns once that materials of a type are drawn as the nearest one.
void warn_of_nearest(const MaterialSource& source, std::string_view nearest);

} // namespace pertev::pbrt
