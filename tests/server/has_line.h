#pragma once

#include <gtest/gtest.h>

#include <string>

namespace curvecast::server {

/// Whether `line` is one of the text's lines.
inline ::testing::AssertionResult has_line(const std::string& text, const std::string& line) {
  if (("\n" + text).find("\n" + line + "\n") != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "there is no line \"" << line << "\" in\n" << text;
}

/// What a text of metrics says of one that has no labels; 0 where the text does not name it.
inline double value_of(const std::string& text, const std::string& metric) {
  const std::string begin = "\n" + metric + " ";
  const std::size_t at = ("\n" + text).find(begin);
  return at == std::string::npos ? 0 : std::stod(("\n" + text).substr(at + begin.size()));
}

}  // namespace curvecast::server
