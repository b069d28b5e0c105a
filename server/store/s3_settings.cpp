#include "server/store/s3_settings.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <utility>

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxFile = std::size_t{1} << 20;  // bytes of a file of settings that are read

using Section = std::map<std::string, std::string>;

std::string first_of(const Environment& environment, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (std::string value = environment(name); !value.empty()) return value;
  }
  return "";
}

std::string profile_of(const Environment& environment) {
  const std::string profile = environment("AWS_PROFILE");
  return profile.empty() ? "default" : profile;
}

/// Of `variable`, or else in the folder .aws of the user. Empty: there is no such user.
std::string file_of(const Environment& environment, const char* variable, const char* name) {
  if (std::string file = environment(variable); !file.empty()) return file;
  const std::string home = environment("HOME");
  return home.empty() ? "" : absl::StrCat(home, "/.aws/", name);
}

/// A profile's settings in a file "[NAME]", "KEY = VALUE", or "[profile NAME]" as in the AWS command line's second file. Empty
/// where there is neither file nor profile.
Section read_profile(const std::string& path, const std::string& profile) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kMaxFile, '\0');
  file.read(text.data(), kMaxFile);
  text.resize(static_cast<std::size_t>(file.gcount()));
  Section section;
  bool is_ours = false;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    line = absl::StripAsciiWhitespace(line);
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      line = absl::StripAsciiWhitespace(absl::StripSuffix(line.substr(1), "]"));
      if (absl::ConsumePrefix(&line, "profile ")) line = absl::StripAsciiWhitespace(line);
      is_ours = line == profile;
    } else if (is_ours) {
      const std::pair<absl::string_view, absl::string_view> setting = absl::StrSplit(line, absl::MaxSplits('=', 1));
      section[absl::AsciiStrToLower(absl::StripAsciiWhitespace(setting.first))] =
          std::string(absl::StripAsciiWhitespace(setting.second));
    }
  }
  return section;
}

std::string setting_of(const Section& section, const std::string& key) {
  const auto it = section.find(key);
  return it == section.end() ? std::string() : it->second;
}

/// Whether all of it can stand in a header.
bool is_visible(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; });
}

bool are_keys(const S3Keys& keys) {
  return !keys.access_key.empty() && !keys.secret.empty() && is_visible(keys.access_key) && is_visible(keys.secret) &&
         is_visible(keys.session_token);
}

bool is_bucket(const std::string& name) {
  const auto is_edge = [](char c) { return absl::ascii_islower(c) || absl::ascii_isdigit(c); };
  return name.size() >= 3 && name.size() <= 63 && is_edge(name.front()) && is_edge(name.back()) &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_edge(c) || c == '-' || c == '.'; });
}

/// Of AWS's partitions only China has another name.
std::string aws_url(const std::string& bucket, const std::string& region) {
  const char* domain = absl::StartsWith(region, "cn-") ? "amazonaws.com.cn" : "amazonaws.com";
  // Certificates for *.s3.REGION.amazonaws.com are none for a bucket with a dot.
  if (absl::StrContains(bucket, '.')) return absl::StrCat("https://s3.", region, ".", domain, "/", bucket);
  return absl::StrCat("https://", bucket, ".s3.", region, ".", domain);
}

}  // namespace

Environment process_environment() {
  return [](const std::string& name) -> std::string {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? "" : value;
  };
}

absl::StatusOr<S3Endpoint> find_s3_endpoint(const std::string& bucket, const Environment& environment) {
  if (!is_bucket(bucket)) {
    return absl::InvalidArgumentError(
        absl::StrCat("s3://", bucket, ": a bucket's name is 3 to 63 lower-case letters, digits, '-' and '.'"));
  }
  const Section config = read_profile(file_of(environment, "AWS_CONFIG_FILE", "config"), profile_of(environment));
  S3Endpoint out;
  out.ca_bundle = environment("AWS_CA_BUNDLE");
  out.region = first_of(environment, {"AWS_REGION", "AWS_DEFAULT_REGION"});
  if (out.region.empty()) out.region = setting_of(config, "region");
  if (out.region.empty()) out.region = "us-east-1";
  const auto is_region = [](char c) { return absl::ascii_isalnum(c) || c == '-'; };
  if (out.region.size() > 64 || !std::all_of(out.region.begin(), out.region.end(), is_region)) {
    return absl::FailedPreconditionError("the region (AWS_REGION) is up to 64 letters, digits and '-'");
  }
  std::string url = first_of(environment, {"AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL"});
  if (url.empty()) url = setting_of(config, "endpoint_url");
  if (url.empty()) {
    out.url = aws_url(bucket, out.region);
    return out;
  }
  // Keys do not belong there, and would show in errors.
  if (!(absl::StartsWith(url, "http://") || absl::StartsWith(url, "https://")) ||
      url.find_first_of("@?#\"<>\\") != std::string::npos || !is_visible(url)) {
    return absl::FailedPreconditionError("the endpoint (AWS_ENDPOINT_URL_S3) is no http://HOST:PORT or https://HOST:PORT");
  }
  while (absl::EndsWith(url, "/")) url.pop_back();
  out.url = absl::StrCat(url, "/", bucket);
  return out;
}

absl::StatusOr<std::unique_ptr<S3KeySource>> S3KeySource::open(const Environment& environment) {
  S3Keys keys{.access_key = environment("AWS_ACCESS_KEY_ID"),
              .secret = environment("AWS_SECRET_ACCESS_KEY"),
              .session_token = environment("AWS_SESSION_TOKEN")};
  if (!keys.access_key.empty() || !keys.secret.empty()) {
    if (!are_keys(keys)) {
      return absl::FailedPreconditionError(
          "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY have to be set both, and are visible characters only");
    }
    std::unique_ptr<S3KeySource> source(new S3KeySource("", ""));
    const MutexLock lock(source->mutex_);
    source->keys_ = std::move(keys);
    return source;
  }
  std::unique_ptr<S3KeySource> source(
      new S3KeySource(file_of(environment, "AWS_SHARED_CREDENTIALS_FILE", "credentials"), profile_of(environment)));
  const MutexLock lock(source->mutex_);
  if (absl::Status status = source->read(); !status.ok()) return status;
  return source;
}

std::optional<S3KeySource::Version> S3KeySource::version_of(const std::string& file) {
  struct stat status = {};
  if (::stat(file.c_str(), &status) != 0) return std::nullopt;
  return Version{.seconds = status.st_mtim.tv_sec,
                 .nanoseconds = status.st_mtim.tv_nsec,
                 .inode = status.st_ino,
                 .size = static_cast<std::uint64_t>(status.st_size)};
}

absl::Status S3KeySource::read() {
  const std::optional<Version> version = version_of(file_);  // before: what is written meanwhile is another one
  const Section section = read_profile(file_, profile_);
  S3Keys keys{.access_key = setting_of(section, "aws_access_key_id"),
              .secret = setting_of(section, "aws_secret_access_key"),
              .session_token = setting_of(section, "aws_session_token")};
  if (!are_keys(keys)) {
    return absl::FailedPreconditionError(absl::StrCat(
        "no keys for S3: neither AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY are set, nor has the profile '", profile_, "' in ",
        file_.empty() ? "~/.aws/credentials" : file_, " aws_access_key_id and aws_secret_access_key"));
  }
  keys_ = std::move(keys);
  version_ = version;
  return absl::OkStatus();
}

S3Keys S3KeySource::keys() {
  const MutexLock lock(mutex_);
  if (!file_.empty() && version_of(file_) != version_) read().IgnoreError();
  return keys_;
}

std::optional<S3Keys> S3KeySource::keys_instead_of(const S3Keys& refused) {
  const MutexLock lock(mutex_);
  // Another caller may have read it by now.
  if (!file_.empty() && keys_ == refused) read().IgnoreError();
  return keys_ == refused ? std::nullopt : std::optional(keys_);
}

}  // namespace curvecast::server
