#include "formats/gltf/buffers.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/gltf/meshopt_attributes.h"
#include "formats/gltf/uri.h"

namespace pertev::gltf {
namespace {

// Version 0 of the vertex codec spends at least two bits on a group of 16 bytes, version 1 on 256 bytes, the others
// more: no stream can grow further.
constexpr uint64_t kMaxCodecRatio = 64, kMaxRatioOfVersion1 = 1024;

constexpr std::string_view kCodecs[] = {"KHR_meshopt_compression", "EXT_meshopt_compression"};

/// Returns what a view or buffer has of either extension; they have the same members.
std::optional<JsonValue> meshopt_compression(const JsonValue& json) {
    for (const std::string_view name : kCodecs) {
        if (std::optional<JsonValue> found = json.extension(name)) return found;
    }
    return std::nullopt;
}

} // namespace

Buffers::Buffers(const Document& document, const FileAccess& access, Sink& sink)
    : document_(document), decompressed_(document.table("bufferViews").size()), file_bytes_(document.file_bytes()) {
    const std::vector<JsonValue>& buffers = document.table("buffers");
    buffers_.resize(buffers.size());
    faults_.resize(buffers.size());
    const auto read = [&](std::size_t i) {
        if (const std::optional<JsonValue> uri = buffers[i].find("uri")) {
            buffers_[i] = read_uri(*uri, access, sink);
        } else if (i == 0) {
            buffers_[i] = document.binary_chunk();
        }
        const std::optional<JsonValue> length = buffers[i].find("byteLength");
        if (!buffers_[i] || !length) return;
        const uint64_t bytes = length->to_unsigned();
        if (buffers_[i]->size() < bytes) {
            sink.warn({buffers[i].location(),
                       fmt::format("byteLength is {}, but there are only {} bytes", bytes, buffers_[i]->size())});
        } else {
            buffers_[i] = buffers_[i]->first(bytes);
        }
    };
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        try {
            read(i);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::BadInput) throw;
            buffers_[i].reset();
            faults_[i] = error;
        }
    }
}

std::span<const std::byte> Buffers::read_uri(const JsonValue& uri, const FileAccess& access, Sink& sink) {
    const auto own = [&](std::vector<std::byte> bytes) -> std::span<const std::byte> {
        file_bytes_ += bytes.size();
        return owned_.emplace_back(std::move(bytes));
    };
    const std::string_view text = uri.to_string();
    if (is_data_uri(text)) {
        std::optional<std::vector<std::byte>> bytes = decode_data_uri(text);
        if (!bytes)
            throw uri.error("the data URI cannot be decoded; expected data:application/octet-stream;base64,...");
        return own(*std::move(bytes));
    }
    const std::optional<std::string> name = file_name_of_uri(text, document_.path());
    if (!name) throw uri.error(fmt::format("\"{}\"; expected a relative path or a data URI", shortened(text)));
    std::optional<std::filesystem::path> path;
    try {
        path = access.find(uri.location(), *name, sink);
        if (path) {
            const auto [entry, is_new] = by_path_.try_emplace(*path);
            if (is_new) entry->second = own(read_file(*path));
            return entry->second;
        }
    } catch (const Error& error) {
        throw uri.error(error);
    }
    throw uri.error(fmt::format("there is no file {}", shortened(*name)));
}

std::span<const std::byte> Buffers::slice(const JsonValue& json) const {
    const JsonValue reference = json.at("buffer");
    const uint32_t index = document_.index_into("buffers", reference);
    if (faults_[index]) throw Error(*faults_[index]);
    const std::optional<std::span<const std::byte>>& buffer = buffers_[index];
    if (!buffer) throw reference.error("this buffer has no data: neither a uri nor the binary chunk of a .glb");
    const uint64_t offset = json.unsigned_or("byteOffset", 0), length = json.at("byteLength").to_unsigned();
    if (offset > buffer->size() || length > buffer->size() - offset) {
        throw json.error(
            fmt::format("{} bytes from byte {} exceed the buffer of {} bytes", length, offset, buffer->size()));
    }
    return buffer->subspan(offset, length);
}

std::vector<std::byte> Buffers::decompress(const JsonValue& compressed) {
    const std::span<const std::byte> source = slice(compressed);
    const uint64_t count = compressed.at("count").to_unsigned(), stride = compressed.at("byteStride").to_unsigned();
    const std::string mode = compressed.string_or("mode", ""), filter = compressed.string_or("filter", "NONE");
    const bool is_vertices = mode == "ATTRIBUTES";
    if (!is_vertices && mode != "TRIANGLES" && mode != "INDICES") {
        throw compressed.error(fmt::format("mode \"{}\"; expected ATTRIBUTES, TRIANGLES or INDICES", mode));
    }
    // Conditions of the extension's text; the decoders take them for granted.
    const bool good_stride = is_vertices ? stride > 0 && stride <= 256 && stride % 4 == 0 : stride == 2 || stride == 4;
    if (!good_stride) throw compressed.error(fmt::format("byteStride {} is not allowed for {}", stride, mode));
    if (mode == "TRIANGLES" && count % 3 != 0) throw compressed.error("count is not a multiple of 3");
    const bool good_filter =
        filter == "NONE" || (is_vertices && filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
        (is_vertices && filter == "QUATERNION" && stride == 8) || (is_vertices && filter == "EXPONENTIAL") ||
        (is_vertices && filter == "COLOR" && (stride == 4 || stride == 8));
    if (!good_filter) {
        throw compressed.error(fmt::format("filter \"{}\" is not allowed for {} of {} bytes", filter, mode, stride));
    }
    const bool has_version_1 = is_vertices && has_meshopt_version_1(source);
    if (count > (has_version_1 ? kMaxRatioOfVersion1 : kMaxCodecRatio) * source.size() / stride) {
        throw compressed.error(
            fmt::format("{} compressed bytes cannot hold {} elements of {} bytes", source.size(), count, stride));
    }

    charge(count * stride, compressed);
    std::vector<std::byte> bytes(count * stride);
    const auto* data = reinterpret_cast<const unsigned char*>(source.data());
    int failure = 0;
    if (count == 0) return bytes;
    if (has_version_1)
        failure = decode_meshopt_attributes(source, stride, bytes) ? 0 : 1;
    else if (is_vertices)
        failure = meshopt_decodeVertexBuffer(bytes.data(), count, stride, data, source.size());
    else if (mode == "TRIANGLES")
        failure = meshopt_decodeIndexBuffer(bytes.data(), count, stride, data, source.size());
    else
        failure = meshopt_decodeIndexSequence(bytes.data(), count, stride, data, source.size());
    if (failure != 0) throw compressed.error("the compressed data is damaged");
    if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count, stride);
    if (filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count, stride);
    if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
    if (filter == "COLOR") decode_meshopt_colors(bytes, stride);
    return bytes;
}

BufferView Buffers::view(const JsonValue& reference) {
    const uint32_t index = document_.index_into("bufferViews", reference);
    const JsonValue& view = document_.table("bufferViews")[index];
    const std::optional<JsonValue> compressed = meshopt_compression(view);
    if (!compressed) return {slice(view), view.unsigned_or("byteStride", 0)};
    if (!decompressed_[index]) decompressed_[index] = decompress(*compressed);
    return {*decompressed_[index], view.unsigned_or("byteStride", 0)};
}

void Buffers::put(const JsonValue& reference, std::vector<std::byte> bytes) {
    put_[document_.index_into("accessors", reference)] = std::move(bytes);
}

std::optional<std::span<const std::byte>> Buffers::put_bytes(uint32_t accessor) const {
    const auto found = put_.find(accessor);
    if (found == put_.end()) return std::nullopt;
    return found->second;
}

void Buffers::charge(uint64_t bytes, const JsonValue& json) {
    const uint64_t limit = justified_bytes(kFreeMeshBytes, file_bytes_);
    charged_bytes_ += bytes;
    if (bytes > limit || charged_bytes_ > limit) {
        throw Error(ErrorCode::OverLimit, json.location(),
                    fmt::format("the scene takes more than {} MB of memory, {} times the size of its files; share one "
                                "mesh instead of many meshes with the same data",
                                limit >> 20, kMaxExpansion));
    }
}

} // namespace pertev::gltf
