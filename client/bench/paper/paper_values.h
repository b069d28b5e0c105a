// What the paper prints: tables 1 and 2. Source: "Low-Discrepancy Point Sampling of Meshes for Rendering" (2007), on a Pentium 4
// with 3 GHz and 1 GB of memory.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace curvecast::cli::bench {

inline constexpr double kPaperRandomGradient = -0.5;  // figure 5

/// Seconds of the stages. Ours read and repair the file too, which counts in `total` alone.
struct StageTimes {
  double parameterise = 0;  // with cutting
  double curve = 0;         // with area elements
  double map = 0;
  double sample = 0;
  double total = 0;
};

struct TableStage {
  const char *name, *symbol;
  double StageTimes::*seconds;
};
inline constexpr std::array<TableStage, 5> kTableStages = {{{"parametrisation", "t_p", &StageTimes::parameterise},
                                                            {"the curve", "t_c", &StageTimes::curve},
                                                            {"mapping", "t_m", &StageTimes::map},
                                                            {"sampling", "t_s", &StageTimes::sample},
                                                            {"all together", "t", &StageTimes::total}}};

/// A Hausdorff distance of table 2; section 4.5 has that of 105 %.
struct PaperError {
  int percent = 0;   // of the original number of triangles
  double error = 0;  // % of the diagonal of the mesh's box
};

struct PaperMesh {
  const char* name;       // as the tables have it
  const char* file_part;  // what the names of its files have in them, in lower case
  int faces, vertices;    // in the tables in thousands
  StageTimes seconds;
  double gradient;
  std::vector<PaperError> errors;
};

/// Returns the paper's row for a file of this name, or null where it has none.
const PaperMesh* paper_mesh(std::string_view file_name);

}  // namespace curvecast::cli::bench
