#include "server/store/s3_store.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <algorithm>
#include <utility>

#include "server/store/s3_download.h"
#include "server/store/s3_error.h"
#include "server/store/s3_upload.h"
#include "server/store/source_file.h"

namespace curvecast::server {
namespace {

class S3Store : public Store {
 public:
  S3Store(std::string prefix, std::unique_ptr<S3Client> client)
      : prefix_(std::move(prefix)), client_(std::move(client)), upload_(*client_) {}

  absl::Status put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override;
  absl::Status get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override;
  absl::StatusOr<std::uint64_t> size(const std::string& name, const std::atomic<bool>* cancel) override;
  absl::Status remove(const std::string& name, const std::atomic<bool>* cancel) override;

 private:
  absl::StatusOr<std::string> key_of(const std::string& name) const;

  const std::string prefix_;  // empty, or with a '/' at its end
  const std::unique_ptr<S3Client> client_;
  S3Upload upload_;
};

absl::StatusOr<std::string> S3Store::key_of(const std::string& name) const {
  if (!is_store_name(name)) return absl::NotFoundError(absl::StrCat("there is no such name in a store: ", name));
  return absl::StrCat(prefix_, name);
}

absl::Status S3Store::put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) {
  const absl::StatusOr<std::string> key = key_of(name);
  if (!key.ok()) return key.status();
  const absl::StatusOr<SourceFile> source = SourceFile::open(path);
  if (!source.ok()) {
    return absl::IsNotFound(source.status()) ? source.status() : absl::UnavailableError(source.status().message());
  }
  Deadline deadline(client_->options().time, cancel);
  deadline.allow(source->size(), client_->options().rate);
  const absl::StatusOr<S3File> file = read_s3_file(source->descriptor(), source->size(), client_->options().part_size, deadline);
  if (!file.ok()) return absl::Status(file.status().code(), absl::StrCat(path, ": ", file.status().message()));
  return upload_.put(*key, *file, deadline);
}

absl::Status S3Store::get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) {
  const absl::StatusOr<std::string> key = key_of(name);
  if (!key.ok()) return key.status();
  Deadline deadline(client_->options().time, cancel);
  return get_s3_object(*client_, *key, path, deadline);
}

absl::StatusOr<std::uint64_t> S3Store::size(const std::string& name, const std::atomic<bool>* cancel) {
  const absl::StatusOr<std::string> key = key_of(name);
  if (!key.ok()) return key.status();
  const Deadline deadline(client_->options().time, cancel);
  const absl::StatusOr<HttpResponse> response = client_->send({.method = "HEAD", .key = *key}, deadline);
  if (absl::IsNotFound(response.status())) {
    // Object or bucket: only a response with a body says which.
    const absl::StatusOr<HttpResponse> again =
        client_->send({.method = "GET", .key = *key, .headers = {"range: bytes=0-0"}}, deadline);
    return again.ok() ? absl::UnavailableError(absl::StrCat(client_->name_of(*key), ": has come meanwhile")) : again.status();
  }
  if (!response.ok()) return response.status();
  if (absl::Status status = check_is_s3(client_->name_of(*key), *response); !status.ok()) return status;
  std::uint64_t size = 0;
  if (!absl::SimpleAtoi(response->header("content-length"), &size)) {
    return absl::UnavailableError(absl::StrCat(client_->name_of(*key), ": HEAD: HTTP 200 without a length"));
  }
  return size;
}

absl::Status S3Store::remove(const std::string& name, const std::atomic<bool>* cancel) {
  const absl::StatusOr<std::string> key = key_of(name);
  if (!key.ok()) return key.status();
  const Deadline deadline(client_->options().time, cancel);
  const absl::Status status = client_->send({.method = "DELETE", .key = *key}, deadline).status();
  return absl::IsNotFound(status) ? absl::OkStatus() : status;
}

/// Prefixes are as a user wants them, but for what some stores take for paths.
bool is_prefix(const std::string& prefix) {
  const std::vector<std::string> parts = absl::StrSplit(prefix, '/');
  return prefix.size() <= 512 && std::all_of(parts.begin(), parts.end(), [](const std::string& part) {
           const auto is_control = [](char c) { return static_cast<unsigned char>(c) < ' '; };
           return !part.empty() && part != "." && part != ".." && std::none_of(part.begin(), part.end(), is_control);
         });
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> make_s3_store(const std::string& bucket, const std::string& prefix) {
  return make_s3_store(bucket, prefix, process_environment(), {});
}

absl::StatusOr<std::unique_ptr<Store>> make_s3_store(const std::string& bucket, const std::string& prefix,
                                                     const Environment& environment, const S3Options& options) {
  absl::string_view path = prefix;
  while (absl::ConsumePrefix(&path, "/")) continue;
  while (absl::ConsumeSuffix(&path, "/")) continue;
  if (!path.empty() && !is_prefix(std::string(path))) {
    return absl::InvalidArgumentError(
        absl::StrCat("s3://", bucket, ": the prefix is names with '/' between them, up to 512 bytes"));
  }
  absl::StatusOr<S3Endpoint> endpoint = find_s3_endpoint(bucket, environment);
  if (!endpoint.ok()) return endpoint.status();
  absl::StatusOr<std::unique_ptr<S3KeySource>> keys = S3KeySource::open(environment);
  if (!keys.ok()) return keys.status();
  auto client = std::make_unique<S3Client>(bucket, *std::move(endpoint), *std::move(keys), options);
  return std::make_unique<S3Store>(absl::StrCat(path, path.empty() ? "" : "/"), std::move(client));
}

}  // namespace curvecast::server
