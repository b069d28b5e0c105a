// Turns exceptions of libraries into statuses, at the edge of our code.
#pragma once

#include <absl/status/status.h>

#include <exception>
#include <new>
#include <string>

#include "core/base/spill.h"

namespace curvecast::server {

/// Calls `work`, which returns an absl::Status or absl::StatusOr, and returns its result: ResourceExhausted when memory ran out,
/// Internal for any other exception.
template <class Work>
auto status_from_exceptions(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const SpillError& error) {
    return absl::ResourceExhaustedError(error.what());
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("the server ran out of memory; ask for fewer points or a lower omega");
  } catch (const std::exception& error) {
    return absl::InternalError(std::string("unexpected: ") + error.what());
  }
}

}  // namespace curvecast::server
