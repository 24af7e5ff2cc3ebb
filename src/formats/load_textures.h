#pragma once

// Collects the images that a scene refers to, each once, and decodes all of them in parallel at the end. A picture that
// is missing or broken is a warning, and what used it falls back to its factor; a picture outside the folders that the
// scene may read is an error.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/file_access.h"
#include "scene/scene.h"

namespace pertev {

class TextureLoader {
public:
    TextureLoader(const FileAccess& access, Messages& messages) : access_(access), messages_(messages) {}

    /// Image index of the file `reference`, as written in `from` (see FileAccess::resolve); the same file, however
    /// spelled, is one image. kNoImage after a warning where there is no such file. Throws Error(BadInput) when access
    /// is refused.
    int32_t add_file(const std::filesystem::path& from, const std::string& reference);

    /// Image index of an encoded image in memory, which stays alive until load_into returns. `name` is for messages.
    int32_t add_bytes(std::string name, std::span<const std::byte> bytes);

    /// Decodes everything into scene.images (empty before). Images that turn out broken are left out, each with a
    /// warning, and the references of scene.materials are renumbered: to kNoImage for a broken one. `scene_bytes`: size
    /// of the files that embedded images are part of. Throws Error(OverLimit) that names an image when all together
    /// would take more memory than their files justify; no more than that is taken before.
    void load_into(Scene& scene, uint64_t scene_bytes = 0);

private:
    uint64_t budget(uint64_t scene_bytes) const;
    void check_budget(const std::vector<uint64_t>& bytes, uint64_t limit) const;

    struct Source {
        std::string name;
        std::filesystem::path path;       // or
        std::span<const std::byte> bytes; // embedded
    };

    const FileAccess& access_;
    Messages& messages_;
    std::vector<Source> sources_;
    std::map<std::filesystem::path, int32_t> by_path_;
    std::size_t missing_ = 0; // only the first few are named
};

} // namespace pertev
