// Which pages may open a WebSocket: a browser sends the origin of the page, and lets any page try.
#pragma once

#include <absl/status/status.h>

#include <string>
#include <string_view>
#include <vector>

namespace curvecast::server {

struct WebOrigins {
  std::vector<std::string> others = {};  // besides our own pages: "https://example.org", as browsers write it; "*": all
  /// Set where clients prove who they are. Else a page counts as our own only if it was asked for by an address, by a name
  /// without dots, or by one in .local: the owner of any other name may let it point here, so that a foreign page seems to be
  /// ours (DNS rebinding).
  bool any_name = false;
};

/// Whether a page may open a WebSocket. `origin` and `host` are as in the request's header; an empty origin, as programs that are
/// no browsers send, is allowed.
bool is_allowed(const WebOrigins& origins, std::string_view origin, std::string_view host);

/// What a request says of the page that it comes from, as in its header.
struct WebPage {
  std::string_view origin;      // empty: a program, or a page that asks its own server
  std::string_view host;        // by which it found us
  std::string_view fetch_site;  // Sec-Fetch-Site; empty: a program, an old browser, or a connection that no browser trusts
};

/// Whether a request for a resource may come from there: from an allowed page or from a program, which found us by a name that
/// nobody else can let point here. PermissionDenied says what to do.
absl::Status check_page(const WebOrigins& origins, const WebPage& page);

}  // namespace curvecast::server
