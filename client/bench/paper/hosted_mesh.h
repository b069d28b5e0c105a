// A mesh on a server within this process, and what is asked of it in the words of the command line.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <stop_token>
#include <string_view>

#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "client/lib/client.h"
#include "core/base/vec.h"

namespace curvecast::cli::bench {

struct HostedMeshOptions {
  std::uint64_t seed = 0;
  std::uint64_t session_points = 65'536;  // N that sessions are made for, if no more are asked for
  std::stop_token stop;                   // ends every call
};

/// Everything that it returns may fail with the errors of client::Client. Not thread-safe; the client outlives it.
class HostedMesh {
 public:
  HostedMesh(client::Client& client, client::UploadedMesh mesh, HostedMeshOptions options)
      : client_(client), mesh_(std::move(mesh)), options_(std::move(options)) {}

  const HostedMeshOptions& options() const { return options_; }
  /// `camera`: of the densities that need one, or null.
  absl::StatusOr<client::Points> sample(const SessionFlags& session, const SampleFlags& sample,
                                        const v1::Camera* camera = nullptr) const;
  /// `how`: with the method and what else there is besides the session and the points.
  absl::StatusOr<client::Mesh> remesh(const SessionFlags& session, const SampleFlags& sample, v1::RemeshRequest how = {}) const;
  /// A curve so coarse that its lines can be told apart: one vertex for each of so many points.
  absl::StatusOr<client::Curve> curve(SessionFlags flags, std::uint64_t points) const;
  absl::StatusOr<client::ParameterMesh> parameter_mesh() const;
  absl::StatusOr<v1::MeshInfo> info() const { return client_.inspect(mesh_, options_.stop); }

 private:
  absl::StatusOr<v1::Session> session(const SessionFlags& flags, std::uint64_t points) const;
  absl::StatusOr<v1::SampleRequest> request(const SampleFlags& sample, const v1::Camera* camera) const;

  client::Client& client_;
  client::UploadedMesh mesh_;
  HostedMeshOptions options_;
};

}  // namespace curvecast::cli::bench
