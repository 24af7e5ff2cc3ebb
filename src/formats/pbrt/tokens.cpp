#include "formats/pbrt/tokens.h"

namespace pertev::pbrt {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }
bool ends_word(char c) { return is_blank(c) || c == '"' || c == '[' || c == ']' || c == '#'; }

} // namespace

Token Tokens::read() {
    const std::size_t size = text_.size();
    while (at_ < size && (is_blank(text_[at_]) || text_[at_] == '#')) {
        if (text_[at_] == '#') {
            at_ = std::min(text_.find('\n', at_), size);
            continue;
        }
        line_ += text_[at_] == '\n';
        ++at_;
    }
    Token token{.kind = TokenKind::End, .text = {}, .line = line_};
    if (at_ >= size) return token;
    const std::size_t begin = at_;
    const char c = text_[begin];
    if (c == '[' || c == ']') {
        token.kind = c == '[' ? TokenKind::Open : TokenKind::Close;
        token.text = text_.substr(at_++, 1);
    } else if (c == '"') {
        token.kind = TokenKind::Quoted;
        ++at_;
        while (at_ < size && text_[at_] != '"' && text_[at_] != '\n')
            at_ += text_[at_] == '\\' && at_ + 1 < size && text_[at_ + 1] != '\n' ? 2 : 1;
        token.text = text_.substr(begin + 1, at_ - begin - 1);
        token.is_open_ended = at_ >= size || text_[at_] != '"';
        if (!token.is_open_ended) ++at_;
    } else {
        token.kind = TokenKind::Word;
        while (at_ < size && !ends_word(text_[at_])) ++at_;
        token.text = text_.substr(begin, at_ - begin);
    }
    return token;
}

std::string unescaped(std::string_view quoted) {
    std::string text;
    text.reserve(quoted.size());
    for (std::size_t i = 0; i < quoted.size(); ++i) {
        const bool is_escape =
            quoted[i] == '\\' && i + 1 < quoted.size() && (quoted[i + 1] == '"' || quoted[i + 1] == '\\');
        text += quoted[is_escape ? ++i : i];
    }
    return text;
}

} // namespace pertev::pbrt
