#include "session/film_file/history_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json_text.h"
#include "base/machine_memory.h"
#include "formats/json/json_file.h"

namespace pertev {
namespace {

constexpr std::size_t kStride = sizeof(float); // all arrays are of words

std::string json_of(const DecidingSettings& settings, uint32_t frame, const FrameHistory& history) {
    std::vector<std::string> entries;
    for (const auto& [name, value] : settings)
        entries.push_back(fmt::format("{}:{}", json_string(name), json_string(value)));
    std::vector<std::size_t> sizes;
    for (const auto& array : history.arrays) sizes.push_back(array.size());
    return fmt::format(R"({{"settings":{{{}}},"frame":{},"sample":{},"reservoirs":{},"light":{},"arrays":[{}]}})",
                       fmt::join(entries, ","), frame, history.number, history.has_reservoirs, history.has_light,
                       fmt::join(sizes, ","));
}

constexpr std::size_t kMostArrays = 64; // a history has far fewer

uint32_t read_number(const gltf::JsonValue& value) {
    const uint64_t number = value.to_unsigned();
    if (number > UINT32_MAX) throw value.error("the number is too large");
    return static_cast<uint32_t>(number);
}

} // namespace

HistoryFile::HistoryFile(std::string file, DecidingSettings settings)
    : generations_(std::move(file)), settings_(std::move(settings)) {}

KeptFrame HistoryFile::read_generation(const std::string& file) const {
    BlockFileReader reader(file, kHistoryFile);
    const JsonFile parsed(reader.name(), reader.json());
    const gltf::JsonValue& root = parsed.root();
    DecidingSettings before;
    for (const auto& [name, value] : root.at("settings").members()) before.emplace_back(name, value.to_string());
    if (const auto different = first_difference(before, settings_)) {
        Remark why(FileLocation{file},
                   fmt::format("the checkpoint belongs to another sequence: {}; name another file, or delete it to "
                               "render earlier frames again",
                               text_of(*different)));
        why.setting = "checkpoint";
        throw RefusedGeneration(ErrorCode::BadInput, std::move(why));
    }
    KeptFrame kept;
    kept.frame = read_number(root.at("frame"));
    kept.history.number = read_number(root.at("sample"));
    kept.history.has_reservoirs = root.at("reservoirs").to_bool();
    kept.history.has_light = root.at("light").to_bool();
    std::vector<std::size_t> sizes;
    uint64_t fewest = 0, all = 0;
    for (const gltf::JsonValue& size : root.at("arrays").elements()) {
        if (sizes.size() == kMostArrays) throw size.error("too many arrays");
        sizes.push_back(size.to_unsigned());
        if (sizes.back() % kStride != 0 || sizes.back() > UINT64_C(1) << 48)
            throw size.error("an array cannot have this size");
        fewest += BlockFileReader::fewest_bytes(sizes.back(), kStride);
        all += sizes.back();
    }
    reader.check_size(fewest);
    if (all > machine_memory_bytes()) throw reader.error("the history does not fit into this machine's memory");
    for (const std::size_t size : sizes) reader.read_array(kept.history.arrays.emplace_back(size), kStride);
    reader.finish();
    return kept;
}

std::optional<KeptFrame> HistoryFile::read(Sink& sink) {
    std::optional<KeptFrame> kept;
    const auto damage =
        generations_.take([&](const std::string& generation) { kept = read_generation(generation); }, sink);
    if (damage) sink.warn(damage->remark().and_then("; earlier frames are rendered again"));
    return kept;
}

std::vector<std::byte> history_file_bytes(const DecidingSettings& settings, uint32_t frame,
                                          const FrameHistory& history) {
    BlockFileBytes bytes(kHistoryFile, json_of(settings, frame, history));
    for (const auto& array : history.arrays) bytes.add_array(array, kStride);
    return bytes.take();
}

void HistoryFile::write(uint32_t frame, const FrameHistory& history) {
    uint64_t most = 0;
    for (const auto& array : history.arrays) most += array.size();
    generations_.check_space(most);
    generations_.write(history_file_bytes(settings_, frame, history));
}

} // namespace pertev
