#include "server/net/proxy_queue.h"

#include <unistd.h>

#include <utility>

namespace curvecast::server {
namespace {

constexpr std::size_t kMostWaiting = 64;

}  // namespace

std::optional<ProxyHeader> take_proxy_header(int descriptor, std::chrono::steady_clock::time_point end) {
  using State = ProxyHeader::State;
  ProxyHeader header = take_proxy_header(descriptor);
  if (header.state != State::kPart) return header;
  if (std::chrono::steady_clock::now() < end) return std::nullopt;
  header.state = header.size > 0 ? State::kBroken : State::kNone;
  return header;
}

ProxyQueue::~ProxyQueue() {
  for (const Waiting& waiting : waiting_) ::close(waiting.connection.descriptor);
}

void ProxyQueue::add(Connection connection, const Give& give) {
  Waiting waiting = {std::move(connection), Clock::now() + kProxyPatience};
  if (meet(waiting, give)) return;
  if (waiting_.size() >= kMostWaiting) {
    ::close(waiting_.front().connection.descriptor);
    waiting_.erase(waiting_.begin());
  }
  waiting_.push_back(std::move(waiting));
}

void ProxyQueue::serve(const Give& give) {
  std::erase_if(waiting_, [&](const Waiting& waiting) { return meet(waiting, give); });
}

bool ProxyQueue::meet(const Waiting& waiting, const Give& give) {
  const std::optional<ProxyHeader> header = take_proxy_header(waiting.connection.descriptor, waiting.end);
  if (!header) return false;
  if (header->state == ProxyHeader::State::kBroken) {
    ::close(waiting.connection.descriptor);
  } else {
    give(waiting.connection, header->client);
  }
  return true;
}

}  // namespace curvecast::server
