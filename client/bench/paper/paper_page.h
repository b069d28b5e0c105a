// The findings as one page that needs nothing else: pictures and plots are in it.
#pragma once

#include <string>

#include "client/bench/paper/paper_report.h"

namespace curvecast::cli::bench {

/// HTML: what has to hold, tables 1 and 2, figures 1 to 9, ours beside the paper's numbers.
std::string paper_page(const PaperFindings& findings);

}  // namespace curvecast::cli::bench
