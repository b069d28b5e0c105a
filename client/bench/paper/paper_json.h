// The findings as JSON, beside the page.
#pragma once

#include <nlohmann/json.hpp>

#include "client/bench/paper/paper_report.h"

namespace curvecast::cli::bench {

/// {name, machine, quick, seed, claims[{claim, ours, paper, holds}], table_1{points, meshes[...]}, table_2[...], figure_5[...],
/// figure_6{...}, pictures[{figure, caption}]}; the paper's numbers are null where it has none.
nlohmann::ordered_json paper_json(const PaperFindings& findings);

}  // namespace curvecast::cli::bench
