#include "io/mesh_reader_text.h"

#include <charconv>
#include <system_error>

namespace phyxel {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool is_newline(char c) { return c == '\n' || c == '\r'; }

template <class Value>
std::errc parse_all(std::string_view token, Value& value) {
    if (token.starts_with('+')) token.remove_prefix(1);
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc() && end != token.data() + token.size()) return std::errc::invalid_argument;
    return error;
}

}  // namespace

bool parse_number(std::string_view token, double& value) {
    const std::errc error = parse_all(token, value);
    if (error != std::errc::result_out_of_range) return error == std::errc();
    value = token.find("e-") != token.npos || token.find("E-") != token.npos ? 0 : HUGE_VAL;
    return true;
}

bool parse_number(std::string_view token, std::int64_t& value) { return parse_all(token, value) == std::errc(); }

bool TextScanner::at_continuation() const {
    return joins_ && text_[at_] == '\\' && at_ + 1 < text_.size() && is_newline(text_[at_ + 1]);
}

void TextScanner::skip_newline() {
    at_ += text_.substr(at_).starts_with("\r\n") ? 2 : 1;
    ++line_;
}

void TextScanner::skip_blanks() {
    while (!at_end()) {
        if (at_continuation()) {
            ++at_;
            skip_newline();
        } else if (comments_ && text_[at_] == '#') {
            while (!at_end() && !at_newline()) ++at_;
        } else if (is_blank(text_[at_])) {
            ++at_;
        } else {
            return;
        }
    }
}

std::string_view TextScanner::token_on_line() {
    skip_blanks();
    const std::size_t begin = at_;
    while (!at_end() && !at_newline() && !is_blank(text_[at_]) && !at_continuation()) ++at_;
    return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::rest_of_line() {
    while (!at_end() && is_blank(text_[at_])) ++at_;
    const std::size_t begin = at_;
    while (!at_end() && !at_newline()) ++at_;
    std::string_view rest = text_.substr(begin, at_ - begin);
    while (!rest.empty() && is_blank(rest.back())) rest.remove_suffix(1);
    return rest;
}

bool TextScanner::next_line() {
    do {
        if (!at_end() && at_continuation()) skip_blanks();
        while (!at_end() && !at_newline() && !at_continuation()) ++at_;
    } while (!at_end() && at_continuation());
    if (at_end()) return false;
    skip_newline();
    return !at_end();
}

bool TextScanner::find_token() {
    for (;;) {
        skip_blanks();
        if (!at_end() && !at_newline()) return true;
        if (!next_line()) return false;
    }
}

std::string_view TextScanner::token() { return find_token() ? token_on_line() : std::string_view(); }

double TextScanner::to_number(std::string_view token, const char* what) const {
    double value = 0;
    if (token.empty())
        fail(std::string("the line ends where ") + what +
             " should stand: the file is truncated or damaged, export it again");
    if (!parse_number(token, value))
        fail(std::string("expected ") + what + ", a number, but found " + in_quotes(token));
    if (!std::isfinite(value))
        fail(std::string(what) + " is " + in_quotes(token) +
             ", which is not a finite number: mend it in the program that wrote the file");
    return value;
}

std::int64_t TextScanner::to_integer(std::string_view token, const char* what) const {
    std::int64_t value = 0;
    if (token.empty())
        fail(std::string("the line ends where ") + what +
             " should stand: the file is truncated or damaged, export it again");
    if (!parse_number(token, value))
        fail(std::string("expected ") + what + ", a whole number, but found " + in_quotes(token));
    return value;
}

void TextScanner::fail(const std::string& message) const { file_->fail("line " + std::to_string(line_), message); }

}  // namespace phyxel
