// The disk cache returns exactly the stored tree, or nothing. Every byte of the file is checked.

#include "accel/builders/bvh_cache.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <span>

#include "accel/bvh/check_bvh.h"
#include "base/read_file.h"
#include "tests/support/bvh_bytes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"

using namespace pertev;
using namespace pertev::test;
namespace fs = std::filesystem;

namespace {

void write_bytes(const fs::path& path, std::span<const std::byte> bytes) {
    fs::remove(path); // some file systems wait for the disk when a file is truncated
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

constexpr BvhBuilder kBinnedAlone[] = {BvhBuilder::Binned};

struct Stored {
    std::vector<BvhTriangle> triangles = triangles_of(make_torus(20, 10));
    fs::path folder = scratch_folder() / "made" / "by the store";
    Hash128 key = bvh_cache_key(triangles, {});
    fs::path file = folder / (key.hex() + ".bvh");
    BuiltTree tree = build_triangle_tree(triangles, {});

    Stored() {
        Messages messages;
        store_cached_bvh(key, folder, tree, triangles.size(), messages);
        REQUIRE(messages.all().empty());
    }
};

/// Recomputes the checksum in place, because it detects only accidents and a wrong file may have a correct one
/// (offset 32, 16 bytes, hashed as 0).
void seal(std::vector<std::byte>& bytes) {
    std::fill_n(bytes.begin() + 32, 16, std::byte{0});
    Hasher hasher;
    hasher.add(bytes);
    const Hash128 sum = hasher.result();
    std::memcpy(bytes.data() + 32, &sum, sizeof sum);
}

} // namespace

TEST_CASE("a cached tree equals the built one byte for byte") {
    const Stored stored;
    Messages messages;
    const auto loaded = load_cached_bvh(stored.key, stored.folder, stored.triangles, messages);
    REQUIRE(loaded);
    const Bvh built = build_bvh(stored.triangles);
    CHECK(same_bytes(loaded->nodes, built.nodes));
    CHECK(same_bytes(loaded->triangles, built.triangles));
    CHECK(loaded->root == built.root);
    CHECK(loaded->bounds == built.bounds);
    CHECK(loaded->depth == built.depth);
    CHECK(loaded->sah_cost == built.sah_cost);
    CHECK(messages.all().empty());
}

TEST_CASE("the cache's key changes with every vertex, id, order and setting") {
    std::vector<BvhTriangle> triangles = triangles_of(make_torus(8, 6));
    const Hash128 key = bvh_cache_key(triangles, {});
    CHECK(bvh_cache_key(triangles, {}) == key);
    for (const BvhBuildSettings& other :
         {BvhBuildSettings{.bins = 8}, BvhBuildSettings{.max_leaf = 2}, BvhBuildSettings{.max_depth = 40},
          BvhBuildSettings{.node_cost = 2}, BvhBuildSettings{.leaf_cost = 3}}) {
        CHECK_FALSE(bvh_cache_key(triangles, other) == key);
    }
    std::vector<BvhTriangle> changed = triangles;
    changed[5].c.z += 1e-3f;
    CHECK_FALSE(bvh_cache_key(changed, {}) == key);
    changed = triangles;
    changed[5].instance = 1;
    CHECK_FALSE(bvh_cache_key(changed, {}) == key);
    changed = triangles;
    std::swap(changed[5], changed[6]);
    CHECK_FALSE(bvh_cache_key(changed, {}) == key);
}

TEST_CASE("a flipped bit anywhere in a cached file is detected") {
    const Stored stored;
    const std::vector<std::byte> good = read_file(stored.file);
    for (std::size_t at = 0; at < good.size(); at += at < 128 ? 1 : 97) {
        CAPTURE(at);
        std::vector<std::byte> bad = good;
        bad[at] ^= std::byte{0x10};
        write_bytes(stored.file, bad);
        Messages messages;
        CHECK_FALSE(load_cached_bvh(stored.key, stored.folder, stored.triangles, messages));
        REQUIRE(messages.all().size() == 1);
        CHECK(messages.all()[0].is_warning);
        CHECK(messages.all()[0].text.find(stored.file.string()) == 0);
    }
}

TEST_CASE("a cached file of another length is detected") {
    const Stored stored;
    std::vector<std::byte> bytes = read_file(stored.file);
    const std::size_t size = bytes.size();
    for (const std::size_t length :
         {std::size_t{0}, std::size_t{1}, std::size_t{103}, std::size_t{104}, size / 2, size - 1, size + 1, 2 * size}) {
        CAPTURE(length);
        bytes.resize(length);
        write_bytes(stored.file, bytes);
        Messages messages;
        CHECK_FALSE(load_cached_bvh(stored.key, stored.folder, stored.triangles, messages));
        CHECK(messages.all().size() == 1);
    }
}

TEST_CASE("a corrupt cached file with a correct checksum never yields indices out of range") {
    const Stored stored;
    const std::vector<std::byte> good = read_file(stored.file);
    Random random(9);
    uint64_t refused = 0, taken = 0;
    for (uint32_t round = 0; round < 3000; ++round) {
        std::vector<std::byte> bad = good;
        for (uint32_t k = 0; k <= random.below(3); ++k) {
            const uint32_t words = static_cast<uint32_t>(bad.size() / 4);
            uint32_t at = random.below(round % 2 == 0 ? 26 : words); // half of the changes are in the header
            if (round % 8 == 1)
                at = 26 + 16 * random.below(static_cast<uint32_t>(stored.tree.nodes.size())) + 12 + k % 2;
            const uint32_t value = random.below(3) == 0 ? random.bits() : random.below(1u << random.below(32));
            std::memcpy(bad.data() + 4 * at, &value, 4);
        }
        seal(bad);
        write_bytes(stored.file, bad);
        Messages messages;
        const auto loaded = load_cached_bvh(stored.key, stored.folder, stored.triangles, messages);
        CHECK(loaded.has_value() == messages.all().empty());
        if (loaded) {
            const auto fault = find_broken_link(*loaded);
            CHECK_MESSAGE(!fault, fault.value_or(""));
        }
        (loaded ? taken : refused) += 1;
    }
    CHECK(refused > 1000); // most values are out of range
    CHECK(taken > 0);      // changed boxes cannot be detected
}

TEST_CASE("an invalid cached tree causes a warning, and the render continues") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(128, 80));
    REQUIRE(triangles.size() >= kMinCachedTriangles);
    const Bvh built = build_bvh(triangles);
    const fs::path folder = scratch_folder();
    const fs::path file = folder / (bvh_cache_key(triangles, {}).hex() + ".bvh");
    Messages messages;

    SUBCASE("a folder with the name of the cache's file is kept, and the tree is built") {
        fs::create_directories(file);
        CHECK(same_bytes(load_or_build_bvh(triangles, kBinnedAlone, {}, folder, messages).nodes, built.nodes));
        CHECK(messages.all().size() == 2); // the cache is neither read nor written
    }
    SUBCASE("a file with the name of the cache's folder is kept, and the tree is built") {
        write_bytes(folder / "taken", {});
        CHECK(
            same_bytes(load_or_build_bvh(triangles, kBinnedAlone, {}, folder / "taken", messages).nodes, built.nodes));
        CHECK(messages.all().size() >= 1);
    }
    SUBCASE("a damaged file is replaced by a good one") {
        write_bytes(file,
                    std::as_bytes(std::span("not a tree at all, but long enough to hold a header and then some of "
                                            "what could be nodes")));
        CHECK(same_bytes(load_or_build_bvh(triangles, kBinnedAlone, {}, folder, messages).nodes, built.nodes));
        CHECK(messages.all().size() == 1);
        CHECK(load_cached_bvh(bvh_cache_key(triangles, {}), folder, triangles, messages));
        CHECK(messages.all().size() == 1);
    }
    SUBCASE("without a folder nothing is cached") {
        CHECK(same_bytes(load_or_build_bvh(triangles, kBinnedAlone, {}, std::nullopt, messages).nodes, built.nodes));
        CHECK(messages.all().empty());
    }
}

TEST_CASE("a stored tree of any builder is read as it was built, including triangles that were split several times") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(128, 80));
    for (const BvhBuilder builder : {BvhBuilder::Binned, BvhBuilder::SpatialSplits, BvhBuilder::SpatialReinsertion}) {
        const fs::path folder = scratch_folder();
        const BvhBuilder builders[] = {builder};
        const Bvh built = build_bvh(builder, triangles);
        Messages messages;
        for (int run = 0; run < 2; ++run) { // built, then read
            const Bvh bvh = load_or_build_bvh(triangles, builders, {}, folder, messages);
            CHECK(same_bytes(bvh.nodes, built.nodes));
            CHECK(same_bytes(bvh.triangles, built.triangles));
            CHECK(bvh.sah_cost == built.sah_cost);
            CHECK(fs::exists(folder / (bvh_cache_key(triangles, {}, builder).hex() + ".bvh")));
        }
        CHECK(messages.all().empty());
    }
}

TEST_CASE("a better cached tree is used unless a structure is named") {
    const std::vector<BvhTriangle> triangles = triangles_of(make_torus(128, 80));
    const BvhBuilder best[] = {BvhBuilder::SpatialReinsertion};
    const BvhBuilder any[] = {BvhBuilder::Binned, BvhBuilder::Reinsertion, BvhBuilder::SpatialReinsertion};
    const Bvh binned = build_bvh(triangles), better = build_bvh(best[0], triangles);
    REQUIRE(!same_bytes(binned.nodes, better.nodes));
    const fs::path folder = scratch_folder();
    Messages messages;
    load_or_build_bvh(triangles, best, {}, folder, messages);
    CHECK(same_bytes(load_or_build_bvh(triangles, any, {}, folder, messages).nodes, better.nodes));
    CHECK(same_bytes(load_or_build_bvh(triangles, kBinnedAlone, {}, folder, messages).nodes, binned.nodes));
    BvhBuilder taken = BvhBuilder::Binned;
    CHECK(same_bytes(load_or_build_bvh(triangles, any, {}, folder, messages, &taken).nodes, better.nodes));
    CHECK(taken == best[0]); // although the other tree is in the cache, too
    CHECK(messages.all().empty());
}

TEST_CASE("the cache evicts the least recently used entries when it is full") {
    const fs::path folder = scratch_folder();
    Messages messages;
    std::vector<fs::path> files;
    for (int k = 0; k < 4; ++k) {
        const std::vector<BvhTriangle> triangles = triangles_of(make_torus(12 + k, 8));
        const Hash128 key = bvh_cache_key(triangles, {});
        files.push_back(folder / (key.hex() + ".bvh"));
        const BuiltTree tree = build_triangle_tree(triangles, {});
        store_cached_bvh(key, folder, tree, triangles.size(), messages,
                         k < 3 ? 1 << 30 : fs::file_size(files[0]) * 5 / 2);
        fs::last_write_time(files.back(), fs::file_time_type::clock::now() - std::chrono::hours(k == 1 ? 1 : 9 - k));
        if (k == 2) { // temporary files of processes that were killed an hour ago and just now
            for (const char* name : {".00.bvh.aB3dE6", ".00.bvh.xYz123"}) std::ofstream(folder / name) << "half a tree";
            fs::last_write_time(folder / ".00.bvh.aB3dE6", fs::file_time_type::clock::now() - std::chrono::hours(2));
        }
        if (k < 3) continue;
        CHECK_FALSE(fs::exists(folder / ".00.bvh.aB3dE6"));
        CHECK(fs::exists(folder / ".00.bvh.xYz123"));
        CHECK_FALSE(fs::exists(files[0])); // oldest
        CHECK(fs::exists(files[1]));       // used an hour ago
        CHECK_FALSE(fs::exists(files[2]));
        CHECK(fs::exists(files[3]));
    }
    CHECK(messages.all().empty());
}

TEST_CASE("the cache is in the user's folder of caches") {
    const auto set = [](const char* name, const char* value) {
        value != nullptr ? ::setenv(name, value, 1) : ::unsetenv(name);
    };
    const auto keep = [](const char* name) {
        const char* value = std::getenv(name);
        return value != nullptr ? std::optional<std::string>(value) : std::nullopt;
    };
    const auto old_cache = keep("XDG_CACHE_HOME"), old_home = keep("HOME");
    set("HOME", "/home/someone");
    set("XDG_CACHE_HOME", "/var/caches");
    CHECK(bvh_cache_folder() == fs::path("/var/caches/pertev"));
    set("XDG_CACHE_HOME", "relative");
    CHECK(bvh_cache_folder() == fs::path("/home/someone/.cache/pertev"));
    set("XDG_CACHE_HOME", nullptr);
    CHECK(bvh_cache_folder() == fs::path("/home/someone/.cache/pertev"));
    set("HOME", nullptr);
    CHECK_FALSE(bvh_cache_folder());
    set("XDG_CACHE_HOME", old_cache ? old_cache->c_str() : nullptr);
    set("HOME", old_home ? old_home->c_str() : nullptr);
}
