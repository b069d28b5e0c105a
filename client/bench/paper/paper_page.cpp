#include "client/bench/paper/paper_page.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "client/bench/paper/log_plot.h"

namespace curvecast::cli::bench {
namespace {

constexpr char kHead[] = R"(<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>Curvecast beside the paper</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; color: #1d2330; max-width: 1240px; margin: 2em auto; padding: 0 1em; }
table { border-collapse: collapse; margin: 1em 0; font-size: 13px; }
th, td { border-bottom: 1px solid #d4d9e2; padding: .25em .6em; text-align: right; white-space: nowrap; }
th { font-weight: 600; }
th:first-child, td:first-child, th.text, td.text { text-align: left; }
.paper td { color: #6b7386; }
.no { color: #b3261e; font-weight: 600; }
.row { display: flex; flex-wrap: wrap; gap: 1em; }
figure { margin: 0; width: 350px; }
figure img { width: 100%; border: 1px solid #d4d9e2; }
figcaption, .note { font-size: 13px; color: #4a5264; }
.plot { width: 570px; font-size: 12px; fill: #1d2330; }
.plot .grid { stroke: #e3e7ee; }
</style>
</head>
<body>
)";

struct Section {
  std::vector<std::string> figures;
  const char* title;
};
const std::vector<Section>& sections() {
  static const std::vector<Section> kSections = {
      {{"1"}, "uniform and adaptive Hilbert curve"},
      {{"2"}, "the mesh, parameterised, the curve in the square and on the surface, uniform samples, splats"},
      {{"3", "4"}, "uniform, by curvature, rendered (the paper's 3 is Igea, its 4 the Lion)"},
      {{"5"}, "discrepancy over rings of triangles"},
      {{"6"}, "discs of one size in the square"},
      {{"7"}, "localised level of detail"},
      {{"8"}, "silhouettes of a sphere, for a camera that stays where it is"},
      {{"9"}, "uniform and curvature-controlled remesh"}};
  return kSections;
}

std::string row(const std::vector<std::string>& cells, const char* open = "<tr>", const char* tag = "td") {
  std::string text = open;
  for (const std::string& cell : cells) absl::StrAppend(&text, "<", tag, ">", cell, "</", tag, ">");
  return text + "</tr>\n";
}
std::string heading(const std::vector<std::string>& cells) { return row(cells, "<tr>", "th"); }
std::string paper_row(const std::vector<std::string>& cells) { return row(cells, "<tr class=\"paper\">"); }

/// Seconds, and how many times as fast that is.
std::string seconds_cell(double ours, double paper) {
  if (!(paper > 0)) return absl::StrFormat("%.3g", ours);
  return absl::StrFormat("%.3g (&times;%.3g)", ours, paper / std::max(ours, 1e-9));
}

void add_claims(const PaperFindings& findings, std::string& page) {
  const std::vector<Claim> claims = claims_of(findings);
  const auto held = std::count_if(claims.begin(), claims.end(), [](const Claim& claim) { return claim.holds; });
  absl::StrAppendFormat(&page, "<h2>What has to hold: %d of %d do</h2>\n<table>\n", held, claims.size());
  page += heading({"", "ours", "paper", ""});
  for (const Claim& claim : claims) {
    page += row({escaped(claim.text), absl::StrFormat("%.3g", claim.ours), absl::StrFormat("%.4g", claim.paper),
                 claim.holds ? "yes" : "<span class=\"no\">no</span>"});
  }
  page += "</table>\n";
}

void add_table_1(const PaperFindings& findings, std::string& page) {
  page += "<h2>Table 1: seconds of the stages</h2>\n<table>\n";
  page += heading({"", "faces", "vertices", "t<sub>p</sub> parametrisation", "t<sub>c</sub> curve", "t<sub>m</sub> map",
                   "t<sub>s</sub> sample", "t total"});
  for (const MeshFindings& mesh : findings.meshes) {
    StageTimes paper;
    if (mesh.paper != nullptr) {
      paper = mesh.paper->seconds;
      std::vector<std::string> cells = {absl::StrCat(mesh.paper->name, ": paper"), absl::StrCat(mesh.paper->faces),
                                        absl::StrCat(mesh.paper->vertices)};
      for (const TableStage& stage : kTableStages) cells.push_back(absl::StrFormat("%.4g", paper.*stage.seconds));
      page += paper_row(cells);
    }
    for (const Way way : kWays) {
      std::vector<std::string> cells = {absl::StrCat(escaped(mesh.file), ": ours, ", kWayNames[way]), absl::StrCat(mesh.faces),
                                        absl::StrCat(mesh.vertices)};
      for (const TableStage& stage : kTableStages) {
        cells.push_back(seconds_cell(mesh.seconds[way].*stage.seconds, paper.*stage.seconds));
      }
      page += row(cells);
    }
  }
  absl::StrAppendFormat(&page,
                        "</table>\n<p class=\"note\">For %d points, the fastest of several runs. In brackets: how many times as "
                        "fast as the paper's "
                        "Pentium 4 with 3 GHz. Parametrisation counts cutting, the curve its area elements, our total reading "
                        "and repairing the file too.</p>\n",
                        findings.table_points);
}

/// What a way of remeshing has for a percentage; nothing where it was not measured.
std::string error_cell(const MeshFindings& mesh, const std::string& way, int percent) {
  for (const RemeshError& error : mesh.remeshes) {
    if (error.way == way && error.percent == percent) {
      return absl::StrFormat("%.2g / %.2g / %.2g", error.mean, error.rms, error.max);
    }
  }
  return "";
}
std::string error_cell(const PaperMesh& paper, int percent) {
  for (const PaperError& error : paper.errors) {
    if (error.percent == percent) return absl::StrFormat("%.4g", error.error);
  }
  return "";
}

/// All of which there is a gradient, or remeshed surfaces.
std::vector<std::string> ways_of(const MeshFindings& mesh) {
  std::vector<std::string> ways;
  const auto add = [&](const std::string& way) {
    if (std::ranges::find(ways, way) == ways.end()) ways.push_back(way);
  };
  for (const RingLine& line : mesh.rings) add(line.name);
  for (const RemeshError& error : mesh.remeshes) add(error.way);
  return ways;
}

void add_table_2(const PaperFindings& findings, std::string& page) {
  constexpr std::array<int, 4> kPercentages = {105, 75, 50, 25};
  page += "<h2>Table 2: gradients of the discrepancy, and Hausdorff distances of remeshed surfaces</h2>\n<table>\n";
  page += heading({"", "gradient, RMS", "gradient, maximum", "105 %", "75 %", "50 %", "25 %"});
  const auto errors = [&](auto&& cell, std::vector<std::string> cells) {
    for (const int percent : kPercentages) cells.push_back(cell(percent));
    return cells;
  };
  for (const MeshFindings& mesh : findings.meshes) {
    if (mesh.paper != nullptr) {
      page += paper_row(errors([&](int percent) { return error_cell(*mesh.paper, percent); },
                               {absl::StrCat(mesh.paper->name, ": paper"), absl::StrFormat("%.2f", mesh.paper->gradient), ""}));
    }
    for (const std::string& way : ways_of(mesh)) {
      const auto line = std::ranges::find(mesh.rings, way, &RingLine::name);
      const auto gradient = [&](double RingTest::*value) {
        return line != mesh.rings.end() ? absl::StrFormat("%.3f", line->test.*value) : "";
      };
      page += row(errors(
          [&](int percent) { return error_cell(mesh, way, percent); },
          {absl::StrCat(escaped(mesh.file), ": ", way), gradient(&RingTest::rms_gradient), gradient(&RingTest::max_gradient)}));
    }
  }
  page +=
      "</table>\n<p class=\"note\">Distances are in % of the diagonal of the original's box: mean / RMS / maximum, of both "
      "directions the larger; the paper does not say which of them it has. Percentages are of the original's triangles. "
      "Literal: vertices strictly by |Gaussian curvature|, jittered, triangulated in the parameter square; nothing where its "
      "cuts "
      "cannot be stitched. Defaults: by the square root of the larger principal curvature, progressive; fitted: by that "
      "curvature, "
      "moved to where triangles come nearest to the surface. Random in each triangle is what the paper's section 4.2 describes: "
      "where there are more points "
      "than triangles it is stratified by the very triangles that the rings are made of.</p>\n";
}

void add_plots(const PaperFindings& findings, std::string& page) {
  constexpr std::array<const char*, 5> kColours = {"#1565c0", "#c62828", "#2e7d32", "#7b7f88", "#b08900"};
  page += "<div class=\"row\">\n";
  for (const MeshFindings& mesh : findings.meshes) {
    std::vector<PlotLine> lines;
    for (std::size_t i = 0; i < mesh.rings.size(); ++i) {
      const RingLine& line = mesh.rings[i];
      lines.push_back({absl::StrFormat("%s: %.3f", line.name, line.test.rms_gradient), mesh.ring_sizes, line.test.rms,
                       kColours[i % kColours.size()]});
    }
    if (mesh.paper != nullptr) {
      // From where the defaults begin.
      const double from = mesh.ring_sizes.front(), to = mesh.ring_sizes.back(), begin = mesh.rings[kDefaults].test.rms.front();
      lines.push_back({absl::StrFormat("the paper's gradient: %.2f", mesh.paper->gradient),
                       {from, to},
                       {begin, begin * std::pow(to / from, mesh.paper->gradient)},
                       "#000",
                       true});
    }
    page += log_plot(mesh.file, "points", "discrepancy, RMS over rings", lines);
  }
  page += "</div>\n";
  if (findings.meshes.empty()) return;
  const MeshFindings& first = findings.meshes.front();
  absl::StrAppendFormat(&page,
                        "<p class=\"note\">%d sets of %.0f to %.0f points on curves of %d vertices and more; around 256 random "
                        "triangles, after every ring; means of four runs.</p>\n",
                        first.ring_sizes.size(), first.ring_sizes.front(), first.ring_sizes.back(),
                        first.rings[kDefaults].curve_vertices);
}

void add_squares(const PaperFindings& findings, std::string& page) {
  absl::StrAppendFormat(
      &page,
      "<p class=\"note\">%d discs of radius %.4g, one and a half times that with which so many just touch where "
      "they lie densest.</p>\n<table>\n",
      findings.square_points, findings.disc_radius);
  page += heading({"", "star discrepancy", "covered"});
  for (const SquareDiscs& square : findings.squares) {
    page +=
        row({square.name, absl::StrFormat("%.3g", square.star_discrepancy), absl::StrFormat("%.1f %%", 100 * square.covered)});
  }
  page += "</table>\n";
}

void add_figure(const PaperFindings& findings, const Section& section, std::string& page) {
  page += "<h2>Figure ";
  for (const std::string& figure : section.figures) {
    absl::StrAppendFormat(&page, "%s<span id=\"figure-%s\">%s</span>", figure == section.figures.front() ? "" : ", ", figure,
                          figure);
  }
  absl::StrAppend(&page, ": ", section.title, "</h2>\n");
  if (section.figures.front() == "5") add_plots(findings, page);
  if (section.figures.front() == "6") add_squares(findings, page);
  page += "<div class=\"row\">\n";
  for (const Picture& picture : findings.pictures) {
    const std::string figure = picture.figure.substr(0, picture.figure.find(' '));
    if (std::ranges::find(section.figures, figure) == section.figures.end()) continue;
    absl::StrAppend(&page, "<figure><img alt=\"\" src=\"data:image/png;base64,", absl::Base64Escape(picture.png),
                    "\"><figcaption>", picture.figure != figure ? escaped(picture.figure) + ". " : "", escaped(picture.caption),
                    "</figcaption></figure>\n");
  }
  page += "</div>\n";
}

}  // namespace

std::string paper_page(const PaperFindings& findings) {
  std::string page = kHead;
  absl::StrAppend(
      &page, "<h1>Curvecast beside the paper</h1>\n<p>Tables and figures of <em>Low-Discrepancy Point Sampling of ",
      "Meshes for Rendering</em> (2007), made by <code>curvecast bench paper</code> on ", escaped(findings.machine),
      ". <b>defaults</b>: ours as it comes. <b>literal</b>: the paper's own ways, <code>--parameteriser cgal --mapper ",
      "id-buffer --area voronoi --sequence jittered</code>.",
      findings.quick ? " <b>Quick: far fewer points, too few for gradients.</b>" : "", "</p>\n");
  if (!findings.meshes.empty()) {
    add_claims(findings, page);
    add_table_1(findings, page);
    add_table_2(findings, page);
  }
  for (const Section& section : sections()) add_figure(findings, section, page);
  return page + "</body>\n</html>\n";
}

}  // namespace curvecast::cli::bench
