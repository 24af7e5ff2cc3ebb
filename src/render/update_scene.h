#pragma once

// Updates a prepared scene after a frame's change. Unchanged data, above all trees, is shared with the previous
// version. The world's origin, the environment and all images stay. The picture equals, to the bit, that of the
// changed scene prepared from scratch with this origin.

#include <cstdint>

#include "render/prepare_scene.h"
#include "scene/scene_update.h"

namespace pertev {

/// Updates `before` to `scene`, which is valid, already contains the changes and outlives the result. It may be the
/// same object that `before` was made of, changed in place. Trees are handled as follows:
///   moved instances     get a new TLAS, and keep the BLASes. A baked one (MeshPlacement) counts as a
///   deformed
///                       mesh of the tree over all baked ones; an instance that moves often should be apart
///                       (PrepareOptions), so that it is not baked
///   deformed meshes     have their trees refitted, or at first replaced by one that can be (update_binary_trees), and
///                       converted to other layouts again; kd-trees and octrees, whose planes do not move, are rebuilt
///   replaced meshes     have their trees rebuilt
///   lights, materials   keep all trees
/// If other instances would have to be baked than before, everything is prepared again. Throws as prepare_scene.
/// `motions` becomes PreparedScene::motions.
PreparedScene update_scene(const PreparedScene& before, const Scene& scene, const SceneUpdate& update, Sink& sink,
                           std::shared_ptr<const MotionKeys> motions = nullptr);

/// Returns whether update_scene has anything to do. For pure vertex motion only PreparedScene::poses change.
bool changes_prepared(const SceneUpdate& update);

/// The parts (ScenePart) that Session::update_scene must then upload. They include lights if surfaces change, because
/// light selection depends on positions; meshes whose vertices the renderer moves count in their pose at rest. The
/// environment is not included, as it stays the same.
uint32_t parts_of(const SceneUpdate& update);

} // namespace pertev
