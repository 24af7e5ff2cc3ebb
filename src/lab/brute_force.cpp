#include "base/parallel_for.h"
#include "lab/brute_force_rays.h"

namespace pertev {

BruteForce::BruteForce(Queue& queue, const SceneTriangles& triangles, const Tlas& tlas) : queue_(queue) {
    triangles_.emplace_back(queue, std::span(triangles.baked), "triangles");
    std::vector<TriangleRange> meshes;
    for (const auto& mesh : triangles.meshes) {
        triangles_.emplace_back(queue, std::span(mesh), "triangles");
        meshes.push_back({triangles_.back().data(), mesh.size()});
    }
    meshes_ = Buffer<TriangleRange>(queue, std::span<const TriangleRange>(meshes), "triangle ranges");
    instances_ = Buffer<InstanceRecord>(queue, std::span(tlas.instances), "instances");
}

std::vector<RayHit> BruteForce::trace(std::span<const Ray> rays, const PieceDone& done) const {
    const Buffer<Ray> on_device(queue_, rays, "rays");
    const Buffer<RayHit> hits(queue_, rays.size(), "hits");
    const auto trace_piece = [&](uint64_t begin, uint64_t count) {
        const BruteForceRays stage = {{triangles_.front().data(), triangles_.front().size()},
                                      meshes_.data(),
                                      instances_.data(),
                                      instances_.size(),
                                      on_device.data() + begin,
                                      hits.data() + begin};
        if (queue_.is_cuda()) {
            launch(queue_, "brute force", static_cast<uint32_t>(count), stage);
        } else { // a CPU gets a few rays at a time, each of which is much work
            parallel_for(count, 1, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
        }
    };
    if (queue_.is_cuda()) {
        trace_piece(0, rays.size()); // one thread per ray: a few rays would take as long as all of them
    } else {
        in_pieces(rays.size(), static_cast<uint64_t>(thread_count()), trace_piece, done);
    }
    return hits.download();
}

} // namespace pertev
