#include "client/cli/progress_bar.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace curvecast::cli {
namespace {

constexpr int kWidth = 30;  // characters of the bar itself

}  // namespace

ProgressStyle progress_style(bool quiet) {
  if (quiet) return ProgressStyle::kNone;
  return isatty(STDERR_FILENO) != 0 ? ProgressStyle::kBar : ProgressStyle::kLines;
}

ProgressBar::ProgressBar(ProgressStyle style, std::string title) : style_(style), title_(std::move(title)) {}

void ProgressBar::update(std::string_view stage, double fraction) {
  const int percent = std::isfinite(fraction) ? static_cast<int>(100 * std::clamp(fraction, 0.0, 1.0)) : 0;
  const bool new_stage = stage != stage_;
  if (style_ == ProgressStyle::kNone || (!new_stage && (percent == percent_ || style_ == ProgressStyle::kLines))) return;
  stage_ = stage;
  percent_ = percent;
  if (style_ == ProgressStyle::kLines) {
    std::fprintf(stderr, "%s: %s\n", title_.c_str(), stage_.c_str());
    return;
  }
  const int filled = kWidth * percent / 100;
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %3d %% %s", title_.c_str(), bar.c_str(), percent, stage_.c_str());
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (style_ == ProgressStyle::kBar && percent_ >= 0) {
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
  }
  stage_.clear();
  percent_ = -1;
}

}  // namespace curvecast::cli
