// Lines over logarithmic axes, as SVG.
#pragma once

#include <string>
#include <vector>

namespace curvecast::cli::bench {

struct PlotLine {
  std::string name;
  std::vector<double> x, y;  // as many of both, above 0
  std::string colour;        // as CSS has it
  bool is_dashed = false;    // else with a dot at every place
};

/// Returns an <svg> element to stand in a page, with a legend. `title` and names may hold any text. Precondition: there is a line
/// with two different places.
std::string log_plot(const std::string& title, const std::string& x_label, const std::string& y_label,
                     const std::vector<PlotLine>& lines);

/// The text for HTML and SVG: characters that mean something there escaped.
std::string escaped(const std::string& text);

}  // namespace curvecast::cli::bench
