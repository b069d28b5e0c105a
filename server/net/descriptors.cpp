#include "server/net/descriptors.h"

#include <sys/resource.h>

#include <algorithm>

namespace curvecast::server {
namespace {

// Enough for everybody, where the hard limit is none.
constexpr rlim_t kMost = 1 << 20;

}  // namespace

std::size_t raise_descriptor_limit() {
  rlimit limit = {};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return 1024;
  const rlim_t before = limit.rlim_cur;
  limit.rlim_cur = std::max(before, std::min(limit.rlim_max, kMost));
  if (limit.rlim_cur != before && ::setrlimit(RLIMIT_NOFILE, &limit) != 0) limit.rlim_cur = before;
  return static_cast<std::size_t>(std::min(limit.rlim_cur, kMost));
}

DescriptorShares share_descriptors(std::size_t limit) {
  // The system gives out the lowest number that is free: a high one tells that all below are taken.
  return {.connections = std::max<std::size_t>(1, limit / 2),
          .sockets = std::max<std::size_t>(1, limit / 8),
          .pages = std::max<std::size_t>(4, limit / 16),
          .reserve_from = limit - limit / 8};
}

}  // namespace curvecast::server
