#include "base/read_file.h"

#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

std::vector<std::byte> read_file(const std::filesystem::path& path) {
    const auto fail = [&](const std::string& why) -> Error {
        return Error(ErrorCode::BadInput, Place{path.string()}, fmt::format("cannot read: {}", why));
    };
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status)) throw fail(ec ? ec.message() : "no such file");
    if (!std::filesystem::is_regular_file(status)) throw fail("it is not a regular file");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) throw fail(std::generic_category().message(errno));
    std::vector<std::byte> bytes(std::filesystem::file_size(path, ec));
    if (ec) throw fail(ec.message());
    if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
        throw fail("the file ended early or the disk failed");
    }
    return bytes;
}

} // namespace pertev
