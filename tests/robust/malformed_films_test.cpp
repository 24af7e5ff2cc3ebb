// Film files with changed bytes, truncated, or with a malicious header.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <string_view>

#include "session/film_file/merge_films.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

constexpr std::size_t kBeforeHeader = 16, kHashBytes = 16;

std::string film_bytes(const fs::path& path) {
    const std::vector<std::byte> bytes = read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string checksum_of(const std::string& bytes) {
    Hasher hasher;
    hasher.add(std::as_bytes(std::span(bytes)));
    const Hash128 hash = hasher.result();
    std::string text(kHashBytes, '\0');
    std::memcpy(text.data(), &hash.low, 8);
    std::memcpy(text.data() + 8, &hash.high, 8);
    return text;
}

/// Returns the checksum of all checksums. Each of them follows a size and that many bytes.
std::string checksum_of_checksums(const std::string& film) {
    std::string all;
    for (std::size_t at = kBeforeHeader - sizeof(uint32_t); at < film.size();) {
        uint32_t size = 0;
        std::memcpy(&size, film.data() + at, sizeof size);
        at += sizeof size + size;
        all += film.substr(at, kHashBytes);
        at += kHashBytes;
    }
    return checksum_of(all);
}

/// A film of 5x3 pixels with different ids and sums.
std::string small_film(const fs::path& path) {
    Queue queue = Queue::make_cpu();
    FilmHeader header;
    header.settings = {{"seed", "1"}};
    header.width = 5, header.height = 3, header.aovs = kAovIds | kAovDepth;
    header.parts = {{0, 3, {0, 2}}}, header.spp = 2;
    header.facts.settings = {{"pertev.seed", 1}};
    const Film film = header.make_film(queue);
    test::Random random(1);
    for (const auto& target : film.targets()) {
        std::vector<std::byte> bytes(target->byte_count());
        for (std::byte& b : bytes) b = std::byte(random.below(4));
        target->set_bytes(bytes);
    }
    write_film_files(std::vector<std::string>{path}, header, film);
    return film_bytes(path);
}

/// Reads a whole file. The memory of its film is small unless the reader allocates more than the file justifies.
std::optional<Error> error_of(const fs::path& path, const std::string& bytes) {
    test::write_text(path, bytes);
    return test::thrown_error([&] {
        Queue queue = Queue::make_cpu();
        const FilmMerge merge(std::vector<std::string>{path}, true);
        static_cast<void>(merge.film(queue, nobody()));
    });
}

/// Returns the file with another header and valid checksums.
std::string with_header(const std::string& film, const std::string& header) {
    uint32_t size = 0;
    std::memcpy(&size, film.data() + kBeforeHeader - sizeof size, sizeof size);
    const std::string blocks =
        film.substr(kBeforeHeader + size + kHashBytes, film.size() - kBeforeHeader - size - 2 * kHashBytes);
    size = static_cast<uint32_t>(header.size());
    std::string changed = film.substr(0, kBeforeHeader - sizeof size);
    changed.append(reinterpret_cast<const char*>(&size), sizeof size);
    changed += header;
    changed += checksum_of(changed);
    changed += blocks;
    return changed + checksum_of_checksums(changed);
}

std::string header_of(const std::string& film) {
    uint32_t size = 0;
    std::memcpy(&size, film.data() + kBeforeHeader - sizeof size, sizeof size);
    return film.substr(kBeforeHeader, size);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

} // namespace

TEST_CASE("every changed byte of a film file is detected") {
    const fs::path path = test::scratch_folder() / "film.pvf";
    const std::string film = small_film(path);
    CHECK(!error_of(path, film));
    test::Random random(2);
    for (std::size_t i = 0; i < film.size(); ++i) {
        CAPTURE(i);
        std::string damaged = film;
        damaged[i] = static_cast<char>(damaged[i] ^ (1 << random.below(8)));
        CHECK(test::is_at(error_of(path, damaged), ErrorCode::BadInput, FileLocation{path.string()}));
    }
}

TEST_CASE("a film file that is truncated or too long is detected") {
    const fs::path path = test::scratch_folder() / "film.pvf";
    const std::string film = small_film(path);
    for (std::size_t size = 0; size < film.size(); ++size) {
        CAPTURE(size);
        CHECK(test::is_at(error_of(path, film.substr(0, size)), ErrorCode::BadInput, FileLocation{path.string()}));
    }
    CHECK(test::says(error_of(path, film + '\0'), "1 bytes follow"));
}

TEST_CASE("a header that a reader would refuse is not written") {
    const std::size_t size = std::size_t(kMaxFilmHeaderBytes) + 1;
    const std::unique_ptr<void, decltype(&std::free)> zeros(std::calloc(size, 1), &std::free); // takes no memory unread
    REQUIRE(zeros);
    const std::string_view header(static_cast<const char*>(zeros.get()), size);
    const auto error = test::thrown_error([&] { const BlockFileBytes bytes(kFilmFile, header); });
    REQUIRE(error);
    CHECK(error->code() == ErrorCode::OverLimit);
}

TEST_CASE("a header with valid checksums is read strictly") {
    const fs::path path = test::scratch_folder() / "film.pvf";
    const std::string film = small_film(path), header = header_of(film);
    CHECK(!error_of(path, with_header(film, header)));
    const auto code_of = [&](const std::string& from, const std::string& to) {
        CAPTURE(to);
        const auto error = error_of(path, with_header(film, replaced(header, from, to)));
        REQUIRE(error);
        CHECK(error->location().value().file == path.string());
        return error->code();
    };
    for (const auto& [from, to] :
         std::vector<std::pair<std::string, std::string>>{{R"("size":[5,3])", R"("size":[5])"},
                                                          {R"("size":[5,3])", R"("size":[0,3])"},
                                                          {R"("size":[5,3])", R"("size":[6,3])"},
                                                          {R"("rows":[0,3])", R"("rows":[0,"3"])"},
                                                          {R"("samples":[0,2])", R"("samples":[2,1])"},
                                                          {R"("spp":2)", R"("spp":1)"},
                                                          {R"("layers":["depth",)", R"("layers":["motion",)"},
                                                          {R"("layers":["depth",)", R"("layers":[)"},
                                                          {R"("light_layers":[])", R"("light_layers":["more"])"},
                                                          {R"("layers_at":"samples")", R"("layers_at":"corners")"},
                                                          {R"("whole":1)", R"("whole":1.5)"},
                                                          {R"("stride":8)", R"("stride":4)"},
                                                          {R"("transparent":false,)", ""},
                                                          {R"("seconds")", R"("second")"},
                                                          {R"({"settings")", R"("settings")"}}) {
        CHECK(code_of(from, to) == ErrorCode::BadInput);
    }
    for (const auto& [from, to] :
         std::vector<std::pair<std::string, std::string>>{{R"("size":[5,3])", R"("size":[70000,3])"},
                                                          {R"("size":[5,3])", R"("size":[65536,65536])"},
                                                          {R"("rows":[0,3])", R"("rows":[0,4])"},
                                                          {R"("samples":[0,2])", R"("samples":[0,9000000])"}}) {
        CHECK(code_of(from, to) == ErrorCode::OverLimit);
    }
    const std::string part = R"("rows":[0,3],"samples":[0,2])";
    CHECK(!error_of(path, with_header(film, replaced(header, part, R"("parts":[[0,2,0,1],[2,3,0,2]])"))));
    for (const char* parts :
         {"", "[0,3,0]", "[0,3,0,0]", "[3,3,0,2]", "[0,2,0,1],[1,3,0,1]", "[0,3,0,1],[0,3,1,2]", "[2,3,0,1],[0,2,0,1]"})
        CHECK(code_of(part, fmt::format(R"("parts":[{}])", parts)) == ErrorCode::BadInput);
    for (const char* parts : {"[0,4,0,2]", "[0,3,0,9000000]"})
        CHECK(code_of(part, fmt::format(R"("parts":[{}])", parts)) == ErrorCode::OverLimit);
    // The targets fit, but no file of this length has so many blocks.
    std::string large = replaced(header, R"("size":[5,3])", R"("size":[65536,16384])");
    for (const uint64_t stride : {80, 12}) {
        large = replaced(large, fmt::format(R"("bytes":{},"stride":{})", 15 * stride, stride),
                         fmt::format(R"("bytes":{},"stride":{})", (uint64_t(1) << 30) * stride, stride));
    }
    CHECK(test::says(error_of(path, with_header(film, large)), "truncated"));
    CHECK(test::says(error_of(path, replaced(film, "\x1a\n\x02", "\x1a\n\x04")), "version 4"));
}

TEST_CASE("a reader survives fuzzed headers and blocks with valid checksums") {
    const fs::path path = test::scratch_folder() / "film.pvf";
    const std::string film = small_film(path), header = header_of(film);
    test::Random random(3);
    const uint64_t effort = test::effort(1000, 100'000);
    const auto below = [&](std::size_t n) { return random.below(static_cast<uint32_t>(n)); };
    for (uint64_t i = 0; i < effort; ++i) {
        std::string changed = header;
        for (uint32_t edits = 1 + below(3); edits > 0; --edits) {
            const std::size_t at = below(changed.size());
            if (below(2) == 0)
                changed[at] = static_cast<char>(below(256));
            else
                changed.erase(at, 1 + below(8));
        }
        const auto error = error_of(path, with_header(film, changed));
        if (error) CHECK(error->code() != ErrorCode::FileWrite);
    }
    // The first block gets a valid size and checksum.
    const std::size_t begin = kBeforeHeader + header.size() + kHashBytes;
    uint32_t size = 0;
    std::memcpy(&size, film.data() + begin, sizeof size);
    for (uint64_t i = 0; i < effort; ++i) {
        std::string block = film.substr(begin, sizeof size + size);
        const std::size_t at = sizeof size + below(size);
        if (below(4) == 0)
            block.resize(at);
        else
            block[at] = static_cast<char>(below(256));
        const auto left = static_cast<uint32_t>(block.size() - sizeof size);
        std::memcpy(block.data(), &left, sizeof left);
        std::string changed = film.substr(0, begin) + block + checksum_of(block);
        const std::size_t rest = begin + sizeof size + size + kHashBytes;
        changed += film.substr(rest, film.size() - rest - kHashBytes);
        const auto error = error_of(path, changed + checksum_of_checksums(changed));
        if (error) CHECK(error->code() == ErrorCode::BadInput);
    }
}
