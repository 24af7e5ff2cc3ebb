#include "radiosity/solved_scene.h"

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

SolvedScene::SolvedScene(const PreparedScene& prepared) : queue_(Queue::make_cpu()) {
    if (!prepared.poses.empty()) {
        throw Error(ErrorCode::BadInput, "scene", "",
                    fmt::format("skins or morph targets move vertices of {} of this scene's meshes, but "
                                "patches cannot move; `integrator=path` supports such scenes",
                                prepared.poses.size()));
    }
    scene_.emplace(queue_, prepared);
    if (scene_->view().first_triangle == nullptr || scene_->view().triangle_count >= 1u << 30) {
        throw Error(ErrorCode::OverLimit, "scene", "",
                    fmt::format("{} triangles in all its instances; radiosity takes at most {}",
                                scene_->view().triangle_count, (1u << 30) - 1));
    }
    tracer_.emplace(queue_, *prepared.structures, default_tracers(false));
    tracer_->set_surfaces(scene_->view());
}

} // namespace pertev
