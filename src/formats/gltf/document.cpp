#include "formats/gltf/document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "base/message_text.h"
#include "formats/gltf/extensions.h"
#include "formats/gltf/leave_out.h"
#include "formats/json/find_json_fault.h"

namespace pertev::gltf {
namespace {

constexpr std::array<std::string_view, 12> kTables = {"accessors", "bufferViews", "buffers", "cameras",
                                                      "images",    "materials",   "meshes",  "nodes",
                                                      "samplers",  "scenes",      "skins",   "textures"};

constexpr uint32_t kGlbMagic = 0x46546c67;    // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;   // "JSON"
constexpr uint32_t kBinaryChunk = 0x004e4942; // "BIN\0"
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

uint32_t read_u32(std::span<const std::byte> bytes, std::size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

} // namespace

Document::Document(const std::filesystem::path& path, std::vector<std::byte> bytes, Messages& messages)
    : path_(path), file_(path.string()), bytes_(std::move(bytes)), json_chunk_(bytes_) {
    if (bytes_.empty()) {
        throw Error(ErrorCode::BadInput, Place{file_}, "the file is empty; expected a glTF 2.0 document");
    }
    if (bytes_.size() >= sizeof kGlbMagic && read_u32(bytes_, 0) == kGlbMagic) {
        split_glb(messages);
    } else if (lower_case_extension(path) == ".glb") {
        throw Error(ErrorCode::BadInput, Place{file_},
                    "byte 0: expected the letters glTF, with which a GLB file starts");
    }
    parse(json_chunk_);
    check_version(messages);
    for (const std::string_view name : kTables) read_table(name, root(), messages);
    std::optional<JsonValue> lights;
    read_or_leave_out("/extensions", messages, [&] { lights = root().extension("KHR_lights_punctual"); });
    if (lights) read_table("lights", *lights, messages);
    check_extensions(messages);
}

void Document::read_table(std::string_view name, const JsonValue& holder, Messages& messages) {
    std::vector<JsonValue>& table = tables_[std::string(name)];
    const std::optional<JsonValue> member = holder.find(name);
    if (member) read_or_leave_out(*member, messages, [&] { table = member->elements(); });
}

/// Where the container ends: the header's length, where the file has it.
std::size_t Document::glb_end(Messages& messages) const {
    const uint32_t length = read_u32(bytes_, 8);
    if (length >= kHeaderBytes && length <= bytes_.size()) return length;
    messages.warn({Place{file_}, fmt::format("byte 8: the header says {} bytes, but the file has {}; these are read",
                                             length, bytes_.size())});
    return bytes_.size();
}

void Document::split_glb(Messages& messages) {
    const auto fail = [&](std::size_t at, const std::string& what) {
        return Error(ErrorCode::BadInput, Place{file_}, fmt::format("byte {}: {}", at, what));
    };
    if (bytes_.size() < kHeaderBytes) throw fail(bytes_.size(), "the file ends within the GLB header of 12 bytes");
    const uint32_t version = read_u32(bytes_, 4);
    if (version != 2) throw fail(4, fmt::format("GLB container version {}; expected 2", version));
    const std::size_t end = glb_end(messages);
    const std::span<const std::byte> glb(bytes_);
    bool has_json = false;
    for (std::size_t at = kHeaderBytes; bytes_.size() - at >= kChunkHeaderBytes;) {
        const uint32_t size = read_u32(glb, at), type = read_u32(glb, at + 4);
        // What follows the end is none of it, but for the binary chunk where the header counts the JSON alone.
        if (at >= end && (type != kBinaryChunk || binary_chunk_)) break;
        const std::size_t begin = at + kChunkHeaderBytes, available = glb.size() - begin;
        if (!has_json && type != kJsonChunk) throw fail(at, "the first chunk of a GLB file must be JSON");
        if (size > available) {
            messages.leave_out(
                {Place{file_}, fmt::format("byte {}: the chunk says {} bytes, but {} are left; the file is cut off "
                                           "or damaged, and what is missing is left out",
                                           at, size, available)});
        }
        const std::span<const std::byte> chunk = glb.subspan(begin, std::min<std::size_t>(size, available));
        if (!has_json)
            json_chunk_ = chunk;
        else if (type == kBinaryChunk && !binary_chunk_)
            binary_chunk_ = chunk;
        has_json = true;
        at = begin + chunk.size();
    }
    if (!has_json) throw fail(kHeaderBytes, "there is no JSON chunk");
    // Spaces fill the chunk up; some exporters write zero bytes.
    while (!json_chunk_.empty() && json_chunk_.back() == std::byte{}) {
        json_chunk_ = json_chunk_.first(json_chunk_.size() - 1);
    }
}

void Document::parse(std::span<const std::byte> json) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    std::string_view text(reinterpret_cast<const char*>(json.data()), json.size());
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    // The parser reads past the end in whole vectors: it gets a copy with room for that.
    const simdjson::padded_string padded(text);
    simdjson::dom::element element;
    if (const simdjson::error_code failure = parser_.parse(padded).get(element)) {
        throw bad_json(text, failure);
    }
    root_.emplace(file_, "", element);
}

Error Document::bad_json(std::string_view text, simdjson::error_code failure) const {
    std::string what =
        fmt::format("not valid JSON: {}; expected a glTF 2.0 document", simdjson::error_message(failure));
    if (failure == simdjson::DEPTH_ERROR) {
        what = fmt::format("JSON nested more than {} levels deep; expected a glTF 2.0 document", parser_.max_depth());
    } else if (const std::optional<JsonFault> fault = find_json_fault(text)) {
        const auto start = static_cast<std::size_t>(text.data() - reinterpret_cast<const char*>(bytes_.data()));
        what = fmt::format("not valid JSON: {} (byte {} of the file): expected {}", line_and_column(text, fault->byte),
                           start + fault->byte, fault->expected);
    }
    return Error(ErrorCode::BadInput, Place{file_}, what);
}

void Document::check_version(Messages& messages) const {
    const auto parts = [&](const JsonValue& value) {
        const std::string_view text = value.to_string();
        std::array<unsigned, 2> numbers = {0, 0}; // major, minor
        const char *begin = text.data(), *end = begin + text.size();
        const auto major = std::from_chars(begin, end, numbers[0]);
        bool good = major.ec == std::errc() && major.ptr != end && *major.ptr == '.';
        if (good) {
            const auto minor = std::from_chars(major.ptr + 1, end, numbers[1]);
            good = minor.ec == std::errc() && minor.ptr == end;
        }
        if (!good) {
            messages.warn(
                {value.place(), fmt::format("\"{}\" is not a version; it is read as \"2.0\"", shortened(text))});
            numbers = {2, 0};
        }
        return numbers;
    };
    const std::optional<JsonValue> asset = root().find("asset");
    const std::optional<JsonValue> version = asset ? asset->find("version") : std::nullopt;
    if (!version) {
        messages.warn({root().place(), "\"asset\" with a \"version\" is missing; it is read as glTF 2.0"});
        return;
    }
    if (parts(*version)[0] != 2) {
        throw version->error(fmt::format("glTF {}; this reader knows 2.0", version->to_string()));
    }
    const std::optional<JsonValue> least = asset->find("minVersion");
    if (least && parts(*least) > std::array<unsigned, 2>{2, 0}) {
        messages.leave_out({least->place(), fmt::format("the file needs glTF {}; what 2.0 does not have is left out",
                                                        least->to_string())});
    }
}

void Document::check_extensions(Messages& messages) const {
    std::set<std::string, std::less<>> told;
    const auto check = [&](std::string_view list, const char* verb) {
        const std::optional<JsonValue> names = root().find(list);
        if (!names) return;
        std::vector<JsonValue> elements;
        read_or_leave_out(*names, messages, [&] { elements = names->elements(); });
        for (const JsonValue& name : elements) {
            read_or_leave_out(name, messages, [&] {
                const std::string_view extension = name.to_string();
                if (is_known_extension(extension) || !told.emplace(extension).second) return;
                messages.leave_out(
                    {name.place(), fmt::format("the file {} the extension {}, which is not supported: it is left out",
                                               verb, shortened(extension))});
            });
        }
    };
    check("extensionsRequired", "requires");
    check("extensionsUsed", "uses");
}

const std::vector<JsonValue>& Document::table(std::string_view name) const {
    static const std::vector<JsonValue> none;
    const auto found = tables_.find(name);
    return found == tables_.end() ? none : found->second;
}

uint32_t Document::index_into(std::string_view name, const JsonValue& reference) const {
    const uint64_t index = reference.to_unsigned(), size = table(name).size();
    if (index >= size || index > std::numeric_limits<uint32_t>::max()) {
        throw reference.error(
            fmt::format("{}; expected an index into \"{}\", which has {} elements", index, name, size));
    }
    return static_cast<uint32_t>(index);
}

} // namespace pertev::gltf
