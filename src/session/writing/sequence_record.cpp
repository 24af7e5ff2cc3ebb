#include "session/writing/sequence_record.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json_text.h"
#include "base/read_file.h"
#include "base/write_file_atomically.h"
#include "formats/json/json_file.h"
#include "session/frame_range.h"

namespace pertev {
namespace {

/// JSON object of texts by name; values are JSON strings.
std::string json_object(const auto& entries) {
    std::string text = "{";
    for (const auto& [name, value] : entries) {
        text += fmt::format("{}\n    {}: {}", text.size() > 1 ? "," : "", json_string(name), json_string(value));
    }
    return text + "\n  }";
}

} // namespace

SequenceRecord::SequenceRecord(std::vector<std::string> outputs, DecidingSettings settings,
                               std::vector<std::string> names, std::optional<PartNumber> part)
    : outputs_(std::move(outputs)), names_(std::move(names)), settings_(std::move(settings)),
      path_(std::filesystem::path(outputs_.front())
                .replace_extension(part ? fmt::format(".part-{}-of-{}.json", part->index + 1, part->count) : ".json")) {
    for (auto& [name, value] : settings_) value = utf8_text(value);
}

SequenceRecord::Frames SequenceRecord::frames_in(const std::filesystem::path& record) const {
    const JsonFile file(record);
    const gltf::JsonValue settings = file.root().at("settings");
    DecidingSettings before;
    for (const auto& [name, value] : settings.members()) before.emplace_back(name, value.to_string());
    if (const auto different = first_difference(before, settings_)) {
        Remark why(settings.location(),
                   fmt::format("the existing frames belong to another sequence: {}; render them again "
                               "without `continue`, or to other files",
                               text_of(*different)));
        why.setting = "continue";
        throw Error(ErrorCode::BadInput, std::move(why));
    }
    Frames frames;
    for (const gltf::JsonValue& frame : file.root().elements_of("files")) {
        frames.hashes[std::string(frame.at("name").to_string())] = frame.at("hash").to_string();
    }
    for (const gltf::JsonValue& frame : file.root().elements_of("pictures")) {
        frames.pictures[static_cast<uint32_t>(frame.at("frame").to_unsigned())] = frame.at("hash").to_string();
    }
    return frames;
}

bool SequenceRecord::load() {
    std::error_code fault;
    const bool is_there = std::filesystem::exists(path_, fault);
    if (is_there) own_ = frames_in(path_);
    const std::string whole = std::filesystem::path(outputs_.front()).stem().string();
    const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
    for (const auto& entry : std::filesystem::directory_iterator(folder, fault)) {
        const std::string name = entry.path().filename().string();
        const bool is_record =
            name == whole + ".json" || (name.starts_with(whole + ".part-") && name.ends_with(".json"));
        if (!is_record || name == path_.filename()) continue;
        try {
            others_.push_back(frames_in(entry.path()));
        } catch (const Error&) { // another sequence's
        }
    }
    return is_there;
}

bool SequenceRecord::has(uint32_t frame) const {
    for (const std::string& output : outputs_) {
        const std::filesystem::path file = frame_file(output, frame, names_);
        std::error_code fault;
        if (!std::filesystem::is_regular_file(file, fault)) return false;
        const auto knows = [&](const Frames& frames) { return frames.hashes.contains(file.string()); };
        if (!knows(own_) && std::ranges::none_of(others_, knows)) return false;
        const std::string hash = hash_of_file(file);
        const auto has_it = [&](const Frames& frames) {
            const auto known = frames.hashes.find(file.string());
            return known != frames.hashes.end() && known->second == hash;
        };
        if (!has_it(own_) && std::ranges::none_of(others_, has_it)) return false;
    }
    return true;
}

void SequenceRecord::check_picture(uint32_t frame, const std::string& picture) const {
    const auto check = [&](const Frames& frames) {
        const auto known = frames.pictures.find(frame);
        if (known == frames.pictures.end() || known->second == picture) return;
        throw Error(ErrorCode::BadInput, FileLocation{path_.string()},
                    fmt::format("frame {} is now a different picture ({}) from the one written ({}), so later frames "
                                "would not fit; render them again without `continue`, or to other files",
                                frame, picture, known->second));
    };
    check(own_);
    std::ranges::for_each(others_, check);
}

void SequenceRecord::add(uint32_t frame, const std::string& picture) {
    own_.pictures[frame] = picture;
    for (const std::string& output : outputs_) {
        const std::string file = frame_file(output, frame, names_);
        own_.hashes[file] = hash_of_file(file);
    }
    std::string text = fmt::format("{{\n  \"settings\": {},\n  \"files\": [", json_object(settings_));
    const char* comma = "";
    for (const auto& [file, hash] : own_.hashes) {
        text += fmt::format("{}\n    {{\"name\": {}, \"hash\": \"{}\"}}", comma, json_string(file), hash);
        comma = ",";
    }
    text += "\n  ],\n  \"pictures\": [";
    comma = "";
    for (const auto& [number, hash] : own_.pictures) {
        text += fmt::format("{}\n    {{\"frame\": {}, \"hash\": \"{}\"}}", comma, number, hash);
        comma = ",";
    }
    text += "\n  ]\n}\n";
    write_file_atomically(path_, std::as_bytes(std::span(text)));
}

} // namespace pertev
