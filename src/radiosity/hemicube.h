#pragma once

// Form factors by a hemicube: half a cube around the middle of a patch, each of whose pixels represents a known share
// of the hemisphere. Triangles are projected onto its five faces with a depth buffer; a patch's form factor is the
// sum over the pixels in which it is visible.
//
// Source: Cohen, Greenberg, "The Hemi-Cube: A Radiosity Solution for Complex Environments", SIGGRAPH 1985.

#include <cstdint>
#include <vector>

#include "math/double_vec3.h"
#include "math/frame.h"

namespace pertev {

/// Pixels of a hemicube with `resolution` pixels along an edge of its top; the sides are half as high.
class HemicubePixels {
public:
    explicit HemicubePixels(uint32_t resolution);

    /// A face of the hemicube; the top is number 0.
    struct Face {
        Vec3 right, up, forward; // unit
        uint32_t width, height;  // pixels
        double lowest;           // up coordinate of its lower edge, at distance 1: -1 for the top, 0 for a side
        const float* shares;     // [pixels] form factors
    };
    static constexpr uint32_t kFaces = 5;
    /// Face of a hemicube around `frame`'s normal.
    Face face(const Frame& frame, uint32_t number) const;

    uint32_t resolution() const { return resolution_; }

private:
    uint32_t resolution_;
    std::vector<float> top_, side_; // the pixels of all faces add up to 1
};

/// A triangle on a face: homogeneous edge functions (Olano, Greer 1997), so that nothing needs clipping.
struct HemicubeTriangle {
    DoubleVec3 edge[3];      // edge functions of (x, y, 1)
    double det;              // depth = det / sum of the edge functions
    uint32_t x0, x1, y0, y1; // pixels that it may cover

    /// Computes the barycentric weights of a pixel in the triangle. Returns false outside. `depth` is in metres along
    /// the face's axis.
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

/// Projects a triangle to a face. Corners are in metres relative to the hemicube's middle. Returns false if no part of
/// the triangle is visible on the face.
bool project_to_face(const HemicubePixels::Face& face, const Vec3 (&corners)[3], HemicubeTriangle& seen);

/// Coordinate of a pixel's column or row on a face, at distance 1.
inline double pixel_coordinate(uint32_t pixel, uint32_t pixels, double lowest, double extent) {
    return lowest + extent * ((pixel + 0.5) / pixels);
}

} // namespace pertev
