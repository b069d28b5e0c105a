// What servers read of those who run them, or of proxies: tokens, networks, addresses, origins of pages, and the settings of
// `curvecast serve` as flags, in the environment and in a file. The first byte says which.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/commands.h"
#include "client/cli/configuration.h"
#include "server/base/address.h"
#include "server/base/tokens.h"
#include "server/net/trusted_proxies.h"
#include "server/web/web_origin.h"
#include "tests/fuzz/fuzz_bytes.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_folder.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

constexpr char kEnd = '\n';  // of each part of an input

std::vector<std::string> lines_of(Bytes& bytes) {
  std::vector<std::string> lines;
  while (!bytes.empty()) lines.emplace_back(bytes.take_until(kEnd));
  return lines;
}

void expect_refused(const absl::Status& status) {
  expect(absl::IsInvalidArgument(status) && !status.message().empty(), status.ToString());
}

void take_tokens(Bytes& bytes) {
  const std::string authorization(bytes.take_until(kEnd));
  const auto tokens = server::Tokens::parse(bytes.take_all(), "tokens");
  if (!tokens.ok()) {
    expect_refused(tokens.status());
    expect(tokens.status().message().size() < 200, "a message that may have a secret in it");
    return;
  }
  expect((*tokens)->size() > 0, "no tokens");
  const auto holder = (*tokens)->authenticate(authorization);
  expect(holder.ok() || absl::IsUnauthenticated(holder.status()), holder.status().ToString());
  if (holder.ok()) expect((*tokens)->check(*holder).ok(), "a holder who is none");
}

void take_networks(Bytes& bytes) {
  const std::string peer(bytes.take_until(kEnd));
  const std::string first(bytes.take_until(kEnd)), second(bytes.take_until(kEnd));
  std::vector<std::string> networks = lines_of(bytes);
  const auto given = server::TrustedProxies::parse(networks);
  if (!given.ok()) expect_refused(given.status());
  for (const auto& proxies :
       {given, server::TrustedProxies::parse({"0.0.0.0/0", "::/0"}), server::TrustedProxies::parse({"10.0.0.0/8"})}) {
    if (!proxies.ok()) continue;
    const auto client = proxies->client_of(peer, {first, second});
    expect(!client || client->starts_with("ipv4:") || client->starts_with("ipv6:%5B"), "a client that is no address");
  }
}

void take_address(Bytes& bytes) {
  const auto address = server::parse_address(std::string(bytes.take_all()));
  if (!address.ok()) return expect_refused(address.status());
  expect(!address->host.empty(), "an address without a host");
}

void take_origins(Bytes& bytes) {
  const std::string origin(bytes.take_until(kEnd)), host(bytes.take_until(kEnd));
  server::WebOrigins origins{.others = lines_of(bytes)};
  const bool if_known = is_allowed(origins, origin, host);
  origins.any_name = true;
  expect(is_allowed(origins, origin, host) || !if_known, "allowed where names count less, refused where they count more");
}

/// `curvecast serve`, with its settings.
class Serve {
 public:
  /// Whether CLI11 takes the arguments.
  bool parse(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "serve");
    std::ranges::reverse(arguments);  // as CLI11 wants them
    try {
      root_.parse(std::move(arguments));
      return true;
    } catch (const CLI::Error&) {  // help, too
      return false;
    }
  }
  absl::StatusOr<std::map<std::string, std::string>> configure(const std::string& file) const {
    const auto settings = cli::configure(*command_.app, file);
    if (!settings.ok()) return settings.status();
    std::map<std::string, std::string> values;
    for (const cli::Setting& setting : *settings) values[setting.name] = setting.value;
    return values;
  }
  std::string printed() const { return cli::to_configuration(*command_.app); }

 private:
  CLI::App root_{"curvecast"};
  cli::CommonOptions options_;
  const cli::Command command_ = cli::add_serve(root_, options_);
};

const std::string& file_path() {
  static const Folder folder;
  static const std::string path = folder / "settings.toml";
  return path;
}

/// CLI11 knows no way to write down all characters.
bool is_plain(const std::string& value) {
  return std::ranges::all_of(value, [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("-._:/*@%+").find(static_cast<char>(c)) != std::string_view::npos;
  });
}

/// What is printed means the same when it is read.
void expect_same_when_printed(const Serve& serve, const std::map<std::string, std::string>& values) {
  if (!std::ranges::all_of(values, [](const auto& value) { return is_plain(value.second); })) return;
  write_file(file_path(), serve.printed());
  Serve again;
  expect(again.parse({}), "serve without arguments is refused");
  const auto read = again.configure(file_path());
  expect(read.ok(), "printed, but not read: " + read.status().ToString());
  for (const auto& [name, value] : values) {
    expect(read->at(name) == value, name + " was '" + value + "', and is '" + read->at(name) + "' after it was printed and read");
  }
}

void take_settings(const std::vector<std::string>& arguments, const std::string& file) {
  Serve serve;
  if (!serve.parse(arguments)) return;
  const auto values = serve.configure(file);
  if (!values.ok()) return expect_refused(values.status());
  for (const auto& [name, value] : *values) ::unsetenv(cli::environment_name(name).c_str());
  expect_same_when_printed(serve, *values);
}

void take_environment(Bytes& bytes) {
  std::vector<std::string> names;
  while (!bytes.empty()) {
    const std::string name = cli::environment_name(std::string(bytes.take_until('=')));
    const std::string value(bytes.take_until(kEnd));
    if (name.find('\0') == std::string::npos) ::setenv(names.emplace_back(name).c_str(), value.c_str(), 1);
  }
  take_settings({}, "");
  for (const std::string& name : names) ::unsetenv(name.c_str());
}

void take_file(Bytes& bytes) {
  write_file(file_path(), bytes.take_all());
  take_settings({}, file_path());
}

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  switch (bytes.take() % 7) {
    case 0:
      return take_tokens(bytes);
    case 1:
      return take_networks(bytes);
    case 2:
      return take_address(bytes);
    case 3:
      return take_origins(bytes);
    case 4:
      return take_settings(lines_of(bytes), "");
    case 5:
      return take_environment(bytes);
    default:
      return take_file(bytes);
  }
}

}  // namespace curvecast::fuzzing
