#pragma once

// Form factors by a hemicube: half a cube about the middle of a patch, whose pixels each stand for a known share of the
// hemisphere. Triangles are projected on its five faces with a depth buffer that keeps which one is seen; a patch's
// form factor is the sum over the pixels where it is.
//
// Source: Cohen, Greenberg, "The Hemi-Cube: A Radiosity Solution for Complex Environments", SIGGRAPH 1985.

#include <cstdint>
#include <vector>

#include "math/double_vec3.h"
#include "math/frame.h"

namespace pertev {

/// Of a hemicube with `resolution` pixels along an edge of its top; the sides are half as high.
class HemicubePixels {
public:
    explicit HemicubePixels(uint32_t resolution);

    /// One face: the top is number 0.
    struct Face {
        Vec3 right, up, forward; // unit
        uint32_t width, height;  // pixels
        double lowest;           // up coordinate of its lower edge, at distance 1: -1 of the top, 0 of a side
        const float* shares;     // [pixels] form factors
    };
    static constexpr uint32_t kFaces = 5;
    /// Of a hemicube about `frame`'s normal.
    Face face(const Frame& frame, uint32_t number) const;

    uint32_t resolution() const { return resolution_; }

private:
    uint32_t resolution_;
    std::vector<float> top_, side_; // all pixels of all faces are 1 together
};

/// A triangle as a face sees it: homogeneous edge functions (Olano, Greer 1997), so that nothing has to be clipped.
struct HemicubeTriangle {
    DoubleVec3 edge[3];      // of (x, y, 1)
    double det;              // depth = det / sum of the edge functions
    uint32_t x0, x1, y0, y1; // pixels that it may cover

    /// Where a pixel lies in the triangle: shares of its corners. False outside. `depth`: metres along the face's axis.
    bool covers(double x, double y, double (&weights)[3], double& depth) const {
        double sum = 0;
        for (int i = 0; i < 3; ++i) {
            weights[i] = edge[i].x * x + edge[i].y * y + edge[i].z;
            if (!(weights[i] >= 0)) return false;
            sum += weights[i];
        }
        if (!(sum > 0)) return false;
        for (double& weight : weights) weight /= sum;
        depth = det / sum;
        return true;
    }
};

/// Corners in metres from the hemicube's middle. False where the face sees nothing of it.
bool see_triangle(const HemicubePixels::Face& face, const Vec3 (&corners)[3], HemicubeTriangle& seen);

/// Of a column or row of a face, at distance 1.
inline double place_of_pixel(uint32_t pixel, uint32_t pixels, double lowest, double extent) {
    return lowest + extent * ((pixel + 0.5) / pixels);
}

} // namespace pertev
