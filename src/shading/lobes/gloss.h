#pragma once

// What a denoiser knows of the lobes of a BSDF that are not diffuse: a guide, no part of any estimate.

#include "math/rgb.h"
#include "math/scalar.h"

namespace pertev {

struct Gloss {
    Rgb reflectance = {0, 0, 0}; // about the share of light from all around that they scatter, [0, 1]
    float alpha = 1;             // GGX width of the sharpest, [0, 1]; 1 without one
    float passage = 1;           // share of light that they leave to the eye of what lies beneath, [0, 1]
};

HD inline Gloss operator+(Gloss a, Gloss b) {
    const Rgb sum = a.reflectance + b.reflectance;
    return {{min(sum.r, 1.0f), min(sum.g, 1.0f), min(sum.b, 1.0f)}, min(a.alpha, b.alpha), a.passage * b.passage};
}

} // namespace pertev
