#include "client/cli/exit_status.h"

namespace curvecast::cli {

ExitStatus exit_status(const absl::Status& status, bool interrupted) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return kDone;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kFailedPrecondition:
      return kBadInput;
    case absl::StatusCode::kCancelled:
      return interrupted ? kInterrupted : kServerError;
    default:
      return kServerError;
  }
}

}  // namespace curvecast::cli
