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

constexpr std::array<std::string_view, 14> kTables = {
    "accessors", "bufferViews", "buffers", "cameras",  "externalAssets", "files", "images",
    "materials", "meshes",      "nodes",   "samplers", "scenes",         "skins", "textures"};

constexpr uint32_t kGlbMagic = 0x46546c67;    // "glTF"
constexpr uint32_t kJsonChunk = 0x4e4f534a;   // "JSON"
constexpr uint32_t kBinaryChunk = 0x004e4942; // "BIN\0"
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

uint32_t read_u32(std::span<const std::byte> bytes, std::size_t at) {
    uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

/// Returns the number of bytes of the object that `text` begins with; all bytes if the object does not end.
std::size_t json_size(std::string_view text) {
    std::size_t depth = 0;
    bool is_in_string = false;
    for (std::size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (is_in_string) {
            if (c == '\\') ++at;
            is_in_string = c != '"';
        } else if (c == '"') {
            is_in_string = true;
        } else if (c == '{' || c == '[') {
            ++depth;
        } else if ((c == '}' || c == ']') && (depth == 0 || --depth == 0)) {
            return at + 1;
        }
    }
    return text.size();
}

bool is_padding(char c) { return c == '\0' || c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the version as text, such as "2.0", even if it is a number in the file.
std::string version_text(const JsonValue& value) {
    const std::string json = value.to_json();
    return json.starts_with('"') ? std::string(value.to_string()) : json;
}

} // namespace

Document::Document(const std::filesystem::path& path, std::vector<std::byte> bytes, Sink& sink)
    : path_(path), file_(path.string()), bytes_(std::move(bytes)), json_chunk_(bytes_) {
    if (bytes_.empty()) {
        throw Error(ErrorCode::BadInput, FileLocation{file_}, "the file is empty; expected a glTF 2.0 document");
    }
    if (bytes_.size() >= sizeof kGlbMagic && read_u32(bytes_, 0) == kGlbMagic) {
        split_glb(sink);
    } else if (lower_case_extension(path) == ".glb") {
        throw Error(ErrorCode::BadInput, FileLocation{file_}, "byte 0: expected \"glTF\", the start of a GLB file");
    }
    parse(json_chunk_, sink);
    check_version(sink);
    for (const std::string_view name : kTables) read_table(name, root(), sink);
    read_or_leave_out("/extensions/KHR_lights_punctual", sink, [&] {
        if (const auto lights = root().extension("KHR_lights_punctual")) read_table("lights", *lights, sink);
    });
    check_extensions(sink);
}

void Document::read_table(std::string_view name, const JsonValue& holder, Sink& sink) {
    std::vector<JsonValue>& table = tables_[std::string(name)];
    read_member(holder, name, sink, [&](const JsonValue& member) { table = member.elements(); });
}

/// Returns the end of the container, in bytes: the header's length, or the file's size if that length is impossible.
std::size_t Document::glb_end(Sink& sink) const {
    const uint32_t length = read_u32(bytes_, 8);
    if (length >= kHeaderBytes && length <= bytes_.size()) return length;
    sink.warn({FileLocation{file_},
               fmt::format("byte 8: the header states {} bytes, but the file has {}; all of them are read", length,
                           bytes_.size())});
    return bytes_.size();
}

/// Returns the end of the chunk of JSON that begins at byte `begin`, and the start of the next. Some exporters count
/// the padding wrongly; then the text itself determines its end, and the binary chunk follows.
Document::ChunkEnd Document::json_chunk_end(std::size_t begin, std::size_t size, Sink& sink) const {
    const std::span<const std::byte> glb(bytes_);
    const auto begins_binary = [&](std::size_t at) {
        return at + kChunkHeaderBytes <= glb.size() && read_u32(glb, at + 4) == kBinaryChunk;
    };
    const std::size_t declared = begin + std::min(size, glb.size() - begin);
    if (begins_binary(declared)) return {declared, declared};
    const std::string_view rest = text_of(glb.subspan(begin));
    const std::size_t end = begin + json_size(rest);
    std::size_t next = end;
    while (!begins_binary(next) && next < glb.size() && is_padding(rest[next - begin])) ++next;
    const bool is_whole = end <= declared && std::ranges::all_of(rest.substr(end - begin, declared - end), is_padding);
    if (!begins_binary(next)) {
        if (is_whole || end == glb.size()) return {declared, declared};
        next = end;
    }
    sink.warn({FileLocation{file_},
               fmt::format("byte {}: the chunk states {} bytes, but its text ends after {}; the text is read",
                           begin - kChunkHeaderBytes, size, end - begin)});
    return {end, next};
}

/// Returns the end of the binary chunk, in bytes: the start of another chunk, or the end of the file.
std::size_t Document::binary_chunk_end(std::size_t begin, std::size_t size, Sink& sink) const {
    const std::span<const std::byte> glb(bytes_);
    const std::size_t declared = begin + std::min(size, glb.size() - begin), left = glb.size() - declared;
    const auto is_letter = [](std::byte c) { return c > std::byte{' '} && c < std::byte{0x7f}; };
    const bool is_chunk = size % 4 == 0 && left >= kChunkHeaderBytes &&
                          read_u32(glb, declared) <= left - kChunkHeaderBytes &&
                          std::ranges::all_of(glb.subspan(declared + 4, 3), is_letter);
    if (is_chunk || std::ranges::all_of(text_of(glb.subspan(declared)), is_padding)) return declared;
    sink.warn(
        {FileLocation{file_}, fmt::format("byte {}: the chunk states {} bytes, but no other follows; all {} are read",
                                          begin - kChunkHeaderBytes, size, glb.size() - begin)});
    return glb.size();
}

void Document::split_glb(Sink& sink) {
    const auto fail = [&](std::size_t at, const std::string& what) {
        return Error(ErrorCode::BadInput, FileLocation{file_}, fmt::format("byte {}: {}", at, what));
    };
    if (bytes_.size() < kHeaderBytes) throw fail(bytes_.size(), "the file ends within the GLB header of 12 bytes");
    const uint32_t version = read_u32(bytes_, 4);
    if (version != 2) throw fail(4, fmt::format("GLB container version {}; expected 2", version));
    const std::size_t end = glb_end(sink);
    const std::span<const std::byte> glb(bytes_);
    bool has_json = false;
    for (std::size_t at = kHeaderBytes; bytes_.size() - at >= kChunkHeaderBytes;) {
        const uint32_t size = read_u32(glb, at), type = read_u32(glb, at + 4);
        // Data after the end is ignored, except for the binary chunk if the header counts only the JSON.
        if (at >= end && (type != kBinaryChunk || binary_chunk_)) break;
        const std::size_t begin = at + kChunkHeaderBytes, available = glb.size() - begin;
        if (!has_json && type != kJsonChunk) throw fail(at, "the first chunk of a GLB file must be JSON");
        ChunkEnd end_of_chunk = {begin + std::min<std::size_t>(size, available)};
        end_of_chunk.next = end_of_chunk.end;
        if (!has_json) {
            end_of_chunk = json_chunk_end(begin, size, sink);
        } else if (type == kBinaryChunk && !binary_chunk_) {
            end_of_chunk.end = end_of_chunk.next = binary_chunk_end(begin, size, sink);
        }
        if (size > available && end_of_chunk.end == glb.size()) {
            sink.leave_out(
                {FileLocation{file_}, fmt::format("byte {}: the chunk states {} bytes, but {} are left; the file is "
                                                  "truncated or damaged, and missing data is left out",
                                                  at, size, available)});
        }
        const std::span<const std::byte> chunk = glb.subspan(begin, end_of_chunk.end - begin);
        if (!has_json)
            json_chunk_ = chunk;
        else if (type == kBinaryChunk && !binary_chunk_)
            binary_chunk_ = chunk;
        has_json = true;
        at = end_of_chunk.next;
    }
    if (!has_json) throw fail(kHeaderBytes, "there is no JSON chunk");
}

void Document::parse(std::span<const std::byte> json, Sink& sink) {
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    std::string_view text = text_of(json);
    if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
    while (text.ends_with('\0')) text.remove_suffix(1); // some exporters fill up with zero bytes
    simdjson::dom::element element;
    // The parser reads past the end in whole vectors: it gets a copy with room for that.
    if (const simdjson::error_code failure = parser_.parse(simdjson::padded_string(text)).get(element)) {
        std::vector<std::string> repairs;
        const std::string mended = repair_json(text, RepairJson::All, &repairs);
        if (failure == simdjson::DEPTH_ERROR || parser_.parse(mended).get(element)) throw bad_json(text, failure);
        for (const std::string& what : repairs) sink.warn({FileLocation{file_}, what});
    }
    root_.emplace(file_, "", element);
}

Error Document::bad_json(std::string_view text, simdjson::error_code failure) const {
    std::string what =
        fmt::format("not valid JSON: {}; expected a glTF 2.0 document", simdjson::error_message(failure));
    if (failure == simdjson::DEPTH_ERROR) {
        what = fmt::format("JSON nested more than {} levels deep; expected a glTF 2.0 document", parser_.max_depth());
    } else if (const std::optional<JsonFault> fault = find_json_fault(text, RepairJson::All)) {
        const auto start = static_cast<std::size_t>(text.data() - reinterpret_cast<const char*>(bytes_.data()));
        what = fmt::format("not valid JSON: {} (byte {} of the file): expected {}", line_and_column(text, fault->byte),
                           start + fault->byte, fault->expected);
    }
    return Error(ErrorCode::BadInput, FileLocation{file_}, what);
}

void Document::check_version(Sink& sink) const {
    const auto parts = [&](const JsonValue& value) {
        const std::string text = version_text(value);
        std::array<unsigned, 2> numbers = {0, 0}; // major, minor
        const char *begin = text.data(), *end = begin + text.size();
        const auto major = std::from_chars(begin, end, numbers[0]);
        bool good = major.ec == std::errc() && major.ptr != end && *major.ptr == '.';
        if (good) {
            const auto minor = std::from_chars(major.ptr + 1, end, numbers[1]);
            good = minor.ec == std::errc() && minor.ptr == end;
        }
        if (!good) {
            sink.warn({value.location(),
                       fmt::format("\"{}\" is not a version; the file is read as glTF 2.0", shortened(text))});
            numbers = {2, 0};
        }
        return numbers;
    };
    const std::optional<JsonValue> asset = root().find("asset");
    const std::optional<JsonValue> version = asset ? asset->find("version") : std::nullopt;
    if (!version) {
        sink.warn({root().location(), "\"asset\" with a \"version\" is missing; it is read as glTF 2.0"});
        return;
    }
    if (parts(*version)[0] != 2) {
        throw version->error(fmt::format("glTF {} is not supported; expected 2.0", version_text(*version)));
    }
    const std::optional<JsonValue> least = asset->find("minVersion");
    if (least && parts(*least) > std::array<unsigned, 2>{2, 1}) {
        sink.leave_out({least->location(), fmt::format("the file needs glTF {}; features that 2.1 lacks are left out",
                                                       version_text(*least))});
    }
}

void Document::check_extensions(Sink& sink) const {
    std::set<std::string, std::less<>> reported;
    const auto check = [&](std::string_view list, const char* verb) {
        const std::optional<JsonValue> names = root().find(list);
        if (!names) return;
        std::vector<JsonValue> elements;
        read_or_leave_out(*names, sink, [&] { elements = names->elements(); });
        for (const JsonValue& name : elements) {
            read_or_leave_out(name, sink, [&] {
                const std::string_view extension = name.to_string();
                if (is_known_extension(extension) || !reported.emplace(extension).second) return;
                sink.leave_out(
                    {name.location(), fmt::format("the file {} the extension {}, which is not supported and left out",
                                                  verb, shortened(extension))});
            });
        }
    };
    check("extensionsRequired", "requires");
    check("extensionsUsed", "uses");
    const auto is_unreported = [&](std::string_view name) {
        return !is_known_extension(name) && !reported.contains(name);
    };
    for (const auto& [name, json] : root().extensions_within(is_unreported)) {
        if (!reported.insert(name).second) continue;
        sink.leave_out({json.location(),
                        fmt::format("the extension {} is not supported, not listed in \"extensionsUsed\", and left out",
                                    shortened(name))});
    }
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
