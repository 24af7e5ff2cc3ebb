#include "formats/gltf/choices.h"

#include <fmt/format.h>

#include "formats/files/file_choices.h"
#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

std::vector<std::string> names_of(const std::vector<JsonValue>& elements, Buffers& buffers, Messages& messages) {
    std::vector<std::string> names;
    for (const JsonValue& element : elements) {
        names.emplace_back();
        read_or_leave_out(fmt::format("the name of {}", element.pointer()), messages,
                          [&] { names.back() = element.string_or("name", ""); });
        buffers.charge(sizeof(Clip) + names.back().size(), element);
    }
    return names;
}

} // namespace

void choose(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene, Messages& messages) {
    std::vector<JsonValue> animations;
    read_or_leave_out("/animations", messages, [&] { animations = document.root().elements_of("animations"); });
    const std::vector<std::string> clips = names_of(animations, buffers, messages);
    const std::vector<bool> plays = choose_clips(document.file(), clips, options.animation);
    for (std::size_t i = 0; i < clips.size(); ++i) scene.clips.push_back({.name = clips[i], .plays = plays[i]});

    scene.file_scenes = names_of(document.table("scenes"), buffers, messages);
    if (!options.file_scene.empty()) {
        scene.file_scene = choose_file_scene(document.file(), scene.file_scenes, options.file_scene);
    } else if (const std::optional<JsonValue> chosen = document.root().find("scene");
               chosen && !scene.file_scenes.empty()) {
        read_or_leave_out(*chosen, messages, [&] { scene.file_scene = document.index_into("scenes", *chosen); });
    }
}

} // namespace pertev::gltf
