#pragma once

// Collects the images that a scene refers to, each once, and decodes all of them in parallel. A picture that is missing
// or broken is left out with a warning, and what used it falls back to its factor.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/messages.h"
#include "formats/files/file_access.h"
#include "image/color_primaries.h"
#include "image/image.h"
#include "scene/scene.h"

namespace pertev {

class TextureLoader {
public:
    /// `access` and `messages` outlive it.
    TextureLoader(const FileAccess& access, Messages& messages) : access_(access), messages_(&messages) {}
    /// From now on to others, which outlive it.
    void say_to(Messages& messages) { messages_ = &messages; }

    /// From now on `advice` says, after what is wrong with a picture that is not decoded, how it is converted; it is
    /// given the glTF extension that the kind of picture has.
    void advise_by(std::function<std::string(std::string_view extension)> advice) { advice_ = std::move(advice); }

    /// Image index of the file `reference`, as written at `from` (see FileAccess::resolve); the same file, however
    /// spelled, is one image. kNoImage after a warning where there is no such file. Throws Error(BadInput) when access
    /// is refused.
    int32_t add_file(const Place& from, const std::string& reference);

    /// Image index of an encoded image in memory, which stays alive until load_into returns. `name` is for messages.
    int32_t add_bytes(std::string name, std::span<const std::byte> bytes);

    /// Decodes what has been added so far, so that load_into finds it done. It may run beside other work that leaves
    /// the loader alone. Says nothing yet.
    void decode();

    /// Puts everything, decoded, into scene.images (empty before). Images that turn out broken are left out, each with
    /// a warning, and the references of scene.materials are renumbered: to kNoImage for a broken one. `scene_bytes`:
    /// size of the files that embedded images are part of. Throws Error(OverLimit) that names an image when all
    /// together would take more memory than their files justify; no more than that is taken before.
    void load_into(Scene& scene, uint64_t scene_bytes = 0);

private:
    uint64_t budget(uint64_t scene_bytes) const;
    void check_budget(uint64_t limit) const;

    struct Source {
        std::string name;
        std::filesystem::path path;       // or
        std::span<const std::byte> bytes; // embedded

        uint64_t texture_bytes = 0;                           // that the picture will take; 0: not known yet
        std::optional<std::variant<Rgba8Image, Image>> image; // once it is decoded
        std::optional<ColorMatrix> color_matrix;              // to Rec. 709, where its colours are others
        bool is_png = false;
        std::optional<Remark> fault; // why it never will be
        Messages said = {};
    };
    void decode_within(uint64_t limit);
    void read(Source& source, uint64_t limit, std::atomic<uint64_t>& all_bytes) const;

    const FileAccess& access_;
    Messages* messages_;
    std::function<std::string(std::string_view)> advice_;
    std::vector<Source> sources_;
    std::map<std::filesystem::path, int32_t> by_path_;
    std::size_t missing_ = 0; // only the first few are named
};

} // namespace pertev
