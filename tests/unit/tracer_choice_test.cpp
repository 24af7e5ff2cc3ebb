// The trees that pictures use.

#include "tracer/tracer_choice.h"

#include <doctest/doctest.h>

#include "accel/builders/refit_bvh.h"
#include "render/prepare_scene.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("each --build names a structure, which all default tracers of both devices traverse") {
    CHECK(structure_of(TreeBuild::Fast) == StructureKind::Binned);
    CHECK(structure_of(TreeBuild::Balanced) == StructureKind::SpatialSplits);
    CHECK(structure_of(TreeBuild::Best) == StructureKind::SpatialReinsertion);
    for (const TreeBuild build : kValuesOf<TreeBuild>) {
        CHECK(value_named<TreeBuild>(name_of(build)) == build);
        for (const bool on_cuda : {false, true}) {
            const TracerChoice choice = default_tracers(on_cuda, build);
            for (const RayKind kind : kValuesOf<RayKind>) CHECK(choice[kind].structure == structure_of(build));
            CHECK(builder_of(choice) == builder_of(structure_of(build)));
        }
    }
    CHECK(default_tracers(false) == default_tracers(false, kDefaultBuild));
    CHECK(!value_named<TreeBuild>("sbvh"));
}

TEST_CASE("structures of --build fast can be refitted") {
    CHECK(!why_no_refit(*builder_of(structure_of(TreeBuild::Fast))));
}

TEST_CASE("a scene is prepared only with the trees of its tracers") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    PrepareOptions options;
    CHECK(prepare_scene(scene, options, messages).structures->builder() == *builder_of(structure_of(kDefaultBuild)));
    options.tracers = default_tracers(false, TreeBuild::Fast);
    CHECK(prepare_scene(scene, options, messages).structures->builder() == BvhBuilder::Binned);
    options.tracers->bounce = {.structure = StructureKind::Ploc, .traversal = TraversalKind::WhileWhile};
    CHECK(prepare_scene(scene, options, messages).structures->builder() == BvhBuilder::Ploc);
    options.tracers->bounce = {.structure = StructureKind::Octree, .traversal = TraversalKind::Octree};
    CHECK(prepare_scene(scene, options, messages).structures->builder() == BvhBuilder::Binned);
    options.builder = BvhBuilder::Sweep;
    CHECK(prepare_scene(scene, options, messages).structures->builder() == BvhBuilder::Sweep);
}
