#include "server/base/address.h"

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>

namespace curvecast::server {

absl::StatusOr<Address> parse_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  unsigned int port = 0;
  // SimpleAtoi takes a sign and blanks as well.
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size() ||
      !absl::ascii_isdigit(static_cast<unsigned char>(text[colon + 1])) || !absl::SimpleAtoi(text.substr(colon + 1), &port) ||
      port > 65'535) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", text, "\" is not an address to listen on; write HOST:PORT, such as 127.0.0.1:50051"));
  }
  std::string host = text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return Address{std::move(host), static_cast<std::uint16_t>(port)};
}

}  // namespace curvecast::server
