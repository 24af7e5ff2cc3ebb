#include "session/records/records_file.h"

#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/json_text.h"
#include "base/read_file.h"
#include "base/remove_leftovers.h"
#include "base/write_file_atomically.h"
#include "formats/json/json_file.h"

namespace pertev {
namespace {

constexpr std::string_view kMagic = "\x89PVR\r\n\x1a\n";
constexpr uint32_t kVersion = 1;
constexpr std::size_t kSizes = 2 * sizeof(uint32_t), kHash = 2 * sizeof(uint64_t); // version and size of the header

std::string json_of(const DecidingSettings& decides) {
    std::vector<std::string> settings;
    for (const auto& [name, value] : decides)
        settings.push_back(fmt::format("{}:{}", json_string(name), json_string(value)));
    return fmt::format("{{{}}}", fmt::join(settings, ","));
}

Hash128 hash_of(std::span<const std::byte> bytes) {
    Hasher hasher;
    hasher.add(bytes);
    return hasher.result();
}

template <class T>
T value_at(std::span<const std::byte> bytes, std::size_t at) {
    T value;
    std::memcpy(&value, &bytes[at], sizeof value);
    return value;
}

} // namespace

Error RecordsFile::damaged(const std::string& why) const {
    Remark remark(FileLocation{file_}, why + "; name another file, or delete it to compute it again");
    remark.setting = "records";
    return Error(ErrorCode::BadInput, std::move(remark));
}

std::optional<std::vector<std::byte>> RecordsFile::read() const {
    std::error_code fault;
    if (!std::filesystem::exists(file_, fault)) {
        remove_leftovers(file_);
        check_writable(file_);
        return std::nullopt;
    }
    const std::vector<std::byte> bytes = read_file(file_);
    const std::span<const std::byte> all(bytes);
    const std::size_t before = kMagic.size() + kSizes;
    if (all.size() < before + kHash || std::memcmp(all.data(), kMagic.data(), kMagic.size()) != 0)
        throw damaged("this is not a file of records");
    const auto version = value_at<uint32_t>(all, kMagic.size()),
               size = value_at<uint32_t>(all, before - sizeof(uint32_t));
    if (version != kVersion)
        throw damaged(
            fmt::format("the file has version {} of the format; this program reads version {}", version, kVersion));
    const auto hashed = all.first(all.size() - kHash);
    const Hash128 stored = {value_at<uint64_t>(all, hashed.size() + sizeof(uint64_t)),
                            value_at<uint64_t>(all, hashed.size())};
    if (size > hashed.size() - before || hash_of(hashed) != stored)
        throw damaged("the file is truncated or damaged: its checksum is wrong");
    const std::string text(reinterpret_cast<const char*>(hashed.data()) + before, size);
    const JsonFile json(file_, text);
    DecidingSettings there;
    for (const auto& [name, value] : json.root().members()) there.emplace_back(name, value.to_string());
    if (const auto different = first_difference(there, decides_)) {
        throw damaged("the records belong to another picture: " + text_of(*different));
    }
    const auto contents = hashed.subspan(before + size);
    return std::vector<std::byte>(contents.begin(), contents.end());
}

void RecordsFile::write(std::span<const std::byte> contents) const {
    std::vector<std::byte> bytes;
    const auto add = [&](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
    const std::string json = json_of(decides_);
    const uint32_t sizes[] = {kVersion, static_cast<uint32_t>(json.size())};
    bytes.reserve(kMagic.size() + kSizes + json.size() + contents.size() + kHash);
    add(std::as_bytes(std::span(kMagic)));
    add(std::as_bytes(std::span(sizes)));
    add(std::as_bytes(std::span(json)));
    add(contents);
    const Hash128 hash = hash_of(bytes);
    const uint64_t words[] = {hash.low, hash.high};
    add(std::as_bytes(std::span(words)));
    write_file_atomically(file_, bytes);
}

} // namespace pertev
