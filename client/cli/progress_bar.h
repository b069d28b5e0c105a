// Progress of long work on standard error.
#pragma once

#include <string>
#include <string_view>

namespace curvecast::cli {

enum class ProgressStyle {
  kNone,
  kLines,  // one line per stage
  kBar,    // one line drawn over and over, for terminals
};

/// kBar on a terminal, kLines elsewhere, kNone when quiet.
ProgressStyle progress_style(bool quiet);

/// Not thread-safe.
class ProgressBar {
 public:
  /// `title` stands before every line, such as the mesh's name.
  ProgressBar(ProgressStyle style, std::string title);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ~ProgressBar() { finish(); }

  /// `fraction` of the stage, 0 to 1.
  void update(std::string_view stage, double fraction);
  /// Removes the bar, so that other text can follow.
  void finish();

 private:
  ProgressStyle style_;
  std::string title_;
  std::string stage_;
  int percent_ = -1;
};

}  // namespace curvecast::cli
