// Validates the fields of a message that a client sent.
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

/// Keeps the first error of many checks, so that a converter reads like the message that it converts. `field` is the path of a
/// field in the request, such as "sample.cameras[0].eye".
class FieldValidator {
 public:
  /// OK, or InvalidArgument with the first field at fault in its message and as its payload kFieldPayload.
  const absl::Status& status() const { return status_; }
  bool ok() const { return status_.ok(); }

  /// Keeps "`field` `problem`" as the error, unless there is one already.
  void fail(const std::string& field, const std::string& problem) {
    if (!status_.ok()) return;
    status_ = absl::InvalidArgumentError(absl::StrCat(field, " ", problem));
    status_.SetPayload(kFieldPayload, absl::Cord(field));
  }
  /// Returns the value; fails where it is infinite or no number.
  double finite(const std::string& field, double value) {
    if (!std::isfinite(value)) fail(field, "is not finite");
    return value;
  }
  /// Returns the value; fails where it is not in [low, high].
  template <class Number>
  Number in_range(const std::string& field, Number value, Number low, Number high) {
    if (!(value >= low && value <= high)) {  // written so that a NaN fails
      fail(field, absl::StrCat("is ", value, "; it must be from ", low, " to ", high));
    }
    return value;
  }
  /// Returns the vector; fails where a component is infinite or no number.
  Vec3d vector(const std::string& field, const v1::Vec3& v) {
    return {finite(field + ".x", v.x()), finite(field + ".y", v.y()), finite(field + ".z", v.z())};
  }

 private:
  absl::Status status_;
};

}  // namespace curvecast::server
