#include "formats/json/find_json_fault.h"

#include <algorithm>

#include <fmt/format.h>
#include <simdjson.h>

namespace pertev::gltf {
namespace {

class Scanner {
public:
    Scanner(std::string_view text, RepairJson repair) : text_(text), repair_(repair) {}

    std::optional<JsonFault> run() {
        for (;;) {
            if (!(may_close_ && accept(closing()))) {
                if (is_in_object() && !(name() && colon())) return fault_;
                if (accept('{') || accept('[')) {
                    open_ += text_[at_ - 1];
                    may_close_ = true;
                    continue;
                }
                if (!token("a value")) return fault_;
            } else {
                open_.pop_back();
            }
            if (!next()) return fault_;
            may_close_ = false;
        }
    }

private:
    bool is_in_object() const { return !open_.empty() && open_.back() == '{'; }
    char closing() const { return open_.back() == '{' ? '}' : ']'; }

    bool fail(std::string expected) {
        fault_ = {at_, std::move(expected)};
        return false;
    }

    void skip_space() { at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size()); }

    bool accept(char c) {
        skip_space();
        if (at_ == text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }

    /// Closes the arrays and objects that end after a value. Returns true at a comma before another value, and false at
    /// a fault and at the end of the text.
    bool next() {
        while (!open_.empty()) {
            if (accept(',')) return true;
            if (!accept(closing())) return fail(fmt::format("a comma or {}", closing()));
            open_.pop_back();
        }
        skip_space();
        return at_ < text_.size() && fail("nothing after the end of the document");
    }

    bool name() {
        skip_space();
        if (at_ < text_.size() && text_[at_] == '"') return token("a name");
        return fail(may_close_ ? "a name in quotes or }" : "a name in quotes");
    }
    bool colon() { return accept(':') || fail("a colon after the name"); }

    /// Accepts a string, number or word.
    bool token(const char* expected) {
        skip_space();
        const std::string_view rest = text_.substr(at_);
        std::size_t size = std::min(rest.find_first_of(" \t\r\n,:[]{}\""), rest.size());
        if (rest.starts_with('"')) {
            std::size_t end = 1;
            while (end < rest.size() && rest[end] != '"') end += rest[end] == '\\' ? 2 : 1;
            if (end >= rest.size()) return fail("a quotation mark that ends this string");
            size = end + 1;
        }
        if (size == 0) return fail(expected);
        if (const simdjson::error_code failure = parser_.parse(repair_json(rest.substr(0, size), repair_)).error()) {
            return fail(fmt::format("{} ({})", expected, simdjson::error_message(failure)));
        }
        at_ += size;
        return true;
    }

    std::string_view text_;
    RepairJson repair_;
    std::size_t at_ = 0;
    std::string open_;       // the brackets that are not closed yet
    bool may_close_ = false; // true if nothing follows the last of them yet
    std::optional<JsonFault> fault_;
    simdjson::dom::parser parser_;
};

} // namespace

std::optional<JsonFault> find_json_fault(std::string_view text, RepairJson repair) {
    return Scanner(text, repair).run();
}

std::string line_and_column(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, byte);
    const std::string_view line = before.substr(before.rfind('\n') + 1); // npos + 1 is 0
    const auto is_character = [](char c) {
        return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u;
    }; // counts characters of UTF-8
    return fmt::format("line {}, column {}", 1 + std::count(before.begin(), before.end(), '\n'),
                       1 + std::count_if(line.begin(), line.end(), is_character));
}

} // namespace pertev::gltf
