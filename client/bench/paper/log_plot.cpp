#include "client/bench/paper/log_plot.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace curvecast::cli::bench {
namespace {

constexpr double kWidth = 560, kHeight = 420, kLeft = 62, kRight = 12, kTop = 30, kBottom = 46;  // pixels

/// Powers of ten from the one below all values to the one above.
struct Axis {
  int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();

  void take(const std::vector<double>& values) {
    for (const double value : values) {
      low = std::min(low, static_cast<int>(std::floor(std::log10(value) + 1e-9)));
      high = std::max(high, static_cast<int>(std::ceil(std::log10(value) - 1e-9)));
    }
  }
  /// Where a value lies, 0 .. 1.
  double at(double value) const { return (std::log10(value) - low) / std::max(1, high - low); }
};

double to_x(const Axis& axis, double value) { return kLeft + axis.at(value) * (kWidth - kLeft - kRight); }
double to_y(const Axis& axis, double value) { return kHeight - kBottom - axis.at(value) * (kHeight - kTop - kBottom); }

void add_text(std::string& svg, double x, double y, const char* anchor, const std::string& text) {
  absl::StrAppendFormat(&svg, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n", x, y, anchor, text);
}

void add_axes(std::string& svg, const Axis& x, const Axis& y) {
  for (int power = x.low; power <= x.high; ++power) {
    const double at = to_x(x, std::pow(10, power));
    absl::StrAppendFormat(&svg, "<path class=\"grid\" d=\"M%.1f %.1fV%.1f\"/>\n", at, kTop, kHeight - kBottom);
    add_text(svg, at, kHeight - kBottom + 16, "middle", absl::StrFormat("10<tspan dy=\"-5\" font-size=\"9\">%d</tspan>", power));
  }
  for (int power = y.low; power <= y.high; ++power) {
    const double at = to_y(y, std::pow(10, power));
    absl::StrAppendFormat(&svg, "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/>\n", kLeft, at, kWidth - kRight);
    add_text(svg, kLeft - 6, at + 4, "end", absl::StrFormat("10<tspan dy=\"-5\" font-size=\"9\">%d</tspan>", power));
  }
}

void add_line(std::string& svg, const Axis& x, const Axis& y, const PlotLine& line) {
  std::string path, dots;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    const double px = to_x(x, line.x[i]), py = to_y(y, line.y[i]);
    absl::StrAppendFormat(&path, "%c%.1f %.1f", i == 0 ? 'M' : 'L', px, py);
    if (!line.is_dashed)
      absl::StrAppendFormat(&dots, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2\" fill=\"%s\"/>", px, py, line.colour);
  }
  absl::StrAppendFormat(&svg, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.4\"%s d=\"%s\"/>%s\n", line.colour,
                        line.is_dashed ? " stroke-dasharray=\"6 4\"" : "", path, dots);
}

}  // namespace

std::string escaped(const std::string& text) {
  return absl::StrReplaceAll(text, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

std::string log_plot(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotLine>& lines) {
  Axis x, y;
  for (const PlotLine& line : lines) {
    x.take(line.x);
    y.take(line.y);
  }
  std::string svg = absl::StrFormat("<svg viewBox=\"0 0 %.0f %.0f\" class=\"plot\">\n", kWidth, kHeight);
  add_text(svg, 0.5 * (kLeft + kWidth - kRight), 18, "middle", escaped(title));
  add_text(svg, 0.5 * (kLeft + kWidth - kRight), kHeight - 10, "middle", escaped(x_label));
  absl::StrAppendFormat(&svg, "<text transform=\"translate(14 %.1f) rotate(-90)\" text-anchor=\"middle\">%s</text>\n",
                        0.5 * (kTop + kHeight - kBottom), escaped(y_label));
  add_axes(svg, x, y);
  for (const PlotLine& line : lines) add_line(svg, x, y, line);
  // Discrepancies fall: the lower left corner is free.
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double at = kHeight - kBottom - 12 - 16 * static_cast<double>(lines.size() - 1 - i);
    absl::StrAppendFormat(&svg, "<path stroke=\"%s\" stroke-width=\"2\"%s d=\"M%.1f %.1fh22\"/>", lines[i].colour,
                          lines[i].is_dashed ? " stroke-dasharray=\"6 4\"" : "", kLeft + 8, at - 4);
    add_text(svg, kLeft + 36, at, "start", escaped(lines[i].name));
  }
  return svg + "</svg>\n";
}

}  // namespace curvecast::cli::bench
