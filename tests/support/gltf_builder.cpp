#include "tests/support/gltf_builder.h"

#include <algorithm>

#include "base/error.h"
#include "base/write_file_atomically.h"
#include "formats/gltf/read_gltf.h"
#include "tests/support/options.h"

namespace fs = std::filesystem;

namespace pertev::test {
namespace {

fs::path write_model(const std::string& json) {
    const fs::path path = scratch_folder() / "model.gltf";
    write_file_atomically(path, std::as_bytes(std::span(json)));
    return path;
}

void append_u32(std::vector<std::byte>& bytes, std::size_t value) {
    const auto number = static_cast<uint32_t>(value);
    const auto raw = std::as_bytes(std::span(&number, 1));
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

} // namespace

std::string base64(std::span<const std::byte> bytes) {
    constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t group = 0;
        const std::size_t size = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) {
            group = group << 8 | (k < size ? static_cast<uint32_t>(bytes[i + k]) : 0u);
        }
        for (std::size_t k = 0; k < 4; ++k) text += k <= size ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

int GltfBuilder::add_view_of_bytes(std::span<const std::byte> bytes, const std::string& members) {
    data_.resize((data_.size() + 3) / 4 * 4);
    views_ += (view_count_ > 0 ? "," : "") + ("{\"buffer\":0,\"byteOffset\":" + std::to_string(data_.size())) +
              ",\"byteLength\":" + std::to_string(bytes.size()) + members + "}";
    data_.insert(data_.end(), bytes.begin(), bytes.end());
    return view_count_++;
}

int GltfBuilder::add_compressed_view(const std::vector<unsigned char>& bytes, std::size_t stride, std::size_t count,
                                     const std::string& members, const std::string& prefix) {
    const std::size_t at = (data_.size() + 3) / 4 * 4;
    return add_view_of_bytes(std::as_bytes(std::span(bytes)),
                             ",\"byteStride\":" + std::to_string(stride) + ",\"extensions\":{\"" + prefix +
                                 "_meshopt_compression\":{\"buffer\":0,\"byteOffset\":" + std::to_string(at) +
                                 ",\"byteLength\":" + std::to_string(bytes.size()) + ",\"byteStride\":" +
                                 std::to_string(stride) + ",\"count\":" + std::to_string(count) + members + "}}");
}

int GltfBuilder::add_accessor(const std::string& members) {
    accessors_ += (accessor_count_ > 0 ? ",{" : "{") + members + "}";
    return accessor_count_++;
}

std::string GltfBuilder::tables(const std::string& uri) const {
    if (data_.empty()) return "";
    return "\"buffers\":[{\"byteLength\":" + std::to_string(data_.size()) + uri + "}],\"bufferViews\":[" + views_ +
           "],\"accessors\":[" + accessors_ + "],";
}

std::string GltfBuilder::json(const std::string& members) const {
    return "{\"asset\":{\"version\":\"2.0\"}," +
           tables(",\"uri\":\"data:application/octet-stream;base64," + base64(data_) + "\"") + members + "}";
}

std::vector<std::byte> GltfBuilder::glb(const std::string& members) const {
    std::string text = "{\"asset\":{\"version\":\"2.0\"}," + tables("") + members + "}";
    while (text.size() % 4 != 0) text += ' ';
    std::vector<std::byte> binary = data_;
    binary.resize((binary.size() + 3) / 4 * 4);
    std::vector<std::byte> file;
    append_u32(file, 0x46546c67);
    append_u32(file, 2);
    append_u32(file, 12 + 8 + text.size() + 8 + binary.size());
    append_u32(file, text.size());
    append_u32(file, 0x4e4f534a);
    const auto text_bytes = std::as_bytes(std::span(text));
    file.insert(file.end(), text_bytes.begin(), text_bytes.end());
    append_u32(file, binary.size());
    append_u32(file, 0x004e4942);
    file.insert(file.end(), binary.begin(), binary.end());
    return file;
}

std::size_t GltfBuilder::components_of(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "VEC2" ? 2 : type == "VEC3" ? 3 : type == "VEC4" ? 4 : 16;
}

Scene read_gltf_text(const std::string& json, Messages& messages, bool geometry_only) {
    const fs::path path = write_model(json);
    return read_gltf(path, FileAccess(path, {}), {.allowed_paths = {}, .geometry_only = geometry_only}, messages);
}

Scene read_gltf_text(const std::string& json) {
    Messages messages;
    return read_gltf_text(json, messages);
}

std::string gltf_fault(const std::string& json) {
    Messages messages;
    std::string text;
    try {
        read_gltf_text(json, messages);
        const std::vector<std::string> left_out = messages.left_out();
        if (left_out.empty()) return "";
        text = left_out.front();
        if (text.ends_with(" is left out")) text = text.substr(0, text.rfind("; "));
    } catch (const Error& error) {
        text = error.what();
    }
    return text.substr(std::min(text.size(), text.find("model.gltf")));
}

bool has_warning(const Messages& messages, const std::vector<std::string>& parts) {
    return std::any_of(messages.all().begin(), messages.all().end(), [&](const Message& message) {
        return message.is_warning && std::all_of(parts.begin(), parts.end(), [&](const std::string& part) {
                   return message.text.find(part) != std::string::npos;
               });
    });
}

} // namespace pertev::test
