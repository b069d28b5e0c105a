#pragma once

#include <gtest/gtest.h>

#include <string>

namespace curvecast::server {

/// Whether `line` is one of the text's lines.
inline ::testing::AssertionResult has_line(const std::string& text, const std::string& line) {
  if (("\n" + text).find("\n" + line + "\n") != std::string::npos) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "there is no line \"" << line << "\" in\n" << text;
}

}  // namespace curvecast::server
