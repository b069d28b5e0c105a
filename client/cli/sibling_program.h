// The other program of a pair that is installed together.
#pragma once

#include <absl/status/statusor.h>

#include <string>

namespace curvecast::cli {

/// Finds the program `name` in the folder of the program that is running. NotFound where there is none that can be executed.
absl::StatusOr<std::string> sibling_program(const std::string& name);

}  // namespace curvecast::cli
