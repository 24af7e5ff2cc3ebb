#include "formats/json/repair_json.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/json_text.h"

namespace pertev::gltf {
namespace {

constexpr std::string_view kLargest = "1.7976931348623157e308";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Returns whether `text` is a number by RFC 8259, and sets `is_whole` to whether it has neither a fraction nor an
/// exponent.
bool is_number(std::string_view text, bool& is_whole) {
    std::size_t at = 0;
    const auto accept = [&](std::string_view any) {
        const bool is_there = at < text.size() && any.find(text[at]) != any.npos;
        at += is_there ? 1 : 0;
        return is_there;
    };
    const auto digits = [&] {
        const std::size_t begin = at;
        while (at < text.size() && is_digit(text[at])) ++at;
        return at > begin;
    };
    accept("-");
    if (!accept("0") && !digits()) return false;
    const std::size_t whole = at;
    if (accept(".") && !digits()) return false;
    if (accept("eE")) {
        accept("+-");
        if (!digits()) return false;
    }
    is_whole = at == whole;
    return at == text.size();
}

std::string mended_number(std::string_view text) {
    bool is_whole = false;
    if (!is_number(text, is_whole)) return std::string(text);
    const std::string number(text);
    const double value = std::strtod(number.c_str(), nullptr);
    if (std::isinf(value)) return (value < 0 ? "-" : "") + std::string(kLargest);
    constexpr std::size_t kSurelyIn64Bits = 18; // digits
    return is_whole && text.size() > kSurelyIn64Bits ? number + ".0" : number;
}

/// Returns JSON in place of an infinity or a NaN in the spelling of a programming language; empty for any other word.
std::string mended_infinity(std::string_view word) {
    std::string small;
    for (const char c : word) small += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    std::string_view rest = small;
    const bool is_negative = rest.starts_with('-');
    if (is_negative || rest.starts_with('+')) rest.remove_prefix(1);
    if (rest.starts_with("nan") || rest.starts_with("1.#ind") || rest.starts_with("1.#qnan")) return "null";
    if (rest == "inf" || rest == "infinity" || rest.starts_with("1.#inf")) {
        return (is_negative ? "-" : "") + std::string(kLargest);
    }
    return "";
}

/// Returns the code unit of the escape (backslash, u, four digits) at `at`, or -1 if there is none.
int code_unit(std::string_view text, std::size_t at) {
    if (at + 6 > text.size() || text[at] != '\\' || text[at + 1] != 'u') return -1;
    int unit = 0;
    for (std::size_t i = at + 2; i < at + 6; ++i) {
        const char c = text[i];
        const int digit = is_digit(c)            ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (digit < 0) return -1;
        unit = 16 * unit + digit;
    }
    return unit;
}

class Repairer {
public:
    Repairer(std::string_view text, RepairJson repair) : text_(text), all_(repair == RepairJson::All) {}

    std::string run() {
        constexpr std::string_view ends = " \t\r\n,:[]{}\"";
        while (at_ < text_.size()) {
            if (text_[at_] == '"') {
                string();
            } else if (ends.find(text_[at_]) != ends.npos) {
                out_ += text_[at_++];
            } else {
                const std::size_t end = std::min(text_.find_first_of(ends, at_), text_.size());
                word(text_.substr(at_, end - at_));
                at_ = end;
            }
        }
        return std::move(out_);
    }
    bool had_infinity() const { return had_infinity_; }
    bool had_odd_string() const { return had_odd_string_; }

private:
    void word(std::string_view word) {
        const std::string infinity = all_ ? mended_infinity(word) : "";
        had_infinity_ = had_infinity_ || !infinity.empty();
        out_ += infinity.empty() ? mended_number(word) : infinity;
    }

    void string() {
        out_ += text_[at_++];
        while (at_ < text_.size()) {
            const char c = text_[at_];
            if (c == '\\') {
                escape();
            } else {
                const bool is_tab = all_ && c == '\t';
                if (is_tab) {
                    out_ += "\\t";
                } else {
                    out_ += c;
                }
                had_odd_string_ = had_odd_string_ || is_tab;
                ++at_;
                if (c == '"') return;
            }
        }
    }

    void escape() {
        const auto is_between = [](int unit, int first, int last) { return unit >= first && unit <= last; };
        const int unit = code_unit(text_, at_);
        std::size_t size = std::min<std::size_t>(unit < 0 ? 2 : 6, text_.size() - at_);
        const bool is_first = is_between(unit, 0xd800, 0xdbff);
        const bool is_pair = is_first && is_between(code_unit(text_, at_ + 6), 0xdc00, 0xdfff);
        if (is_pair) size = 12;
        const bool is_half = all_ && !is_pair && is_between(unit, 0xd800, 0xdfff);
        had_odd_string_ = had_odd_string_ || is_half;
        out_ += is_half ? "\\ufffd" : text_.substr(at_, size);
        at_ += size;
    }

    std::string_view text_;
    bool all_;
    std::size_t at_ = 0;
    std::string out_;
    bool had_infinity_ = false, had_odd_string_ = false;
};

} // namespace

std::string repair_json(std::string_view text, RepairJson repair, std::vector<std::string>* repairs) {
    const std::string valid = repair == RepairJson::All ? utf8_text(text) : std::string(text);
    Repairer repairer(valid, repair);
    std::string mended = repairer.run();
    if (repairs != nullptr) {
        if (repairer.had_infinity())
            repairs->emplace_back("NaN is not valid JSON and read as null, and Infinity as the largest number");
        if (repairer.had_odd_string() || valid != text) {
            repairs->emplace_back("a string is not valid Unicode; invalid bytes are read as U+FFFD");
        }
    }
    return mended;
}

} // namespace pertev::gltf
