#pragma once

// Results of sampling and evaluating a BSDF. In the local frame +z is the shading normal; wo and wi point away from
// the surface and have unit length; either may lie on the back (z < 0).
//
// Refraction carries radiance over the square of the refractive index, L / n^2, which does not change at an interface
// (Veach 1997, section 5.2). So there is no factor 1 / eta^2: in a closed furnace the mean weight is 1 on both sides,
// light and importance are transported by the same numbers, and Russian roulette sees no jump. Emission is added to L
// / n^2 unchanged, so an emitter inside glass counts as emitting n^2 times its stated radiance.

#include <cstdint>

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/vec3.h"

namespace pertev {

/// Kind of scattering of a lobe, which light-path layers and denoisers distinguish.
enum class LobeClass : uint8_t {
    Diffuse,  // smooth over the hemisphere: bases, sheen
    Glossy,   // concentrated around the mirror or the refracted direction
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
    Rgb weight = {}; // eval / pdf, |cos| included; for a delta lobe the throughput factor divided by the probability
    float pdf = 0;   // 1/sr; for a delta lobe its probability (unusable for MIS); 0: no sample, all is absorbed
    LobeClass lobe_class = LobeClass::Diffuse; // class of the lobe that sampled wi; weight and pdf are those of all
                                               // lobes
    bool is_transmission = false;              // wi and wo are on different sides

    HD bool is_delta() const { return lobe_class == LobeClass::Specular; }
};

/// Results of eval() and pdf() for one pair of directions, which share most of their work.
struct BsdfValue {
    Rgb f = {};    // f(wo, wi) |cos(wi)|, 1/sr; without delta lobes
    float pdf = 0; // density of sample() at wi, 1/sr; without delta lobes
};

HD inline BsdfValue operator+(BsdfValue a, BsdfValue b) { return {a.f + b.f, a.pdf + b.pdf}; }

/// Makes the sample of non-delta lobes. A density so small that 1 / pdf would overflow (wi within 1e-30 of the
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
