// Reads words and numbers out of a text in memory, without copies, and knows the line it is at.
#pragma once

#include <absl/status/status.h>
#include <absl/strings/charconv.h>

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

namespace curvecast {

/// Lines end in LF, CR LF or CR. The text must outlive the scanner.
class TextScanner {
 public:
  /// `line` is the number of the first line of `text`.
  explicit TextScanner(std::string_view text, std::size_t line = 1)
      : begin_(text.data()), p_(begin_), end_(begin_ + text.size()), line_(line) {}

  bool at_end() const { return p_ == end_; }
  std::size_t offset() const { return static_cast<std::size_t>(p_ - begin_); }
  std::size_t remaining() const { return static_cast<std::size_t>(end_ - p_); }
  std::size_t line() const { return line_; }
  /// Returns the next character, or 0 at the end.
  char peek() const { return p_ == end_ ? '\0' : *p_; }
  void skip_char() { ++p_; }

  void skip_blanks() {
    while (p_ != end_ && is_blank(*p_)) ++p_;
  }
  /// Blanks and line ends.
  void skip_space() {
    for (; p_ != end_; ++p_) {
      if (is_line_end(*p_)) {
        count_line_end();
      } else if (!is_blank(*p_)) {
        return;
      }
    }
  }
  /// Blanks, line ends, and comments from `mark` to the end of their line.
  void skip_space_and_comments(char mark) {
    skip_space();
    while (p_ != end_ && *p_ == mark) {
      next_line();
      skip_space();
    }
  }
  bool at_line_end() const { return p_ == end_ || is_line_end(*p_); }
  /// To the beginning of the next line, or to the end.
  void next_line() {
    while (p_ != end_ && !is_line_end(*p_)) ++p_;
    if (p_ == end_) return;
    count_line_end();
    ++p_;
  }
  /// Moves to the end of the line and returns everything up to there.
  std::string_view line_rest() {
    const char* const start = p_;
    while (p_ != end_ && !is_line_end(*p_)) ++p_;
    return {start, static_cast<std::size_t>(p_ - start)};
  }
  /// Moves to the next `a` or `b`, or to the end of the line.
  void skip_until(char a, char b) {
    while (p_ != end_ && *p_ != a && *p_ != b && !is_line_end(*p_)) ++p_;
  }
  /// Over a backslash at the end of a line and the line end behind it; false when no such thing stands here.
  bool skip_continuation() {
    if (p_ == end_ || *p_ != '\\' || p_ + 1 == end_ || !is_line_end(p_[1])) return false;
    next_line();
    return true;
  }

  /// Returns the characters up to the next space; empty at a space or at the end.
  std::string_view word() {
    const char* const start = p_;
    skip_word();
    return {start, static_cast<std::size_t>(p_ - start)};
  }
  void skip_word() {
    while (p_ != end_ && !is_blank(*p_) && !is_line_end(*p_)) ++p_;
  }
  std::string_view peek_word() const { return TextScanner(*this).word(); }

  /// Takes the number that begins here. Returns false, without moving, when none does. The value may be infinite or NaN; numbers
  /// beyond a double's range become infinite or zero.
  bool number(double& value) {
    const char* const start = after_plus();
    auto [next, error] = std::from_chars(start, end_, value);
    if (error == std::errc::result_out_of_range) {  // leaves no value; Abseil tells too large (the largest double) from too small
      absl::from_chars(start, next, value);
      if (std::abs(value) > 1) value = std::copysign(HUGE_VAL, value);
    }
    return finish(next, error != std::errc::invalid_argument);
  }
  /// Takes the integer that begins here, as number() does. Those beyond 64 bits are refused.
  bool integer(std::int64_t& value) {
    const auto [next, error] = std::from_chars(after_plus(), end_, value);
    return finish(next, error == std::errc());
  }

  /// InvalidArgument "line 12: `message`".
  absl::Status error(std::string_view message) const;
  /// InvalidArgument "line 12: expected `what`, found 'abc'".
  absl::Status expected(std::string_view what) const;

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }

  // At a line end; moves to the last character of a CR LF.
  void count_line_end() {
    ++line_;
    if (*p_ == '\r' && p_ + 1 != end_ && p_[1] == '\n') ++p_;
  }
  const char* after_plus() const { return p_ != end_ && *p_ == '+' && p_ + 1 != end_ && p_[1] != '-' ? p_ + 1 : p_; }
  // A slash and a backslash may follow a number at once (OBJ); anything else makes it some other word.
  bool finish(const char* next, bool parsed) {
    if (!parsed || (next != end_ && !is_blank(*next) && !is_line_end(*next) && *next != '/' && *next != '\\')) return false;
    p_ = next;
    return true;
  }

  const char* begin_;
  const char* p_;
  const char* end_;
  std::size_t line_;
};

/// Makes a word fit to stand in a message: its first characters, the unprintable ones escaped.
std::string printable(std::string_view word);

/// Tells whether two words are the same but for the case of ASCII letters.
bool equals_ignoring_case(std::string_view a, std::string_view b);

}  // namespace curvecast
