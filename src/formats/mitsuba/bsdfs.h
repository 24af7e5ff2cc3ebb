#pragma once

// BSDFs of Mitsuba as materials. Microfacets have the distribution that the file states (Beckmann's by default) and
// lose what one bounce loses, as there. A BSDF that Pertev has only nearly is the nearest one, with a warning. Both
// faces of a surface reflect, though in Mitsuba the back of one that is not twosided is black.

#include <cstdint>
#include <map>
#include <string_view>

#include "formats/described/surface.h"
#include "formats/mitsuba/reading.h"
#include "formats/mitsuba/textures.h"

namespace pertev::mitsuba {

using described::Surface; // a device's Surface would hide it

class Bsdfs {
public:
    /// The arguments must outlive this object.
    Bsdfs(Reading& reading, Textures& textures) : reading_(reading), textures_(textures) {}

    /// Returns the index into Parts::surfaces of an object <bsdf>. An unreadable one is grey, with a warning.
    uint32_t surface_of(Object& bsdf);

private:
    Surface read(Object& bsdf);
    Surface nested(Object& bsdf);
    Surface diffuse(Object& bsdf);
    Surface dielectric(Object& bsdf);
    Surface conductor(Object& bsdf);
    Surface plastic(Object& bsdf);
    Surface glossy(Object& bsdf);
    Surface principled(Object& bsdf);
    Surface coating(Object& bsdf);
    Surface transmitter(Object& bsdf);
    Surface part(Object& bsdf);
    Surface mixture(Object& bsdf);
    Surface mix(Object& bsdf, const Surface& first, Object& second, const TextureValue& weight);
    Surface mask(Object& bsdf);
    Surface bumpy(Object& bsdf);

    void read_roughness(Object& bsdf, Surface& surface);
    void tint_metal(const Object& bsdf, const TextureValue& tint, Surface& surface);
    float ior_of(Object& bsdf, const char* name, float missing);
    /// Returns the index inside, by default that of `substance`, over that outside, if it is usable.
    float relative_ior(Object& bsdf, const char* substance = "bk7", float least = 1);
    /// Returns the index if it is in [least, kMostIor]. Otherwise it is left out, and its reciprocal is used for one
    /// that only a bubble can have, else `missing`.
    float usable_ior(Object& bsdf, float ior, float least, float missing);
    bool has_black_back(const Surface& part) const;
    void warn_of_nearest(const Object& bsdf, std::string_view nearest);
    TextureValue color(Object& bsdf, const char* name, float missing) {
        return textures_.color(bsdf, name, ColorUse::Reflectance, grey(missing));
    }

    static constexpr std::size_t kMostReads = 4096; // a file's objects add some each

    Reading& reading_;
    Textures& textures_;
    std::size_t reads_ = 0;
    bool has_two_sides_ = false;         // the surface that is read is in a twosided BSDF
    std::map<uint32_t, uint32_t> known_; // surfaces by the object's number
};

/// Returns the index of refraction of a substance by Mitsuba's name; 0 for another.
float find_ior(std::string_view name);

} // namespace pertev::mitsuba
