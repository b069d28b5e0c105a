#include "client/bench/paper/hosted_mesh.h"

#include <algorithm>

namespace curvecast::cli::bench {

absl::StatusOr<v1::Session> HostedMesh::session(const SessionFlags& flags, std::uint64_t points) const {
  const absl::StatusOr<v1::SessionOptions> options =
      make_session_options(flags, std::max(points, options_.session_points), options_.seed);
  if (!options.ok()) return options.status();
  return client_.create_session(mesh_, *options, {}, options_.stop);
}

absl::StatusOr<v1::SampleRequest> HostedMesh::request(const SampleFlags& sample, const v1::Camera* camera) const {
  absl::StatusOr<v1::SampleRequest> request = make_request(sample, options_.seed);
  if (request.ok() && camera != nullptr) *request->add_cameras() = *camera;
  return request;
}

absl::StatusOr<client::Points> HostedMesh::sample(const SessionFlags& session_flags, const SampleFlags& sample,
                                                  const v1::Camera* camera) const {
  absl::StatusOr<v1::SampleRequest> wanted = request(sample, camera);
  if (!wanted.ok()) return wanted.status();
  const absl::StatusOr<v1::Session> opened = session(session_flags, sample.points);
  if (!opened.ok()) return opened.status();
  v1::ResampleRequest request;
  request.set_session_id(opened->session_id());
  *request.mutable_sample() = *std::move(wanted);
  request.mutable_sample()->mutable_encoding()->mutable_raw();
  absl::StatusOr<client::DecodedSample> decoded = client_.resample(request, options_.stop);
  if (!decoded.ok()) return decoded.status();
  return std::move(decoded->points);
}

absl::StatusOr<client::Mesh> HostedMesh::remesh(const SessionFlags& session_flags, const SampleFlags& sample,
                                                v1::RemeshRequest how) const {
  absl::StatusOr<v1::SampleRequest> wanted = request(sample, nullptr);
  if (!wanted.ok()) return wanted.status();
  const absl::StatusOr<v1::Session> opened = session(session_flags, sample.points);
  if (!opened.ok()) return opened.status();
  how.set_session_id(opened->session_id());
  *how.mutable_sample() = *std::move(wanted);
  return client_.remesh(how, {}, options_.stop);
}

absl::StatusOr<client::Curve> HostedMesh::curve(SessionFlags flags, std::uint64_t points) const {
  flags.omega = 1;
  const absl::StatusOr<v1::SessionOptions> options = make_session_options(flags, points);
  if (!options.ok()) return options.status();
  const absl::StatusOr<v1::Session> opened = client_.create_session(mesh_, *options, {}, options_.stop);
  if (!opened.ok()) return opened.status();
  return client_.get_curve(opened->session_id(), options_.stop);
}

absl::StatusOr<client::ParameterMesh> HostedMesh::parameter_mesh() const {
  const absl::StatusOr<v1::SessionOptions> options = make_session_options({}, options_.session_points);
  if (!options.ok()) return options.status();
  return client_.get_parameter_mesh(mesh_, *options, options_.stop);
}

}  // namespace curvecast::cli::bench
