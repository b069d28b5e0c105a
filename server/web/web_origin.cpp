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

}  // namespace curvecast::server
