#include "formats/gltf_writer/glb_parts.h"

#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json_text.h"
#include "math/bounds3.h"

namespace pertev::glb {
namespace {

constexpr uint32_t kFloat = 5126, kUnsigned = 5125; // OpenGL's constants
constexpr uint32_t kMagic = 0x46546c67, kVersion = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;

void append_word(std::vector<std::byte>& file, std::size_t word) {
    for (int shift = 0; shift < 32; shift += 8) file.push_back(static_cast<std::byte>(word >> shift & 0xff));
}

void append_chunk(std::vector<std::byte>& file, uint32_t kind, std::span<const std::byte> bytes, char filling) {
    const std::size_t padded = (bytes.size() + 3) / 4 * 4;
    append_word(file, padded);
    append_word(file, kind);
    file.insert(file.end(), bytes.begin(), bytes.end());
    file.resize(file.size() + padded - bytes.size(), static_cast<std::byte>(filling));
}

} // namespace

std::string json_float(float value) { return is_finite(value) ? fmt::format("{}", value) : "0"; }

std::string json_floats(std::span<const float> values) {
    std::vector<std::string> texts;
    for (const float value : values) texts.push_back(json_float(value));
    return fmt::format("[{}]", fmt::join(texts, ","));
}

JsonMembers& JsonMembers::add(const char* name, const std::string& json) {
    text_ += fmt::format("{}\"{}\":{}", text_.empty() ? "" : ",", name, json);
    return *this;
}

JsonMembers& JsonMembers::add_number(const char* name, float value, float usual) {
    return value == usual ? *this : add(name, json_float(value));
}

uint32_t GlbParts::add(const std::string& table, std::string object) {
    std::vector<std::string>& objects = tables_[table];
    objects.push_back(std::move(object));
    return static_cast<uint32_t>(objects.size() - 1);
}

uint32_t GlbParts::add_once(const std::string& table, const std::string& object) {
    const auto [entry, is_new] = known_.try_emplace(table + object);
    if (is_new) entry->second = add(table, object);
    return entry->second;
}

uint32_t GlbParts::add_view(std::span<const std::byte> bytes) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    const std::size_t offset = binary_.size();
    binary_.insert(binary_.end(), bytes.begin(), bytes.end());
    return add("bufferViews", fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}}})", offset, bytes.size()));
}

uint32_t GlbParts::add_accessor(std::span<const std::byte> bytes, uint32_t component, std::size_t count,
                                const char* type, const std::string& bounds) {
    const uint32_t view = add_view(bytes);
    return add("accessors", fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})", view,
                                        component, count, type, bounds));
}

uint32_t GlbParts::add_indices(std::span<const uint32_t> indices) {
    return add_accessor(std::as_bytes(indices), kUnsigned, indices.size(), "SCALAR");
}

uint32_t GlbParts::add_array(std::span<const Vec2> values) {
    return add_accessor(std::as_bytes(values), kFloat, values.size(), "VEC2");
}

uint32_t GlbParts::add_array(std::span<const Vec3> values, bool has_bounds) {
    std::string text;
    if (has_bounds) {
        Bounds3 bounds;
        for (const Vec3 v : values) bounds.extend(v);
        const Vec3 lo = bounds.lo, hi = bounds.hi;
        text = fmt::format(R"(,"min":{},"max":{})", json_floats(std::array{lo.x, lo.y, lo.z}),
                           json_floats(std::array{hi.x, hi.y, hi.z}));
    }
    return add_accessor(std::as_bytes(values), kFloat, values.size(), "VEC3", text);
}

uint32_t GlbParts::add_array(std::span<const Vec4> values) {
    return add_accessor(std::as_bytes(values), kFloat, values.size(), "VEC4");
}

std::vector<std::byte> GlbParts::finish(JsonMembers members) const {
    if (!extensions_.empty()) {
        members.add("extensionsUsed", json_strings(std::vector<std::string>(extensions_.begin(), extensions_.end())));
    }
    for (const auto& [table, objects] : tables_)
        members.add(table.c_str(), fmt::format("[{}]", fmt::join(objects, ",")));
    if (!binary_.empty()) members.add("buffers", fmt::format(R"([{{"byteLength":{}}}])", binary_.size()));
    const std::string json = members.text();
    constexpr std::size_t kHeader = 12, kChunkHeaders = 16, kPadding = 6;
    if (json.size() + binary_.size() + kHeader + kChunkHeaders + kPadding > std::numeric_limits<uint32_t>::max()) {
        throw Error(ErrorCode::OverLimit, "the file would be larger than 4 GiB, the format's limit");
    }
    std::vector<std::byte> file;
    append_word(file, kMagic);
    append_word(file, kVersion);
    append_word(file, 0);
    append_chunk(file, kJsonChunk, std::as_bytes(std::span(json)), ' ');
    if (!binary_.empty()) append_chunk(file, kBinaryChunk, binary_, '\0');
    const auto size = static_cast<uint32_t>(file.size());
    std::memcpy(file.data() + 2 * sizeof(uint32_t), &size, sizeof size);
    return file;
}

} // namespace pertev::glb
