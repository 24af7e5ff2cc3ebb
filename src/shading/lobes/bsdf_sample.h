#pragma once

// What sampling and evaluating a BSDF give. Local frame: +z is the shading normal; wo and wi point away from the
// surface, unit length; either may lie on the back (z < 0).
//
// Refraction carries radiance over the square of the refractive index, L / n^2, which does not change at an interface
// (Veach 1997, section 5.2). So no factor 1 / eta^2 appears: in a closed furnace the mean weight is 1 on both sides,
// light and importance are transported by the same numbers, and Russian roulette sees no jump. Seen from the medium
// in which a lamp stands its radiance is its own; a lamp inside glass counts as emitting n^2 times what it states.

#include <cstdint>

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// What kind of light a lobe scatters, as light-path layers and denoisers tell it apart.
enum class LobeClass : uint8_t {
    Diffuse,  // smooth over the hemisphere: bases, sheen
    Glossy,   // gathered about the mirror or the refracted direction
    Specular, // delta: one direction only
};

/// A set of classes.
struct LobeClasses {
    uint8_t bits;
    HD constexpr bool has(LobeClass c) const { return (bits >> static_cast<int>(c) & 1) != 0; }
};
inline constexpr LobeClasses kAllLobeClasses = {7};
HD inline constexpr LobeClasses only(LobeClass c) { return {static_cast<uint8_t>(1 << static_cast<int>(c))}; }

struct BsdfSample {
    Vec3 wi = {};
    Rgb weight = {}; // eval / pdf, |cos| included; of a delta lobe the factor of throughput, probability divided out
    float pdf = 0;   // 1/sr; of a delta lobe its probability (no use for MIS); 0: nothing sampled, all absorbed
    LobeClass lobe_class = LobeClass::Diffuse; // of the lobe that drew wi; weight and pdf are those of all lobes
    bool is_transmission = false;              // wi and wo on different sides

    HD bool is_delta() const { return lobe_class == LobeClass::Specular; }
};

/// eval() and pdf() of one pair of directions, which share most of their work.
struct BsdfValue {
    Rgb f = {};    // f(wo, wi) |cos(wi)|, 1/sr; without delta lobes
    float pdf = 0; // density of sample() at wi, 1/sr; without delta lobes
};

HD inline BsdfValue operator+(BsdfValue a, BsdfValue b) { return {a.f + b.f, a.pdf + b.pdf}; }

/// The sample of lobes that are not delta. A density so small that 1 / pdf would overflow (wi within 1e-30 of the
/// horizon) counts as no sample.
HD inline BsdfSample make_bsdf_sample(Vec3 wi, BsdfValue value, LobeClass lobe_class, bool is_transmission = false) {
    if (!(value.pdf > 1e-30f)) return {};
    return {.wi = wi,
            .weight = (1.0f / value.pdf) * value.f,
            .pdf = value.pdf,
            .lobe_class = lobe_class,
            .is_transmission = is_transmission};
}

} // namespace pertev
