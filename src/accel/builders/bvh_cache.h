#pragma once

// Trees kept on disk between runs, one file each, named for the hash of the triangles, the builder and its settings. A
// file holds nodes and the order of the triangles; the triangles themselves are the caller's, so no file can bring in
// ids or vertices that the scene does not have. A file that is damaged, cut short or of another version is ignored with
// a warning; a folder that cannot be written costs a warning, never the render.

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "base/hash.h"
#include "base/messages.h"

namespace pertev {

/// $XDG_CACHE_HOME/pertev, or $HOME/.cache/pertev; nothing where neither names an absolute folder.
std::optional<std::filesystem::path> bvh_cache_folder();

/// Changes with every triangle, their order, each setting, the builder, and the format of files.
Hash128 bvh_cache_key(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                      BvhBuilder builder = BvhBuilder::Binned);

/// The tree stored under `key` for these triangles; nothing where there is none or it cannot be used. What it returns
/// passes find_broken_link, whatever the file held.
std::optional<Bvh> load_cached_bvh(const Hash128& key, const std::filesystem::path& folder,
                                   const std::vector<BvhTriangle>& triangles, Messages& messages);

/// Stores a tree of `triangle_count` triangles, each of which it holds at least once; makes the folder. Afterwards the
/// files used longest ago are removed until the folder's trees take no more than `max_bytes`.
void store_cached_bvh(const Hash128& key, const std::filesystem::path& folder, const BuiltTree& tree,
                      std::size_t triangle_count, Messages& messages, uint64_t max_bytes = uint64_t(8) << 30);

/// From the cache, or built by builders.front() and stored. The trees of the others will do as well, and the last that
/// the cache holds is taken: they are better, and would only take longer to build. Without a folder, and for fewer than
/// kMinCachedTriangles, which build faster than a file is read, built. `taken`
/// is set to whose tree it is.
inline constexpr std::size_t kMinCachedTriangles = 1 << 14;
Bvh load_or_build_bvh(const std::vector<BvhTriangle>& triangles, std::span<const BvhBuilder> builders,
                      const BvhBuildSettings& settings, const std::optional<std::filesystem::path>& folder,
                      Messages& messages, BvhBuilder* taken = nullptr);

} // namespace pertev
