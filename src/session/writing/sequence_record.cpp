#include "session/writing/sequence_record.h"

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
                               std::vector<std::string> names)
    : outputs_(std::move(outputs)), names_(std::move(names)), settings_(std::move(settings)),
      path_(std::filesystem::path(outputs_.front()).replace_extension(".json")) {
    for (auto& [name, value] : settings_) value = utf8_text(value);
}

bool SequenceRecord::load() {
    if (std::error_code fault; !std::filesystem::exists(path_, fault)) return false;
    const JsonFile file(path_);
    const gltf::JsonValue settings = file.root().at("settings");
    DecidingSettings before;
    for (const auto& [name, value] : settings.members()) before.emplace_back(name, value.to_string());
    if (const auto different = first_difference(before, settings_)) {
        Remark why(settings.location(), fmt::format("the existing frames were made with {} \"{}\", not \"{}\"; "
                                                    "render them again without `continue`, or to other files",
                                                    different->name, different->before, different->after));
        why.setting = "continue";
        throw Error(ErrorCode::BadInput, std::move(why));
    }
    for (const gltf::JsonValue& frame : file.root().elements_of("files")) {
        hashes_[std::string(frame.at("name").to_string())] = frame.at("hash").to_string();
    }
    for (const gltf::JsonValue& frame : file.root().elements_of("pictures")) {
        pictures_[static_cast<uint32_t>(frame.at("frame").to_unsigned())] = frame.at("hash").to_string();
    }
    return true;
}

bool SequenceRecord::has(uint32_t frame) const {
    for (const std::string& output : outputs_) {
        const std::filesystem::path file = frame_file(output, frame, names_);
        const auto known = hashes_.find(file.string());
        std::error_code fault;
        if (known == hashes_.end() || !std::filesystem::is_regular_file(file, fault)) return false;
        if (hash_of_file(file) != known->second) return false;
    }
    return true;
}

void SequenceRecord::check_picture(uint32_t frame, const std::string& picture) const {
    const auto known = pictures_.find(frame);
    if (known == pictures_.end() || known->second == picture) return;
    throw Error(ErrorCode::BadInput, FileLocation{path_.string()},
                fmt::format("frame {} is now a different picture ({}) from the one written ({}), so later frames "
                            "would not fit; render them again without `continue`, or to other files",
                            frame, picture, known->second));
}

void SequenceRecord::add(uint32_t frame, const std::string& picture) {
    pictures_[frame] = picture;
    for (const std::string& output : outputs_) {
        const std::string file = frame_file(output, frame, names_);
        hashes_[file] = hash_of_file(file);
    }
    std::string text = fmt::format("{{\n  \"settings\": {},\n  \"files\": [", json_object(settings_));
    const char* comma = "";
    for (const auto& [file, hash] : hashes_) {
        text += fmt::format("{}\n    {{\"name\": {}, \"hash\": \"{}\"}}", comma, json_string(file), hash);
        comma = ",";
    }
    text += "\n  ],\n  \"pictures\": [";
    comma = "";
    for (const auto& [number, hash] : pictures_) {
        text += fmt::format("{}\n    {{\"frame\": {}, \"hash\": \"{}\"}}", comma, number, hash);
        comma = ",";
    }
    text += "\n  ]\n}\n";
    write_file_atomically(path_, std::as_bytes(std::span(text)));
}

} // namespace pertev
