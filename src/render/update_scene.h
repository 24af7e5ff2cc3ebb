#pragma once

// A prepared scene after a frame's change: what did not change is shared with the scene before, trees above all. The
// world's centre stays, as it follows no motion. The picture is, to the bit, that of the changed scene prepared afresh
// with this centre. The environment and all images stay too.

#include <cstdint>

#include "render/prepare_scene.h"
#include "scene/scene_update.h"

namespace pertev {

/// `scene` is valid and has the changes in it; it outlives what is returned, and may be the very scene that `before`
/// was made of, changed where it stands. Of the trees,
///   moved instances     take a new top level; none of the meshes' trees. One that is baked (MeshPlacement) counts as a
///                       deformed mesh of the tree over all baked ones: whoever moves often should be able to move
///                       (scene/animation.h), so that it is not
///   deformed meshes     have theirs refitted, or at first replaced by one that can be (update_binary_trees), and its
///                       other layouts made anew of it; kd-trees and octrees, whose planes do not move along, are built
///   replaced meshes     have theirs built anew
/// Where other instances would have to be baked than before, all is prepared anew. Throws as prepare_scene. `motions`:
/// PreparedScene's from now on.
PreparedScene update_scene(const PreparedScene& before, const Scene& scene, const SceneUpdate& update,
                           Messages& messages, std::shared_ptr<const MotionKeys> motions = nullptr);

/// Whether update_scene has anything to do: PreparedScene::poses are all that whoever moves vertices has to set anew.
bool changes_prepared(const SceneUpdate& update);

/// The parts (ScenePart) that Session::update_scene then takes. Lights are among them but for poses alone: how often
/// each is drawn depends on what lies where, meshes whose vertices are left to whoever renders taken as at rest. The
/// environment is not, which is the same.
uint32_t parts_of(const SceneUpdate& update);

} // namespace pertev
