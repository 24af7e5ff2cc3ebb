#include "session/film_file/history_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json_text.h"
#include "base/machine_memory.h"
#include "base/remove_leftovers.h"
#include "base/write_file_atomically.h"
#include "formats/json/json_file.h"
#include "session/film_file/block_file.h"
#include "session/film_file/generations.h"

namespace pertev {
namespace {

constexpr BlockFileKind kHistoryFile = {"\x89PVH\r\n\x1a\n", 1, "history"};
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

/// The refusal of a history of another sequence.
class OtherSequence : public Error {
public:
    using Error::Error;
};

} // namespace

HistoryFile::HistoryFile(std::string file, DecidingSettings settings)
    : file_(std::move(file)), previous_(previous_generation(file_)), settings_(std::move(settings)) {}

KeptFrame HistoryFile::read_generation(const std::string& file) const {
    BlockFileReader reader(file, kHistoryFile);
    const JsonFile parsed(reader.name(), reader.json());
    const gltf::JsonValue& root = parsed.root();
    DecidingSettings before;
    for (const auto& [name, value] : root.at("settings").members()) before.emplace_back(name, value.to_string());
    if (const auto different = first_difference(before, settings_)) {
        Remark why(FileLocation{file},
                   fmt::format("the checkpoint belongs to another sequence: {} is \"{}\" there, not \"{}\"; name "
                               "another file, or delete it to render earlier frames again",
                               different->name, different->before, different->after));
        why.setting = "checkpoint";
        throw OtherSequence(ErrorCode::BadInput, std::move(why));
    }
    KeptFrame kept;
    kept.frame = static_cast<uint32_t>(root.at("frame").to_unsigned());
    kept.history.number = static_cast<uint32_t>(root.at("sample").to_unsigned());
    kept.history.has_reservoirs = root.at("reservoirs").to_bool();
    kept.history.has_light = root.at("light").to_bool();
    std::vector<std::size_t> sizes;
    uint64_t fewest = 0, all = 0;
    for (const gltf::JsonValue& size : root.at("arrays").elements()) {
        sizes.push_back(size.to_unsigned());
        if (sizes.back() % kStride != 0 || sizes.back() > UINT64_C(1) << 48) throw size.error("no size of an array");
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
    remove_leftovers(file_);
    if (!has_generation(file_)) return std::nullopt;
    try {
        return read_generation(file_);
    } catch (const OtherSequence&) {
        throw;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        is_damaged_ = true;
        if (!has_generation(previous_)) {
            sink.warn(error.remark().and_then("; earlier frames are rendered again"));
            return std::nullopt;
        }
        sink.warn(error.remark().and_then(fmt::format("; the previous generation, {}, is used", previous_)));
    }
    try {
        return read_generation(previous_);
    } catch (const OtherSequence&) {
        throw;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::BadInput) throw;
        sink.warn(error.remark().and_then("; earlier frames are rendered again"));
        return std::nullopt;
    }
}

void HistoryFile::write(uint32_t frame, const FrameHistory& history) {
    uint64_t most = 0;
    for (const auto& array : history.arrays) most += array.size();
    check_space_for_generations(file_, most);
    BlockFileBytes bytes(kHistoryFile, json_of(settings_, frame, history));
    for (const auto& array : history.arrays) bytes.add_array(array, kStride);
    const std::vector<std::byte> file = bytes.take();
    if (is_damaged_)
        write_file_atomically(file_, file);
    else
        write_generation(file_, previous_, file);
    is_damaged_ = false;
}

} // namespace pertev
