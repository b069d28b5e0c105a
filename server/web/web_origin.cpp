#include "server/web/web_origin.h"

#include <absl/strings/match.h>

#include <algorithm>
#include <array>

namespace curvecast::server {
namespace {

constexpr std::array<std::string_view, 2> kSchemes = {"http://", "https://"};

absl::string_view to_absl(std::string_view text) { return {text.data(), text.size()}; }

bool is_same(std::string_view a, std::string_view b) { return absl::EqualsIgnoreCase(to_absl(a), to_absl(b)); }

/// Without the port.
std::string_view name_of(std::string_view host) {
  const std::size_t colon = host.rfind(':');
  const std::size_t bracket = host.rfind(']');
  return colon == std::string_view::npos || (bracket != std::string_view::npos && bracket > colon) ? host : host.substr(0, colon);
}

/// An address, or a name that nobody else can let point here.
bool is_local(std::string_view name) {
  if (name.starts_with('[') || name.find_first_not_of("0123456789.") == std::string_view::npos) return true;
  return name.find('.') == std::string_view::npos || absl::EndsWithIgnoreCase(to_absl(name), ".local");
}

}  // namespace

bool is_allowed(const WebOrigins& origins, std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  if (std::any_of(origins.others.begin(), origins.others.end(),
                  [&](const std::string& other) { return other == "*" || is_same(other, origin); })) {
    return true;
  }
  const bool is_own = !host.empty() && std::any_of(kSchemes.begin(), kSchemes.end(), [&](std::string_view scheme) {
    return origin.starts_with(scheme) && is_same(origin.substr(scheme.size()), host);
  });
  return is_own && (origins.any_name || is_local(name_of(host)));
}

absl::Status check_page(const WebOrigins& origins, const WebPage& page) {
  if (!page.origin.empty()) {
    if (is_allowed(origins, page.origin, page.host)) return absl::OkStatus();
    return absl::PermissionDeniedError("pages of this origin may not ask; --web-origin allows others");
  }
  // Pictures, links and scripts of foreign pages name no origin.
  if (page.fetch_site == "cross-site" || page.fetch_site == "same-site") {
    return absl::PermissionDeniedError("pages of other sites may not ask without naming their origin");
  }
  // A page that asks its own server names none either: whoever asks counts as a page of the name by which it found us.
  const bool is_found = std::any_of(kSchemes.begin(), kSchemes.end(), [&](std::string_view scheme) {
    return is_allowed(origins, std::string(scheme) + std::string(page.host), page.host);
  });
  if (is_found) return absl::OkStatus();
  return absl::PermissionDeniedError(
      "a server that knows no callers answers by its address, a name without dots or one in .local, so that no foreign page can "
      "pretend "
      "to be its own; others name it with --web-origin, or have it know its callers with --tokens");
}

}  // namespace curvecast::server
