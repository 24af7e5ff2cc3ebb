#pragma once

// A JSON file of the program's own (lab/report_page.h), whose values know their place in it.

#include <string>
#include <string_view>

#include "formats/json/json_value.h"
#include "lab/report_page.h"

namespace pertev {

class EmbeddedJson {
public:
    explicit EmbeddedJson(std::string name)
        : name_(std::move(name)), text_(embedded_file(name_)),
          root_(name_, "", parser_.parse(text_.data(), text_.size()).value()) {}
    EmbeddedJson(const EmbeddedJson&) = delete; // its values point into it
    EmbeddedJson& operator=(const EmbeddedJson&) = delete;

    const gltf::JsonValue& root() const { return root_; }

private:
    std::string name_;
    std::string_view text_;
    simdjson::dom::parser parser_;
    gltf::JsonValue root_;
};

} // namespace pertev
