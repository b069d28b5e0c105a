// Checks of what a client sent.
#pragma once

#include <absl/status/status.h>
#include <absl/strings/cord.h>
#include <absl/strings/str_cat.h>

#include <cmath>
#include <string>

#include "core/base/vec.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/base/status_payload.h"

namespace curvecast::server {

/// The first error of many checks, so that a converter reads like the message that it converts.
class Checker {
 public:
  const absl::Status& status() const { return status_; }
  bool ok() const { return status_.ok(); }

  void fail(const std::string& field, const std::string& problem) {
    if (!status_.ok()) return;
    status_ = absl::InvalidArgumentError(absl::StrCat(field, " ", problem));
    status_.SetPayload(kFieldPayload, absl::Cord(field));
  }
  /// Finite, or an error.
  double finite(const std::string& field, double value) {
    if (!std::isfinite(value)) fail(field, "is not finite");
    return value;
  }
  template <class Number>
  Number in_range(const std::string& field, Number value, Number low, Number high) {
    if (!(value >= low && value <= high)) {  // written so that a NaN fails
      fail(field, absl::StrCat("is ", value, "; it must be from ", low, " to ", high));
    }
    return value;
  }
  Vec3d vector(const std::string& field, const v1::Vec3& v) {
    return {finite(field + ".x", v.x()), finite(field + ".y", v.y()), finite(field + ".z", v.z())};
  }

 private:
  absl::Status status_;
};

}  // namespace curvecast::server
