// The kernels of tracer/hploc on emulated warps build the tree that single threads build.

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>

#include "tests/support/built_trees.h"
#include "tests/support/emulated_hploc.h"
#include "tracer/hploc/device_builder.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("warps build the bytes that single threads build") {
    Queue queue = Queue::make_cpu();
    for (const StressMesh& mesh : builder_meshes()) {
        const auto n = static_cast<uint32_t>(mesh.triangles.size());
        if (n == 0 || n > 1000) continue;
        CAPTURE(mesh.name);
        CAPTURE(n);
        for (const bool balanced : {false, true}) {
            CAPTURE(balanced);
            DeviceBuilder builder(queue, n);
            builder.set_balanced(balanced);
            builder.start(mesh.triangles.data(), n);
            builder.finish();
            const CompressedBvh wanted = builder.download();
            const std::vector<hploc::ClusterNode> clusters = builder.download_clusters();

            // The second climb uses the builder's memory again, with the leaves in place.
            const hploc::Climb climb = builder.prepare_climb();
            std::fill_n(climb.ends, n, hploc::kNone);
            std::fill(climb.tree.nodes + n, climb.tree.nodes + 2 * n, hploc::ClusterNode{});
            CHECK(climb_on_emulated_warps(&climb, n, n) == "");
            const std::vector<hploc::ClusterNode> by_warps = builder.download_clusters();
            CHECK(std::memcmp(clusters.data(), by_warps.data(), n * sizeof(hploc::ClusterNode)) == 0);
            CHECK(std::memcmp(clusters.data() + n + 1, by_warps.data() + n + 1, (n - 1) * sizeof(hploc::ClusterNode)) ==
                  0);

            const hploc::EmitWide emit = builder.prepare_emit();
            std::memset(static_cast<void*>(emit.nodes), 0xcc, wanted.nodes.size() * sizeof(CompressedBvhNode));
            std::memset(static_cast<void*>(emit.placed), 0xcc, n * sizeof(BvhTriangle));
            CHECK(emit_on_emulated_warps(&emit, 3, n) == "");
            builder.finish();
            CHECK(are_same(builder.download(), wanted));
        }
    }
}
