#include "formats/json/json_file.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "formats/json/find_json_fault.h"

namespace pertev {
namespace {

/// Returns the bytes as text. The view is valid as long as the bytes.
std::string_view as_text(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

} // namespace

JsonFile::JsonFile(const std::filesystem::path& path) : JsonFile(path.string(), as_text(read_file(path))) {}

JsonFile::JsonFile(std::string name, std::string_view text) : name_(std::move(name)) {
    simdjson::dom::element element;
    if (!parser_.parse(simdjson::padded_string(text)).get(element)) {
        root_.emplace(name_, "", element);
        return;
    }
    const std::string mended = gltf::repair_json(text, gltf::RepairJson::Numbers);
    if (const simdjson::error_code failure = parser_.parse(mended).get(element)) {
        std::string what = simdjson::error_message(failure);
        if (const auto fault = gltf::find_json_fault(text, gltf::RepairJson::Numbers)) {
            what = fmt::format("{}: expected {}", gltf::line_and_column(text, fault->byte), fault->expected);
        }
        throw Error(ErrorCode::BadInput, FileLocation{name_}, fmt::format("not valid JSON: {}", what));
    }
    root_.emplace(name_, "", element);
}

} // namespace pertev
