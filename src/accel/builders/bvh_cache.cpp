#include "accel/builders/bvh_cache.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <ranges>

#include <fmt/format.h>

#include "accel/bvh/check_bvh.h"
#include "base/error.h"
#include "base/write_file_atomically.h"

namespace pertev {
namespace {

namespace fs = std::filesystem;

constexpr char kMagic[8] = {'P', 'e', 'r', 't', 'e', 'v', 'B', '2'};
constexpr uint32_t kVersion = 3; // version of the file's layout and of the builders; raised when one of them changes
constexpr uint32_t kByteOrder = 0x01020304;
constexpr uint64_t kMaxCopies = 8;           // average number of copies of a split triangle
constexpr uint32_t kEndOfLeaf = 0x80000000u; // flag in the words of the order

struct Header {
    char magic[8];
    uint32_t byte_order, version;
    Hash128 key;
    Hash128 checksum; // over the header, with 0 in this field, and everything after it
    uint64_t node_count, triangle_count;
    Bounds3 bounds;
    uint32_t root;
    int32_t depth;
    float sah_cost;
    uint32_t order_count; // triangles in leaves; split triangles count more than once
};
static_assert(sizeof(Header) == 104, "no padding: its bytes are hashed");

Hash128 checksum_of(Header header, std::span<const BvhNode> nodes, std::span<const uint32_t> order) {
    header.checksum = {};
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(&header, 1)));
    hasher.add(std::as_bytes(nodes));
    hasher.add(std::as_bytes(order));
    return hasher.result();
}

fs::path file_of(const Hash128& key, const fs::path& folder) { return folder / (key.hex() + ".bvh"); }

Hash128 hash_of(const std::vector<BvhTriangle>& triangles) {
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(triangles)));
    return hasher.result();
}

Hash128 key_of(const Hash128& triangles, const BvhBuildSettings& settings, BvhBuilder builder) {
    Hasher hasher;
    hasher.add_value(kVersion);
    hasher.add_value(builder);
    hasher.add_value(settings.bins);
    hasher.add_value(settings.max_leaf);
    hasher.add_value(settings.max_depth);
    hasher.add_value(settings.node_cost);
    hasher.add_value(settings.leaf_cost);
    hasher.add_value(triangles);
    return hasher.result();
}

struct Unusable {
    std::string why;
};

template <class T>
void read_values(std::ifstream& file, std::span<T> values, Sink& sink) {
    constexpr std::size_t kAtOnce = 1 << 18;
    for (; !values.empty() && file; values = values.subspan(std::min(kAtOnce, values.size()))) {
        sink.check();
        const std::span<T> part = values.first(std::min(kAtOnce, values.size()));
        file.read(reinterpret_cast<char*>(part.data()), static_cast<std::streamsize>(part.size_bytes()));
    }
    if (!file) throw Unusable{"the file cannot be read to its end"};
}

/// Reads a tree and validates every number of the file before it is used.
BuiltTree read_tree(const fs::path& path, const Hash128& key, std::size_t triangle_count, Sink& sink) {
    const uint64_t size = fs::file_size(path);
    std::ifstream file(path, std::ios::binary);
    Header header;
    if (size < sizeof header) throw Unusable{"the file is truncated"};
    read_values(file, std::span(&header, 1), sink);
    if (std::memcmp(header.magic, kMagic, sizeof kMagic) != 0)
        throw Unusable{"the file is not a tree that Pertev wrote"};
    if (header.byte_order != kByteOrder || header.version != kVersion)
        throw Unusable{"another version of Pertev wrote the file"};
    if (!(header.key == key) || header.triangle_count != triangle_count)
        throw Unusable{"the file belongs to another mesh"};
    if (header.node_count >= kMaxBvhTriangles || header.order_count < header.triangle_count ||
        header.order_count > kMaxCopies * header.triangle_count ||
        size != sizeof header + header.node_count * sizeof(BvhNode) + header.order_count * sizeof(uint32_t)) {
        throw Unusable{"the file's size differs from the size that it states"};
    }
    BuiltTree tree;
    tree.nodes.resize(header.node_count);
    tree.order.resize(header.order_count);
    read_values(file, std::span(tree.nodes), sink);
    read_values(file, std::span(tree.order), sink);
    if (!(checksum_of(header, tree.nodes, tree.order) == header.checksum))
        throw Unusable{"the file's checksum is wrong"};

    tree.is_last.resize(tree.order.size());
    std::vector<bool> seen(triangle_count);
    std::size_t missing = triangle_count;
    for (std::size_t i = 0; i < tree.order.size(); ++i) {
        sink.check_at(i);
        tree.is_last[i] = (tree.order[i] & kEndOfLeaf) != 0;
        tree.order[i] &= ~kEndOfLeaf;
        if (tree.order[i] >= triangle_count) throw Unusable{"the file's order of triangles is invalid"};
        missing -= seen[tree.order[i]] ? 0 : 1;
        seen[tree.order[i]] = true;
    }
    if (missing > 0) throw Unusable{"the file's order of triangles is invalid"};
    tree.root = header.root;
    tree.bounds = header.bounds;
    tree.depth = header.depth;
    tree.sah_cost = header.sah_cost;
    return tree;
}

/// Returns whether the file is a leftover of write_file_atomically from a killed process: ".NAME.bvh.XXXXXX", old
/// enough that no process still writes it.
bool is_abandoned(const fs::directory_entry& entry) {
    std::error_code error;
    const bool is_temporary = entry.path().stem().extension() == ".bvh" && entry.path().filename().string()[0] == '.';
    const auto written = entry.last_write_time(error);
    return is_temporary && !error && written < fs::file_time_type::clock::now() - std::chrono::hours(1);
}

/// Removes the least recently used files and leftovers of killed processes. Another process may do so concurrently;
/// files that are already gone are ignored.
void remove_oldest(const fs::path& folder, uint64_t max_bytes) {
    struct Entry {
        fs::path path;
        fs::file_time_type used;
        uint64_t size;
    };
    std::vector<Entry> entries;
    uint64_t total = 0;
    std::error_code error;
    for (const fs::directory_entry& found : fs::directory_iterator(folder, error)) {
        if (is_abandoned(found)) fs::remove(found.path(), error);
        if (found.path().extension() != ".bvh" || !found.is_regular_file(error)) continue;
        const uint64_t size = found.file_size(error);
        if (error) continue;
        entries.push_back({found.path(), found.last_write_time(error), size});
        total += size;
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
    for (const Entry& entry : entries) {
        if (total <= max_bytes) break;
        fs::remove(entry.path, error);
        total -= entry.size;
    }
}

/// Builds a tree in the form of the files, which hold positions of triangles by leaf.
BuiltTree build_by_position(BvhBuilder builder, const std::vector<BvhTriangle>& triangles,
                            const BvhBuildSettings& settings) {
    if (builder == BvhBuilder::Binned) return build_triangle_tree(triangles, settings);
    std::vector<BvhTriangle> numbered; // each triangle carries its number, so that the tree's order can be read from it
    numbered.reserve(triangles.size());
    for (const BvhTriangle& triangle : triangles) {
        const auto number = static_cast<uint32_t>(numbered.size());
        settings.sink->check_at(number);
        numbered.emplace_back(triangle).primitive = number;
    }
    Bvh bvh = build_bvh(builder, numbered, settings);
    BuiltTree tree = {.nodes = std::move(bvh.nodes),
                      .order = std::vector<uint32_t>(bvh.triangles.size()),
                      .is_last = std::vector<bool>(bvh.triangles.size()),
                      .root = bvh.root,
                      .bounds = bvh.bounds,
                      .depth = bvh.depth,
                      .sah_cost = bvh.sah_cost};
    for (std::size_t i = 0; i < bvh.triangles.size(); ++i) {
        settings.sink->check_at(i);
        tree.order[i] = bvh.triangles[i].primitive;
        tree.is_last[i] = (bvh.triangles[i].flags & kLastInLeaf) != 0;
    }
    return tree;
}

} // namespace

std::optional<fs::path> bvh_cache_folder() {
    const auto absolute = [](const char* name) -> std::optional<fs::path> {
        const char* value = std::getenv(name);
        if (value == nullptr || !fs::path(value).is_absolute()) return std::nullopt;
        return fs::path(value);
    };
    if (const auto cache = absolute("XDG_CACHE_HOME")) return *cache / "pertev";
    if (const auto home = absolute("HOME")) return *home / ".cache" / "pertev";
    return std::nullopt;
}

Hash128 bvh_cache_key(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings, BvhBuilder builder) {
    return key_of(hash_of(triangles), settings, builder);
}

std::optional<Bvh> load_cached_bvh(const Hash128& key, const fs::path& folder,
                                   const std::vector<BvhTriangle>& triangles, Sink& sink) {
    const fs::path path = file_of(key, folder);
    try {
        if (!fs::exists(path)) return std::nullopt;
        if (!fs::is_regular_file(path)) throw Unusable{"the file is not a regular file"};
        Bvh bvh = make_bvh(read_tree(path, key, triangles.size(), sink), triangles, sink);
        if (const auto fault = find_broken_link(bvh, sink)) throw Unusable{*fault};
        std::error_code ignored; // a read-only cache can still be read
        fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);
        return bvh;
    } catch (const Unusable& unusable) {
        sink.warn({FileLocation{path.string()},
                   fmt::format("the cached structure is ignored and rebuilt: {}", unusable.why)});
    } catch (const fs::filesystem_error& error) {
        sink.warn({FileLocation{path.string()},
                   fmt::format("the cached structure is ignored and rebuilt: {}", error.code().message())});
    }
    return std::nullopt;
}

void store_cached_bvh(const Hash128& key, const fs::path& folder, const BuiltTree& tree, std::size_t triangle_count,
                      Sink& sink, uint64_t max_bytes) {
    std::vector<uint32_t> order(tree.order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        sink.check_at(i);
        order[i] = tree.order[i] | (tree.is_last[i] ? kEndOfLeaf : 0u);
    }
    Header header = {.magic = {},
                     .byte_order = kByteOrder,
                     .version = kVersion,
                     .key = key,
                     .checksum = {},
                     .node_count = tree.nodes.size(),
                     .triangle_count = triangle_count,
                     .bounds = tree.bounds,
                     .root = tree.root,
                     .depth = tree.depth,
                     .sah_cost = tree.sah_cost,
                     .order_count = static_cast<uint32_t>(order.size())};
    std::memcpy(header.magic, kMagic, sizeof kMagic);
    header.checksum = checksum_of(header, tree.nodes, order);

    std::vector<std::byte> bytes;
    bytes.reserve(sizeof header + tree.nodes.size() * sizeof(BvhNode) + order.size() * sizeof(uint32_t));
    for (const std::span<const std::byte> part :
         {std::as_bytes(std::span(&header, 1)), std::as_bytes(std::span(tree.nodes)),
          std::as_bytes(std::span(order))}) {
        bytes.insert(bytes.end(), part.begin(), part.end());
    }
    try {
        fs::create_directories(folder);
        write_file_atomically(file_of(key, folder), bytes, sink);
        remove_oldest(folder, max_bytes);
    } catch (const fs::filesystem_error& error) {
        sink.warn({FileLocation{folder.string()},
                   fmt::format("the structure cache cannot be written: {}", error.code().message())});
    } catch (const Error& error) {
        if (error.code() == ErrorCode::Interrupted) throw;
        sink.warn(
            {FileLocation{folder.string()}, fmt::format("the structure cache cannot be written: {}", error.what())});
    }
}

Bvh load_or_build_bvh(const std::vector<BvhTriangle>& triangles, std::span<const BvhBuilder> builders,
                      BvhBuildSettings settings, const std::optional<fs::path>& folder, Sink& sink, BvhBuilder* taken) {
    settings.sink = &sink;
    const BvhBuilder builder = builders.front();
    if (taken != nullptr) *taken = builder;
    if (!folder || triangles.size() < kMinCachedTriangles) return build_bvh(builder, triangles, settings);
    const Hash128 hash = hash_of(triangles);
    for (const BvhBuilder stored : std::views::reverse(builders)) {
        const Hash128 key = key_of(hash, settings, stored);
        std::optional<Bvh> bvh = load_cached_bvh(key, *folder, triangles, sink);
        if (!bvh) continue;
        if (taken != nullptr) *taken = stored;
        return std::move(*bvh);
    }
    BuiltTree tree = build_by_position(builder, triangles, settings);
    store_cached_bvh(key_of(hash, settings, builder), *folder, tree, triangles.size(), sink);
    return make_bvh(std::move(tree), triangles, sink);
}

} // namespace pertev
