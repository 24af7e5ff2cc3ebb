#include "render/sample_layers/matte_names.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "base/json_text.h"

namespace pertev {
namespace {

constexpr uint32_t kFirst = 0xcc9e2d51, kSecond = 0x1b873593;

uint32_t mixed(uint32_t word) { return std::rotl(word * kFirst, 15) * kSecond; }

std::vector<uint32_t> ids_of(const std::vector<std::string>& names) {
    std::vector<uint32_t> ids;
    ids.reserve(names.size());
    for (const std::string& name : names) ids.push_back(matte_id(name));
    return ids;
}

std::vector<std::string> names_of(const auto& things, const char* kind) {
    std::vector<std::string> names;
    for (const auto& thing : things)
        names.push_back(thing.name.empty() ? fmt::format("{} {}", kind, names.size()) : thing.name);
    return names;
}

} // namespace

uint32_t murmur_hash3(std::string_view text) {
    uint32_t hash = 0;
    std::size_t at = 0;
    for (; at + 4 <= text.size(); at += 4) {
        uint32_t word; // in the order of x86, as the specification's hash has it
        std::memcpy(&word, text.data() + at, 4);
        hash = std::rotl(hash ^ mixed(word), 13) * 5 + 0xe6546b64;
    }
    uint32_t rest = 0;
    for (std::size_t i = text.size(); i > at; --i) rest = rest << 8 | static_cast<unsigned char>(text[i - 1]);
    hash ^= mixed(rest) ^ static_cast<uint32_t>(text.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6b;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35;
    return hash ^ hash >> 16;
}

uint32_t matte_id(std::string_view name) {
    const uint32_t hash = murmur_hash3(name), exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ 1u << 23 : hash;
}

MatteNames::MatteNames(const Scene& scene)
    : objects(names_of(scene.instances, "instance")), materials(names_of(scene.materials, "material")) {
    object_ids = ids_of(objects), material_ids = ids_of(materials);
}

std::vector<std::pair<std::string, std::string>>
matte_metadata(const std::string& type, std::span<const std::string> names, std::span<const uint32_t> shown) {
    std::map<std::string, uint32_t> manifest; // by name, so that its text does not depend on the scene's order
    for (const std::string& name : names) {
        const uint32_t id = matte_id(name);
        if (std::ranges::binary_search(shown, id)) manifest.emplace(name, id);
    }
    std::string text;
    for (const auto& [name, id] : manifest)
        text += fmt::format("{}{}:\"{:08x}\"", text.empty() ? "" : ",", json_string(name), id);
    const std::string key = "cryptomatte/" + fmt::format("{:08x}", murmur_hash3(type)).substr(0, 7) + "/";
    return {{key + "name", type},
            {key + "hash", "MurmurHash3_32"},
            {key + "conversion", "uint32_to_float32"},
            {key + "manifest", "{" + text + "}"}};
}

} // namespace pertev
