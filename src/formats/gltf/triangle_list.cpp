#include "formats/gltf/triangle_list.h"

#include "base/error.h"

namespace pertev::gltf {

std::vector<uint32_t> triangle_list(Topology topology, std::vector<uint32_t> corners) {
    if (topology == Topology::Triangles) {
        corners.resize(corners.size() / 3 * 3);
        return corners;
    }
    PERTEV_CHECK(topology == Topology::TriangleStrip || topology == Topology::TriangleFan);
    std::vector<uint32_t> triangles;
    if (corners.size() < 3) return triangles;
    triangles.reserve((corners.size() - 2) * 3);
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        if (topology == Topology::TriangleStrip) { // every other triangle of a strip runs the other way round
            const std::size_t odd = i % 2;
            triangles.insert(triangles.end(), {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]});
        } else {
            triangles.insert(triangles.end(), {corners[i + 1], corners[i + 2], corners[0]});
        }
    }
    return triangles;
}

} // namespace pertev::gltf
