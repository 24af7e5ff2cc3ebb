#pragma once

// Collects the images to which a scene refers, each once, and decodes all of them in parallel. A picture that is
// missing or broken is left out with a warning, and its users fall back to their factors.

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

#include "base/sink.h"
#include "formats/files/file_access.h"
#include "image/color_primaries.h"
#include "image/image.h"
#include "image/image_header.h"
#include "scene/scene.h"

namespace pertev {

class TextureLoader {
public:
    /// `access` and `sink` must outlive this object.
    TextureLoader(const FileAccess& access, Sink& sink) : access_(access), sink_(&sink) {}
    /// Redirects messages to `sink`, which must outlive the loader.
    void report_to(Sink& sink) { sink_ = &sink; }

    /// Sets `advice`, which is appended to messages about pictures that are not decoded: how to convert them. It gets
    /// the glTF extension of the picture's format.
    void advise_by(std::function<std::string(std::string_view extension)> advice) { advice_ = std::move(advice); }

    /// Sets the most pixels of a picture's longer side; larger pictures are scaled down. 0: any.
    void shrink_to(uint32_t longest) { longest_ = longest; }

    /// Image index of the file `reference`, as written at `from` (see FileAccess::resolve); the same file, however
    /// spelled, is one image. kNoImage after a warning if there is no such file. Throws Error(BadInput) if access is
    /// refused.
    int32_t add_file(const FileLocation& from, const std::string& reference);

    /// Image index of an encoded image in memory, which must stay alive until load_into returns. `name` is for
    /// messages.
    int32_t add_bytes(std::string name, std::span<const std::byte> bytes);

    /// Decodes everything added so far, so that load_into need not. It may run concurrently with work that does not use
    /// the loader, and reports nothing yet.
    void decode();

    /// Moves all decoded images into scene.images (empty before); a PNG with 16 bits per channel that is used both as
    /// colours and as data becomes two. Broken images are left out, each with a warning, and the references of
    /// scene.materials are renumbered, to kNoImage for a broken one. `scene_bytes` is the size of the files that
    /// contain embedded images. Throws Error(OverLimit) that names an image if all together would take more memory than
    /// their files justify; no more than that is allocated before.
    void load_into(Scene& scene, uint64_t scene_bytes = 0);

private:
    uint64_t budget(uint64_t scene_bytes) const;
    void check_budget(uint64_t limit) const;

    struct Source {
        std::string name;
        std::filesystem::path path;       // empty: embedded
        std::span<const std::byte> bytes; // encoded image, if it is embedded

        uint64_t texture_bytes = 0;                           // bytes that the picture will take; 0: not known yet
        std::optional<std::variant<Rgba8Image, Image>> image; // after decoding
        std::optional<ColorMatrix> color_matrix;              // to Rec. 709, if its colours have other primaries
        bool is_png = false;
        bool is_encoded = false;     // used as sRGB-encoded colours alone; known once the scene's materials are
        std::optional<Remark> fault; // reason why it cannot be decoded
        Messages messages = {};
    };
    /// Returns whether the source is a decoded PNG with 16 bits per channel.
    static bool is_png16(const Source& source);
    void decode_within(uint64_t limit);
    void read(Source& source, uint64_t limit, std::atomic<uint64_t>& all_bytes) const;
    uint64_t texture_bytes(const ImageHeader& header) const;

    const FileAccess& access_;
    Sink* sink_;
    std::function<std::string(std::string_view)> advice_;
    std::vector<Source> sources_;
    std::map<std::filesystem::path, int32_t> by_path_;
    uint32_t longest_ = 0;
    std::size_t missing_ = 0; // number of missing images, of which the first few are named
};

} // namespace pertev
