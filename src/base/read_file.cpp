#include "base/read_file.h"

#include <cerrno>
#include <span>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/huge_pages.h"

namespace pertev {

namespace {

Error failure(const std::filesystem::path& path, const std::string& why) {
    return Error(ErrorCode::BadInput, FileLocation{path.string()}, fmt::format("cannot read: {}", why));
}

} // namespace

InputFile open_file(const std::filesystem::path& path) {
    std::error_code ec;
    const auto status = std::filesystem::status(path, ec);
    if (!std::filesystem::exists(status)) throw failure(path, ec ? ec.message() : "no such file");
    if (!std::filesystem::is_regular_file(status)) throw failure(path, "it is not a regular file");
    InputFile file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) throw failure(path, std::generic_category().message(errno));
    return file;
}

std::vector<std::byte> read_file(const std::filesystem::path& path) {
    const InputFile file = open_file(path);
    std::error_code ec;
    const std::uintmax_t size = std::filesystem::file_size(path, ec);
    if (ec) throw failure(path, ec.message());
    auto bytes = array_on_huge_pages<std::byte>(size);
    if (std::fread(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) {
        throw failure(path, "the file ended early or the disk failed");
    }
    return bytes;
}

std::string hash_of_file(const std::filesystem::path& path) {
    if (std::error_code ec; !std::filesystem::is_regular_file(path, ec)) return "";
    const InputFile file = open_file(path);
    Hasher hasher;
    std::vector<std::byte> part(std::size_t(1) << 16); // a scene has many small files, and cleared memory is not free
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), file.get())) {
        hasher.add(std::span(part).first(count));
    }
    if (std::ferror(file.get()) != 0) throw failure(path, "the disk failed");
    return hasher.result().hex();
}

} // namespace pertev
