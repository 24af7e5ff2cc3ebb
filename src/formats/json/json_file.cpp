#include "formats/json/json_file.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/read_file.h"
#include "formats/json/find_json_fault.h"

namespace pertev {

JsonFile::JsonFile(const std::filesystem::path& path) : name_(path.string()) {
    const std::vector<std::byte> bytes = read_file(path);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
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
