// What the command's exit status means.
#pragma once

#include <absl/status/status.h>

namespace curvecast::cli {

enum ExitStatus : int {
  kDone = 0,
  kWrongUsage = 2,
  kBadInput = 3,
  kServerError = 4,
  kInterrupted = 130,
};

/// InvalidArgument, OutOfRange, NotFound and FailedPrecondition are bad input; Cancelled is an interruption when the user asked
/// for it; everything else is the server or the network.
ExitStatus exit_status(const absl::Status& status, bool interrupted);

}  // namespace curvecast::cli
