#pragma once

// The table of everything that is measured, bench/jobs.json, which the build puts into the program. Its values know
// their place in it.

#include <string>
#include <string_view>

#include "formats/json/json_value.h"
#include "lab/report_page.h"

namespace pertev {

class JobTable {
public:
    JobTable() = default;
    JobTable(const JobTable&) = delete; // its values point into it
    JobTable& operator=(const JobTable&) = delete;

    const gltf::JsonValue& root() const { return root_; }

private:
    std::string name_ = "jobs.json";
    std::string_view text_ = embedded_file(name_);
    simdjson::dom::parser parser_;
    gltf::JsonValue root_{name_, "", parser_.parse(text_.data(), text_.size()).value()};
};

} // namespace pertev
