#pragma once

// Splits the text of a pbrt file into tokens: words (directives, numbers, true and false), quoted texts, and brackets.
// A # begins a comment that ends with its line.

#include <cstddef>
#include <string>
#include <string_view>

namespace pertev::pbrt {

enum class TokenKind { Word, Quoted, Open, Close, End };

struct Token {
    TokenKind kind = TokenKind::End;
    std::string_view text; // without the quotes; escapes as in the file
    std::size_t line = 1;
    bool is_open_ended = false; // a quoted text without its closing quote, which ends with its line

    bool is_word(std::string_view word) const { return kind == TokenKind::Word && text == word; }
};

class Tokens {
public:
    /// `text` must outlive this object.
    explicit Tokens(std::string_view text) : text_(text) {}

    /// Returns the next token without removing it.
    const Token& peek() {
        if (!has_next_) next_ = read();
        has_next_ = true;
        return next_;
    }
    Token next() {
        const Token token = peek();
        has_next_ = false;
        return token;
    }

private:
    Token read();

    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
    Token next_;
    bool has_next_ = false;
};

/// Returns a quoted text with \" and \\ as one character. Other backslashes stay, because paths of Windows have them.
std::string unescaped(std::string_view quoted);

} // namespace pertev::pbrt
