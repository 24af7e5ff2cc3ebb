#pragma once

// A disk cache of trees, one file each, named by the hash of the triangles, the builder and its settings. A file
// holds nodes and the order of triangles. The triangles themselves come from the caller, so no file can introduce ids
// or vertices that the scene does not have. A file that is damaged, truncated or of another version is ignored with a
// warning. A folder that cannot be written gives a warning and never fails the render.

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "base/hash.h"
#include "base/sink.h"

namespace pertev {

/// Returns $XDG_CACHE_HOME/pertev or $HOME/.cache/pertev; nothing if neither is an absolute path.
std::optional<std::filesystem::path> bvh_cache_folder();

/// Cache key of a tree. It changes with every triangle, their order, each setting, the builder and the file format.
Hash128 bvh_cache_key(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                      BvhBuilder builder = BvhBuilder::Binned);

/// Loads the tree stored under `key` for these triangles. Returns nothing if there is none or it is unusable. The
/// result passes find_broken_link, whatever the file contained.
std::optional<Bvh> load_cached_bvh(const Hash128& key, const std::filesystem::path& folder,
                                   const std::vector<BvhTriangle>& triangles, Sink& sink);

/// Stores a tree of `triangle_count` triangles, each of which it holds at least once, and creates the folder. Then
/// the least recently used files are removed until the folder's trees take at most `max_bytes`.
void store_cached_bvh(const Hash128& key, const std::filesystem::path& folder, const BuiltTree& tree,
                      std::size_t triangle_count, Sink& sink, uint64_t max_bytes = uint64_t(8) << 30);

/// Loads a tree from the cache, or builds it with builders.front() and stores it. A cached tree of the other builders
/// is equally valid, and the last that exists is preferred, because those are better but take longer to build.
/// The tree is always built if there is no folder or there are fewer than kMinCachedTriangles, which build faster than
/// a file is read. `taken` is set to the builder of the returned tree.
inline constexpr std::size_t kMinCachedTriangles = 1 << 14;
Bvh load_or_build_bvh(const std::vector<BvhTriangle>& triangles, std::span<const BvhBuilder> builders,
                      BvhBuildSettings settings, const std::optional<std::filesystem::path>& folder, Sink& sink,
                      BvhBuilder* taken = nullptr);

} // namespace pertev
