#include "client/cli/sample/manifest.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

absl::Status in_line(std::size_t line, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat("line ", line, ": ", status.message()));
}

/// What the mesh at a path is called: "/data/a/bunny.ply" and "data/./a/bunny.obj" are "data/a/bunny".
std::string name_of(const std::string& path) {
  return fs::path(path).lexically_normal().relative_path().replace_extension().string();
}

/// "--points=1000"; several for an array.
absl::Status append_arguments(const std::string& key, const json& value, std::vector<std::string>* arguments) {
  if (value.is_array()) {
    for (const json& element : value) {
      if (element.is_array()) return absl::InvalidArgumentError(absl::StrCat("'", key, "' has arrays in its array"));
      if (absl::Status status = append_arguments(key, element, arguments); !status.ok()) return status;
    }
    return absl::OkStatus();
  }
  if (!value.is_string() && !value.is_number() && !value.is_boolean()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", key, "' is neither a string, a number, true, false nor an array of these"));
  }
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  arguments->push_back(absl::StrCat("--", absl::StrReplaceAll(key, {{"_", "-"}}), "=", text));
  return absl::OkStatus();
}

absl::StatusOr<ManifestEntry> parse_object(const std::string& text) {
  const json object = json::parse(text, nullptr, false);
  if (!object.is_object()) return absl::InvalidArgumentError("it begins as a JSON object and is none");
  ManifestEntry entry;
  for (const auto& [key, value] : object.items()) {
    if (key == "mesh" || key == "name") {
      if (!value.is_string()) return absl::InvalidArgumentError(absl::StrCat("'", key, "' is no string"));
      (key == "mesh" ? entry.mesh : entry.name) = value.get<std::string>();
    } else if (absl::Status status = append_arguments(key, value, &entry.arguments); !status.ok()) {
      return status;
    }
  }
  if (entry.mesh.empty()) return absl::InvalidArgumentError("it names no 'mesh'");
  return entry;
}

absl::StatusOr<ManifestEntry> parse_line(const std::string& text) {
  absl::StatusOr<ManifestEntry> entry = text.starts_with('{') ? parse_object(text) : ManifestEntry{.mesh = text};
  if (!entry.ok()) return entry;
  if (entry->name.empty()) entry->name = name_of(entry->mesh);
  if (absl::Status status = check_output_name(entry->name); !status.ok()) {
    return absl::Status(status.code(), absl::StrCat(entry->mesh, ": ", status.message()));
  }
  return entry;
}

}  // namespace

absl::Status check_output_name(const std::string& name) {
  const fs::path path(name);
  if (!name.empty() && path.is_relative() && path.lexically_normal().string() == name && path.has_filename() &&
      *path.begin() != ".." && path != "." && name.find('\0') == std::string::npos) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      absl::StrCat("'", name, "' is no name of an output: a relative path that does not go up; give another \"name\""));
}

absl::StatusOr<std::vector<ManifestEntry>> parse_manifest(std::istream& in) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::vector<ManifestEntry> entries;
  std::string text;
  for (std::size_t line = 1; std::getline(in, text); ++line) {
    if (line == 1 && text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
    absl::StripAsciiWhitespace(&text);
    if (text.empty() || text.starts_with('#')) continue;
    absl::StatusOr<ManifestEntry> entry = parse_line(text);
    if (!entry.ok()) return in_line(line, entry.status());
    entry->line = line;
    entries.push_back(*std::move(entry));
  }
  if (in.bad()) return absl::InvalidArgumentError("it cannot be read to its end");
  if (entries.empty()) return absl::InvalidArgumentError("it names no meshes");
  return entries;
}

absl::StatusOr<std::vector<ManifestEntry>> read_manifest(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    std::error_code error;
    if (fs::is_directory(path, error)) return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory, not a list"));
    file.open(path, std::ios::binary);
    if (!file.is_open()) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened: ", std::strerror(errno)));
  }
  absl::StatusOr<std::vector<ManifestEntry>> entries = parse_manifest(path == "-" ? std::cin : file);
  if (entries.ok()) return entries;
  return absl::Status(entries.status().code(),
                      absl::StrCat(path == "-" ? "standard input" : path, ": ", entries.status().message()));
}

}  // namespace curvecast::cli
