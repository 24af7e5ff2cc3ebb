#include <doctest/doctest.h>

#include <sys/stat.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "tests/support/options.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

std::string read_text(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void replace_text(const fs::path& path, const std::string& text) {
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

} // namespace

TEST_CASE("writing replaces the whole file and leaves nothing else behind") {
    const fs::path folder = test::scratch_folder();
    replace_text(folder / "a", "old, and longer");
    replace_text(folder / "a", "new");
    CHECK(read_text(folder / "a") == "new");
    CHECK(files_in(folder) == 1);
}

TEST_CASE("a file that does not fit on the disk is refused before anything is written") {
    const fs::path folder = test::scratch_folder();
    replace_text(folder / "a", "old");
    const std::byte first = {};
    const std::span<const std::byte> too_much(&first, std::size_t(1) << 60);
    try {
        write_file_atomically(folder / "a", too_much);
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ErrorCode::FileWrite);
        CHECK(error.reason().find(std::generic_category().message(ENOSPC)) != std::string::npos);
    }
    CHECK(read_text(folder / "a") == "old");
    CHECK(files_in(folder) == 1);
}

TEST_CASE("writing follows a symbolic link") {
    const fs::path folder = test::scratch_folder();
    replace_text(folder / "target", "old");
    fs::create_symlink("target", folder / "link");
    replace_text(folder / "link", "new");
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(read_text(folder / "target") == "new");
}

TEST_CASE("writing to a missing folder, a folder, a FIFO or a full disk is a FileWrite error that names the path") {
    const fs::path folder = test::scratch_folder();
    fs::create_directory(folder / "d");
    REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
    for (const fs::path& path : {folder / "missing" / "a", folder / "d", folder / "fifo", fs::path("/dev/full")}) {
        CAPTURE(path.string());
        try {
            replace_text(path, "x");
            FAIL("no error");
        } catch (const Error& error) {
            CHECK(error.code() == ErrorCode::FileWrite);
            CHECK(std::string(error.what()).find(path.string()) != std::string::npos);
        }
        CHECK_THROWS_AS(check_writable(path), Error);
    }
    CHECK(files_in(folder) == 2);
}

TEST_CASE("a new generation keeps the previous one, and an error keeps both") {
    const fs::path folder = test::scratch_folder(), file = folder / "a", before = folder / "a.previous";
    const auto write = [&](const std::string& text) { write_generation(file, before, std::as_bytes(std::span(text))); };
    write("1");
    CHECK(files_in(folder) == 1);
    write("2");
    write("3");
    CHECK(read_text(file) == "3");
    CHECK(read_text(before) == "2");
    const std::byte first = {};
    CHECK_THROWS_AS(write_generation(file, before, {&first, std::size_t(1) << 60}), Error);
    CHECK(read_text(file) == "3");
    CHECK(read_text(before) == "2");
    CHECK(files_in(folder) == 2);
}
