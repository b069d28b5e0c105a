// The findings in a folder: paper.html and paper.json.
#pragma once

#include <absl/status/status.h>

#include <string>

#include "client/bench/paper/paper_report.h"

namespace curvecast::cli::bench {

/// Makes the folder where it is missing, and checks that files can be written there. FailedPrecondition or PermissionDenied name
/// the path.
absl::Status prepare_paper_folder(const std::string& folder);

/// Writes both files. Errors as of client::write_bytes.
absl::Status write_paper_files(const std::string& folder, const PaperFindings& findings);

/// What standard output says: how many claims hold, and which do not.
std::string paper_summary(const std::string& folder, const PaperFindings& findings);

}  // namespace curvecast::cli::bench
