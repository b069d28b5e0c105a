// A store in a bucket of S3, or of what speaks as S3 does, such as MinIO.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string>

#include "server/store/s3_client.h"
#include "server/store/s3_settings.h"
#include "server/store/store.h"

namespace curvecast::server {

/// The objects PREFIX/NAME of a bucket, by the keys and at the endpoint that s3_settings.h names; asks the bucket for nothing
/// yet. InvalidArgument where bucket or prefix are none; FailedPrecondition where a setting is missing or cannot be used. Besides
/// what Store says, its calls return DataLoss where what is stored is not what was put, and PermissionDenied where bucket or
/// region are wrong.
absl::StatusOr<std::unique_ptr<Store>> make_s3_store(const std::string& bucket, const std::string& prefix);

/// The same with another environment and other options.
absl::StatusOr<std::unique_ptr<Store>> make_s3_store(const std::string& bucket, const std::string& prefix,
                                                     const Environment& environment, const S3Options& options);

}  // namespace curvecast::server
