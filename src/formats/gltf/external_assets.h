#pragma once

// External assets: other glTF files, in files of their own or inside this one, that nodes show as if they were their
// children. Their own references are relative to them and confined like all others (formats/files/file_access.h).
//
// Source: glTF 2.1, draft of August 2026: `files`, `externalAssets`, and `externalAsset` of nodes. Its `aliases` are
// left out with a message.

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "formats/files/read_options.h"
#include "formats/gltf/buffers.h"
#include "formats/gltf/node_graph.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// The files and memory that a file and all that it shows have taken so far.
struct AssetBudget {
    uint32_t reads = 0; // files shown by others
    uint64_t file_bytes = 0, scene_bytes = 0;
};

/// The place of a file among those that show it.
struct AssetPlace {
    std::filesystem::path file;          // canonical; empty if it is inside another file
    AssetBudget& budget;                 // one for all files
    const AssetPlace* outer = nullptr;   // place of the file that shows it
    std::optional<NodeTransform> base{}; // transform of the node that shows it
};

/// Reads a document and what it shows, in the coordinates of the outermost file. The scene of an inner one has a
/// further node, which holds the others, has no parent, and has the transform of the node that shows it. Throws as
/// read_gltf.
Scene read_asset(const std::filesystem::path& path, std::vector<std::byte> bytes, const FileAccess& access,
                 const ReadOptions& options, const AssetPlace& place, Sink& sink);

class ExternalAssets {
public:
    /// Reads the assets that visible nodes of the scene show; an asset that cannot be read, or that shows itself, is
    /// left out.
    ExternalAssets(const Document& document, Buffers& buffers, const FileAccess& access, const NodeGraph& nodes,
                   const ReadOptions& options, const AssetPlace& place, Sink& sink);

    /// Adds what was read to the scene, which is complete otherwise. Copies of one asset share its materials and
    /// textures, and its meshes unless a skin or morph targets deform them.
    void append_to(Scene& scene);

private:
    struct Part {
        Scene scene;
        uint32_t node, file; // the node that shows it, and its index in `files`
    };
    void read(const JsonValue& node, uint32_t index);
    Scene make_part(uint32_t number, const NodeTransform& base);
    Scene read_file_of(const JsonValue& file, const NodeTransform& base);
    void charge(const Scene& part, uint64_t before, const JsonValue& file);

    const Document& document_;
    Buffers& buffers_;
    const FileAccess& access_;
    const NodeGraph& nodes_;
    const ReadOptions& options_;
    const AssetPlace& place_;
    Sink& sink_;
    std::vector<Part> parts_;
    std::set<uint32_t> met_, failed_; // indices of files that nodes show, and of those that cannot be read
};

} // namespace pertev::gltf
