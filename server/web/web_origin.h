// Which pages may open a WebSocket: a browser sends the origin of the page, and lets any page try.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace curvecast::server {

struct WebOrigins {
  std::vector<std::string> others = {};  // besides our own pages: "https://example.org", as browsers write it; "*": all
  /// Whoever connects proves who it is. Else our own pages are only those that were asked for by an address, by a name without
  /// dots, or by one in .local: any other name may be one that somebody else lets point here, so that their page seems to be ours
  /// (DNS rebinding).
  bool any_name = false;
};

/// `origin` and `host` as in the request's header; no origin, as of programs that are no browsers, is allowed.
bool is_allowed(const WebOrigins& origins, std::string_view origin, std::string_view host);

}  // namespace curvecast::server
