#include "server/base/tokens.h"

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <openssl/sha.h>

#include <fstream>
#include <sstream>
#include <utility>
#include <vector>

#include "server/base/hash.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxFile = std::size_t{16} << 20;
constexpr std::string_view kScheme = "Bearer ";

}  // namespace

absl::StatusOr<std::shared_ptr<const Tokens>> Tokens::read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  if (file) {
    text.resize(kMaxFile + 1);
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) return absl::NotFoundError(absl::StrCat(path, ": the file of tokens cannot be read, or is too large"));
  return parse(text, path);
}

absl::StatusOr<std::shared_ptr<const Tokens>> Tokens::parse(std::string_view text, const std::string& name) {
  auto tokens = std::make_shared<Tokens>();
  int number = 0;
  for (const absl::string_view line : absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
    ++number;
    const auto fail = [&](absl::string_view why) {
      return absl::InvalidArgumentError(absl::StrCat(name, ", line ", number, ": ", why));
    };
    const std::vector<absl::string_view> words = absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
    if (words.empty() || words[0][0] == '#') continue;
    if (words.size() < 2 || words.size() > 3) return fail("NAME SHA256 [EXPIRES] belong there");
    if (words[1].size() != 2 * SHA256_DIGEST_LENGTH ||
        words[1].find_first_not_of("0123456789abcdefABCDEF") != absl::string_view::npos) {
      return fail("the second word is no SHA-256: 64 hexadecimal digits, as sha256sum prints");
    }
    Entry entry{std::string(words[0])};
    if (words.size() == 3) {
      std::int64_t seconds = 0;
      if (!absl::SimpleAtoi(words[2], &seconds) || seconds < 0 || seconds > std::int64_t{1} << 33) {
        return fail("the third word is no time: seconds since 1970");
      }
      entry.expires = Clock::time_point(std::chrono::seconds(seconds));
    }
    if (!tokens->by_digest_.emplace(absl::HexStringToBytes(words[1]), std::move(entry)).second) {
      return fail("this token has a line already");
    }
  }
  if (tokens->by_digest_.empty()) return absl::InvalidArgumentError(absl::StrCat(name, ": there are no tokens in it"));
  return tokens;
}

absl::StatusOr<Tokens::Holder> Tokens::authenticate(std::string_view authorization, Clock::time_point now) const {
  const absl::string_view header(authorization.data(), authorization.size());
  if (header.empty()) {
    return absl::UnauthenticatedError("this server wants a token: send the metadata \"authorization: Bearer TOKEN\"");
  }
  if (!absl::StartsWithIgnoreCase(header, absl::string_view(kScheme.data(), kScheme.size()))) {
    return absl::UnauthenticatedError("the metadata \"authorization\" is not of the form \"Bearer TOKEN\"");
  }
  const absl::string_view token = absl::StripAsciiWhitespace(header.substr(kScheme.size()));
  std::string digest = sha256({token.data(), token.size()});
  const absl::StatusOr<std::string_view> name = find(digest, now);
  if (!name.ok()) return name.status();
  return Holder{std::string(*name), std::move(digest)};
}

absl::Status Tokens::check(const Holder& holder, Clock::time_point now) const {
  const absl::StatusOr<std::string_view> name = find(holder.digest, now);
  if (!name.ok()) return name.status();
  return *name == holder.name ? absl::OkStatus() : absl::UnauthenticatedError("the token is another's now");
}

absl::StatusOr<std::string_view> Tokens::find(std::string_view digest, Clock::time_point now) const {
  const auto found = by_digest_.find(digest);
  if (found == by_digest_.end()) return absl::UnauthenticatedError("the token is not known here");
  if (now >= found->second.expires) return absl::UnauthenticatedError("the token has expired");
  return found->second.name;
}

}  // namespace curvecast::server
