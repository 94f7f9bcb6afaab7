#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/mesh_reader_formats.h"

namespace phyxel {

/// Parses all of `token` as a number, whatever the locale; a value too small for double becomes 0. False when it is
/// none.
bool parse_number(std::string_view token, double& value);
bool parse_number(std::string_view token, std::int64_t& value);

/// Walks through a text file token by token and line by line, with line numbers for messages. Lines end in LF, CR LF or
/// CR; `#` at the start of a token begins a comment.
class TextScanner {
public:
    explicit TextScanner(const MeshFile& file, std::size_t offset = 0) : file_(&file), text_(file.bytes), at_(offset) {
        for (std::size_t i = 0; i < offset; ++i) line_ += text_[i] == '\n';
    }

    /// A backslash before the line's end joins the next line (OBJ).
    void join_continued_lines() { joins_ = true; }
    void no_comments() { comments_ = false; }

    /// The next token on this line; empty at its end.
    std::string_view token_on_line();
    /// The next token, on this line or a later one; empty at the end of the file.
    std::string_view token();
    /// What is left of this line, without blanks at its ends.
    std::string_view rest_of_line();
    /// Moves to the next line; false when there is none.
    bool next_line();
    /// Moves to the next line that has a token, or stays when this one still has; false when there is none.
    bool find_token();

    /// The next token of this line as a finite number, or an integer; `what` names it in the message otherwise.
    double number_on_line(const char* what) { return to_number(token_on_line(), what); }
    std::int64_t integer_on_line(const char* what) { return to_integer(token_on_line(), what); }
    double to_number(std::string_view token, const char* what) const;
    std::int64_t to_integer(std::string_view token, const char* what) const;

    std::size_t line() const { return line_; }
    std::size_t remaining_bytes() const { return text_.size() - at_; }
    [[noreturn]] void fail(const std::string& message) const;

private:
    bool at_end() const { return at_ >= text_.size(); }
    bool at_newline() const { return text_[at_] == '\n' || text_[at_] == '\r'; }
    void skip_newline();
    void skip_blanks();
    bool at_continuation() const;

    const MeshFile* file_;
    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
    bool joins_ = false, comments_ = true;
};

}  // namespace phyxel
