#include "server/net/proxy_queue.h"

#include <unistd.h>

#include <utility>

#include "server/net/proxy_header.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMostWaiting = 64;

}  // namespace

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
  const ProxyHeader header = take_proxy_header(waiting.connection.descriptor);
  const bool is_late = Clock::now() >= waiting.end;
  if (header.state == ProxyHeader::State::kPart && !is_late) return false;
  const bool is_broken = header.state == ProxyHeader::State::kBroken;
  if (is_broken || (header.state == ProxyHeader::State::kPart && header.size > 0)) {
    ::close(waiting.connection.descriptor);
  } else {
    give(waiting.connection, header.client);
  }
  return true;
}

}  // namespace curvecast::server
