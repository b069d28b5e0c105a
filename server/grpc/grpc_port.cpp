#include "server/grpc/grpc_port.h"

#include <absl/cleanup/cleanup.h>
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <utility>

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

// For connections that gave way, until gRPC has closed them: in a crowd, dozens at a time.
constexpr std::chrono::milliseconds kPatience{1000}, kLook{2};

}  // namespace

absl::StatusOr<std::unique_ptr<GrpcPort>> GrpcPort::bind(const std::string& address, ConnectionTable& connections,
                                                         std::size_t most) {
  absl::StatusOr<std::unique_ptr<PortListener>> listener = PortListener::bind(address);
  if (!listener.ok()) return listener.status();
  return std::unique_ptr<GrpcPort>(new GrpcPort(*std::move(listener), connections, most));
}

GrpcPort::GrpcPort(std::unique_ptr<PortListener> listener, ConnectionTable& connections, std::size_t most)
    : connections_(connections), most_(most), listener_(std::move(listener)) {}

void GrpcPort::add_to(grpc::ServerBuilder& builder, std::shared_ptr<grpc::ServerCredentials> credentials) {
  using Type = grpc::ServerBuilder::experimental_type::ExternalConnectionType;
  acceptor_ = builder.experimental().AddExternalConnectionAcceptor(Type::FROM_FD, std::move(credentials));
}

void GrpcPort::open(PortListener::IsProxy is_proxy) {
  listener_->accept([this](int listener, int descriptor, const std::string& peer,
                           const std::string& client) { take(listener, descriptor, peer, client); },
                    std::move(is_proxy));
  probe_ = std::make_unique<PortProbe>(listener_->descriptor());
}

void GrpcPort::close() {
  is_closed_ = true;
  listener_->close();
}

void GrpcPort::take(int listener, int descriptor, const std::string& peer, const std::string& client) {
  absl::Cleanup refuse = [&descriptor] { ::close(descriptor); };
  if (!lower(descriptor) || !connections_.add(descriptor, peer, client)) return;
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
  connection.listener_fd = listener;
  connection.fd = descriptor;
  std::move(refuse).Cancel();
  acceptor_->HandleNewConnection(&connection);
}

bool GrpcPort::lower(int& descriptor) const {
  for (const Clock::time_point end = Clock::now() + kPatience; static_cast<std::size_t>(descriptor) >= most_;) {
    if (is_closed_ || Clock::now() >= end) return false;
    std::this_thread::sleep_for(kLook);
    const int copy = ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);  // the lowest that is free
    if (copy < 0) continue;
    ::close(std::exchange(descriptor, copy));
  }
  return true;
}

}  // namespace curvecast::server
