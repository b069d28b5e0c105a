#include "client/bench/server/server_stage.h"

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <string_view>
#include <utility>

namespace curvecast::cli::bench {
namespace {

constexpr std::chrono::seconds kPatience{60};
constexpr int kMaxMessage = 64 << 20;  // bytes

Vec3d to_vec(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

absl::StatusOr<ServerStage> ServerStage::open(const MeshFile& file, std::uint64_t points, const std::string& command,
                                              const ExecutionContext& context) {
  ServerStage stage;
  auto server = ServerProcess::start(command, context.threads);
  if (!server.ok()) return server.status();
  stage.server_ = *std::move(server);
  client::Client client(stage.connect());
  const auto on_progress = [&](std::string_view name, double fraction) { context.progress(name, fraction); };
  const absl::StatusOr<std::string> mesh = client.upload_mesh(std::string(file.name), file.bytes, on_progress);
  if (!mesh.ok()) return mesh.status();
  v1::SessionOptions session_options;
  session_options.set_max_points(points);
  const absl::StatusOr<v1::Session> session = client.create_session(*mesh, session_options, on_progress);
  if (!session.ok()) return session.status();
  stage.session_id_ = session->session_id();
  const v1::MeshInfo& info = session->report().mesh();
  stage.box_ = {to_vec(info.box_min()), to_vec(info.box_max())};
  return stage;
}

std::shared_ptr<client::Connection> ServerStage::connect() const {
  grpc::ChannelArguments arguments;
  // Else channels to one address share a connection, which has 256 calls.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetMaxReceiveMessageSize(kMaxMessage);
  return client::make_connection(grpc::CreateCustomChannel(server_->address(), grpc::InsecureChannelCredentials(), arguments));
}

absl::StatusOr<client::Frame> answer(client::ViewStream& stream, const v1::SampleRequest& sample, bool settled) {
  const absl::StatusOr<std::uint64_t> sequence = stream.send_view(sample);
  if (!sequence.ok()) return sequence.status();
  while (true) {
    absl::StatusOr<client::Frame> frame = stream.next_frame(kPatience);
    if (!frame.ok()) return frame.status();
    if (!frame->error.ok()) return frame->error;
    if (frame->sequence == *sequence && !(settled && frame->statistics.refining())) return frame;
  }
}

}  // namespace curvecast::cli::bench
