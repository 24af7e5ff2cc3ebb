#include "formats/gltf/credits.h"

#include <algorithm>
#include <initializer_list>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/message_text.h"
#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

/// Returns the texts in a value of XMP, separated by commas: a text, an object with a text or a list, or an array.
/// The first of alternatives (rdf:Alt) stands for all of them.
std::string text_in(const JsonValue& value, int depth = 0) {
    constexpr int kMostDepth = 4;
    const std::string json = value.to_json();
    if (json.starts_with('"')) return std::string(value.to_string());
    if (depth == kMostDepth) return "";
    if (json.starts_with('[')) {
        std::string all;
        for (const JsonValue& element : value.elements()) {
            const std::string text = text_in(element, depth + 1);
            if (!text.empty()) all += (all.empty() ? "" : ", ") + text;
        }
        return all;
    }
    if (!json.starts_with('{')) return "";
    for (const char* key : {"@value", "@list", "@set", "rdf:_1", "@id"}) {
        if (const std::optional<JsonValue> member = value.find(key)) return text_in(*member, depth + 1);
    }
    return "";
}

/// Returns the text of the first of the named members that has a text.
std::string first_text(const std::optional<JsonValue>& object, std::initializer_list<const char*> keys) {
    if (!object || !object->to_json().starts_with('{')) return ""; // "extras" may be anything
    for (const char* key : keys) {
        const std::optional<JsonValue> member = object->find(key);
        const std::string text = member ? text_in(*member) : "";
        if (!text.empty()) return text;
    }
    return "";
}

/// Returns the packet of XMP that describes the whole file.
std::optional<JsonValue> packet_of(const Document& document, const JsonValue& asset) {
    const std::optional<JsonValue> own = asset.extension("KHR_xmp_json_ld"),
                                   all = document.root().extension("KHR_xmp_json_ld");
    if (!own || !all) return std::nullopt;
    const JsonValue reference = own->at("packet");
    const std::vector<JsonValue> packets = all->elements_of("packets");
    const uint64_t index = reference.to_unsigned();
    if (index >= packets.size()) {
        throw reference.error(fmt::format("{}; there are {} packets", index, packets.size()));
    }
    return packets[index];
}

constexpr std::string_view kBetweenCredits = "; ";

/// Splits a text of several files' credits into single credits.
std::vector<std::string> separate(std::string_view credits) {
    std::vector<std::string> parts;
    for (const auto part : std::views::split(credits, kBetweenCredits)) parts.emplace_back(part.begin(), part.end());
    return parts;
}

} // namespace

void read_credits(const Document& document, Scene& scene, Sink& sink) {
    const std::optional<JsonValue> asset = document.root().find("asset");
    if (!asset) return;
    std::string author, license;
    read_or_leave_out("/extensions/KHR_xmp_json_ld", sink, [&] {
        const std::optional<JsonValue> packet = packet_of(document, *asset);
        author = first_text(packet, {"dc:creator", "xmpDM:artist"});
        license = first_text(packet, {"dc:rights", "xmpRights:UsageTerms", "xmpRights:WebStatement"});
    });
    read_or_leave_out("/asset", sink, [&] {
        const std::optional<JsonValue> extras = asset->find("extras");
        if (author.empty()) author = first_text(extras, {"author"});
        if (license.empty()) license = first_text(extras, {"license"});
    });
    const auto suggest = [&](const char* setting, const std::string& text) {
        if (!text.empty()) scene.suggested.push_back({setting, shortened(text)});
    };
    suggest("author", author);
    suggest("license", license);
}

void add_credits(const Scene& part, Scene& scene) {
    for (const SuggestedSetting& credit : part.suggested) {
        const auto known = std::ranges::find(scene.suggested, credit.name, &SuggestedSetting::name);
        if (known == scene.suggested.end()) {
            scene.suggested.push_back(credit);
            continue;
        }
        std::vector<std::string> parts = separate(known->text);
        for (const std::string& other : separate(credit.text)) {
            if (std::ranges::find(parts, other) == parts.end()) parts.push_back(other);
        }
        known->text = shortened(fmt::format("{}", fmt::join(parts, kBetweenCredits)));
    }
}

} // namespace pertev::gltf
