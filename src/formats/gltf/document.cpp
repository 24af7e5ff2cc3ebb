#include "formats/gltf/document.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file_extension.h"
#include "formats/gltf/find_json_fault.h"

namespace pertev::gltf {
namespace {

constexpr std::array<std::string_view, 9> kSupportedExtensions = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression",         "KHR_animation_pointer",
    "KHR_lights_punctual",     "KHR_materials_emissive_strength", "KHR_materials_ior",
    "KHR_materials_unlit",     "KHR_mesh_quantization",           "KHR_texture_transform"};

// Of these only the cases that materials.cpp names; it warns of the others. A file that requires one is refused.
constexpr std::array<std::string_view, 3> kSupportedInPart = {"KHR_materials_specular", "KHR_materials_transmission",
                                                              "KHR_materials_volume"};

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

bool is_one_of(std::span<const std::string_view> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

} // namespace

Document::Document(const std::filesystem::path& path, std::vector<std::byte> bytes, Messages& messages)
    : path_(path), file_(path.string()), bytes_(std::move(bytes)), json_chunk_(bytes_) {
    if (bytes_.empty()) {
        throw Error(ErrorCode::BadInput, fmt::format("{}: the file is empty; expected a glTF 2.0 document", file_));
    }
    if (bytes_.size() >= sizeof kGlbMagic && read_u32(bytes_, 0) == kGlbMagic) {
        split_glb();
    } else if (lower_case_extension(path) == ".glb") {
        throw Error(ErrorCode::BadInput,
                    fmt::format("{}: byte 0: expected the letters glTF, with which a GLB file starts", file_));
    }
    parse(json_chunk_);
    check_version();
    for (const std::string_view name : kTables) tables_.emplace(name, root().elements_of(name));
    const std::optional<JsonValue> lights = root().extension("KHR_lights_punctual");
    tables_.emplace("lights", lights ? lights->elements_of("lights") : std::vector<JsonValue>());
    check_extensions(messages);
}

void Document::split_glb() {
    const auto fail = [&](std::size_t at, const std::string& what) {
        return Error(ErrorCode::BadInput, fmt::format("{}: byte {}: {}", file_, at, what));
    };
    if (bytes_.size() < kHeaderBytes) throw fail(bytes_.size(), "the file ends within the GLB header of 12 bytes");
    const uint32_t version = read_u32(bytes_, 4), length = read_u32(bytes_, 8);
    if (version != 2) throw fail(4, fmt::format("GLB container version {}; expected 2", version));
    if (length > bytes_.size() || length < kHeaderBytes) {
        throw fail(8, fmt::format("the header says {} bytes, but the file has {}; it is cut off or damaged", length,
                                  bytes_.size()));
    }
    const std::span<const std::byte> glb(bytes_.data(), length);
    bool has_json = false;
    for (std::size_t at = kHeaderBytes; at < glb.size();) {
        if (glb.size() - at < kChunkHeaderBytes) throw fail(at, "the file ends within a chunk's header of 8 bytes");
        const uint32_t size = read_u32(glb, at), type = read_u32(glb, at + 4);
        const std::size_t begin = at + kChunkHeaderBytes, available = glb.size() - begin;
        if (size > available) {
            throw fail(at, fmt::format("the chunk says {} bytes, but {} are left; the file is cut off or damaged", size,
                                       available));
        }
        if (!has_json && type != kJsonChunk) throw fail(at, "the first chunk of a GLB file must be JSON");
        if (!has_json)
            json_chunk_ = glb.subspan(begin, size);
        else if (type == kBinaryChunk && !binary_chunk_)
            binary_chunk_ = glb.subspan(begin, size);
        has_json = true;
        at = begin + size;
    }
    if (!has_json) throw fail(kHeaderBytes, "there is no JSON chunk");
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
    return Error(ErrorCode::BadInput, fmt::format("{}: {}", file_, what));
}

void Document::check_version() const {
    const auto parts = [](const JsonValue& value) {
        const std::string_view text = value.to_string();
        std::array<unsigned, 2> numbers = {0, 0}; // major, minor
        const char *begin = text.data(), *end = begin + text.size();
        const auto major = std::from_chars(begin, end, numbers[0]);
        bool good = major.ec == std::errc() && major.ptr != end && *major.ptr == '.';
        if (good) {
            const auto minor = std::from_chars(major.ptr + 1, end, numbers[1]);
            good = minor.ec == std::errc() && minor.ptr == end;
        }
        if (!good) throw value.error(fmt::format("\"{}\" is not a version; expected \"2.0\"", text));
        return numbers;
    };
    const JsonValue asset = root().at("asset"), version = asset.at("version");
    if (parts(version)[0] != 2) {
        throw version.error(fmt::format("glTF {}; this reader knows 2.0", version.to_string()));
    }
    const std::optional<JsonValue> least = asset.find("minVersion");
    if (least && parts(*least) > std::array<unsigned, 2>{2, 0}) {
        throw least->error(fmt::format("the file needs glTF {}; this reader knows 2.0", least->to_string()));
    }
}

void Document::check_extensions(Messages& messages) const {
    for (const JsonValue& name : root().elements_of("extensionsRequired")) {
        if (is_one_of(kSupportedExtensions, name.to_string())) continue;
        throw name.error(fmt::format("the file requires the extension {}, which is not supported; export it without "
                                     "that extension",
                                     name.to_string()));
    }
    std::string left_out;
    for (const JsonValue& name : root().elements_of("extensionsUsed")) {
        const std::string_view extension = name.to_string();
        if (is_one_of(kSupportedExtensions, extension) || is_one_of(kSupportedInPart, extension)) continue;
        left_out += fmt::format("{}{}", left_out.empty() ? "" : ", ", extension);
    }
    if (left_out.empty()) return;
    messages.warn(fmt::format("{}: extensions that are not supported are left out: {}", file_, left_out));
}

const std::vector<JsonValue>& Document::table(std::string_view name) const {
    const auto found = tables_.find(name);
    PERTEV_CHECK(found != tables_.end());
    return found->second;
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
