#pragma once

// Properties of a BSDF's non-diffuse lobes for denoisers: a guide, which no estimate depends on.

#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

struct Gloss {
    Rgb reflectance = {0, 0, 0}; // approximate fraction of uniform light that glossy lobes scatter, [0, 1]
    float alpha = 1;             // GGX width of the sharpest, [0, 1]; 1 if there is none
    float transmittance = 1;     // transmittance of the gloss towards the viewer for light from beneath, [0, 1]
};

HD inline Gloss operator+(Gloss a, Gloss b) {
    const Rgb sum = a.reflectance + b.reflectance;
    return {{min(sum.r, 1.0f), min(sum.g, 1.0f), min(sum.b, 1.0f)},
            min(a.alpha, b.alpha),
            a.transmittance * b.transmittance};
}

} // namespace pertev
