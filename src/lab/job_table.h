#pragma once

// Tables that the build puts into the program: bench/jobs.json, everything that is measured, and bench/figures.json,
// what other programs reached. Their values know their place in them.

#include <string>
#include <string_view>
#include <utility>

#include "formats/json/json_value.h"
#include "lab/report_page.h"

namespace pertev {

class JobTable {
public:
    /// `name` is jobs.json or figures.json.
    explicit JobTable(std::string name = "jobs.json") : name_(std::move(name)) {}
    JobTable(const JobTable&) = delete; // values point into the table
    JobTable& operator=(const JobTable&) = delete;

    const gltf::JsonValue& root() const { return root_; }

private:
    std::string name_;
    std::string_view text_ = embedded_file(name_);
    simdjson::dom::parser parser_;
    gltf::JsonValue root_{name_, "", parser_.parse(text_.data(), text_.size()).value()};
};

} // namespace pertev
