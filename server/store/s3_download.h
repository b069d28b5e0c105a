// Gets an object out of S3 into a file.
#pragma once

#include <absl/status/status.h>

#include <string>

#include "server/store/s3_client.h"

namespace curvecast::server {

/// The file appears whole or not at all. After a broken connection it goes on from where it was, where the object is still the
/// same. What has come is compared with the object's length and, where the object has it (see s3_upload.h), its SHA-256: DataLoss
/// where the same wrong bytes come twice. The deadline gets time for the object's bytes. Other errors as of S3Client::send();
/// ResourceExhausted and Unavailable also where the file cannot be written.
absl::Status get_s3_object(S3Client& client, const std::string& key, const std::string& path, Deadline& deadline);

}  // namespace curvecast::server
