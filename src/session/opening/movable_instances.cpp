#include "session/opening/movable_instances.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "scene/names.h"

namespace pertev {

std::vector<bool> movable_instances(std::span<const std::string> names, const Scene& scene) {
    if (names.empty()) return {};
    std::vector<Names> known;
    for (const Instance& instance : scene.instances) known.push_back(names_of(scene, instance));
    std::vector<bool> movable(known.size());
    for (const std::string& name : names) {
        bool is_there = false;
        for (std::size_t i = 0; i < known.size(); ++i) {
            if (!has_name(known[i], name)) continue;
            movable[i] = is_there = true;
        }
        if (!is_there) {
            throw Error(ErrorCode::BadInput, "movable", name,
                        fmt::format("no instance has this name; {}", some_names(known)));
        }
    }
    return movable;
}

} // namespace pertev
