#include "formats/gltf/choices.h"

#include "formats/file_choices.h"

namespace pertev::gltf {
namespace {

std::vector<std::string> names_of(const std::vector<JsonValue>& elements, Buffers& buffers) {
    std::vector<std::string> names;
    for (const JsonValue& element : elements) {
        names.push_back(element.string_or("name", ""));
        buffers.charge(sizeof(Clip) + names.back().size(), element);
    }
    return names;
}

} // namespace

void choose(const Document& document, Buffers& buffers, const ReadOptions& options, Scene& scene) {
    const std::vector<std::string> clips = names_of(document.root().elements_of("animations"), buffers);
    const std::vector<bool> plays = choose_clips(document.file(), clips, options.animation);
    for (std::size_t i = 0; i < clips.size(); ++i) scene.clips.push_back({.name = clips[i], .plays = plays[i]});

    scene.file_scenes = names_of(document.table("scenes"), buffers);
    if (!options.file_scene.empty()) {
        scene.file_scene = choose_file_scene(document.file(), scene.file_scenes, options.file_scene);
    } else if (const std::optional<JsonValue> chosen = document.root().find("scene");
               chosen && !scene.file_scenes.empty()) {
        scene.file_scene = document.index_into("scenes", *chosen);
    }
}

} // namespace pertev::gltf
