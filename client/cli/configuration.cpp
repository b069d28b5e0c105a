#include "client/cli/configuration.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>

#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 20;
constexpr char kSeparator = ';';  // no colon: origins of pages have some

using Values = std::vector<std::string>;

bool takes_several(const CLI::Option& option) { return option.get_items_expected_max() > 1; }
bool is_flag(const CLI::Option& option) { return option.get_expected_max() == 0; }

/// By option without dashes.
std::map<std::string, CLI::Option*> configurable_options(CLI::App& command) {
  std::map<std::string, CLI::Option*> out;
  for (CLI::Option* option : command.get_options()) {
    if (option->get_configurable() && !option->get_lnames().empty()) out[option->get_lnames().front()] = option;
  }
  return out;
}

/// By key. Knows nothing of the options but their names.
absl::StatusOr<std::map<std::string, Values>> read_file(const std::string& path,
                                                        const std::map<std::string, CLI::Option*>& options) {
  const absl::StatusOr<std::string> bytes = client::read_bytes(path, kMaxFileBytes);
  if (!bytes.ok()) return bytes.status();
  std::vector<CLI::ConfigItem> items;
  try {
    std::istringstream stream(*bytes);
    items = CLI::ConfigTOML().from_config(stream);
  } catch (const CLI::Error& error) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", error.what()));
  }
  std::map<std::string, Values> out;
  std::vector<std::string> unknown;
  for (const CLI::ConfigItem& item : items) {
    if (item.name == "--") continue;  // end of a table
    // CLI11 takes closed quotes away, and # for the beginning of a comment even between them.
    if (std::any_of(item.inputs.begin(), item.inputs.end(),
                    [](const std::string& text) { return text.find_first_of("\"'") == 0; })) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": ", item.fullname(), ": quotes are not closed, or there is a # in them"));
    }
    if (item.name == "++") {
      unknown.push_back(absl::StrCat("[", absl::StrJoin(item.parents, "."), "]"));
    } else if (!options.contains(item.fullname())) {
      unknown.push_back(item.fullname());
    } else if (const auto [it, is_new] = out.emplace(item.name, item.inputs); !is_new) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": ", item.name, " is there twice"));
    }
  }
  if (unknown.empty()) return out;
  return absl::InvalidArgumentError(absl::StrCat(
      path, ": there is no setting named ", absl::StrJoin(unknown, ", "),
      "; there are: ", absl::StrJoin(options, ", ", [](std::string* text, const auto& entry) { text->append(entry.first); })));
}

/// The values in a variable of the environment.
Values split(const char* text) {
  Values values;
  for (const absl::string_view value : absl::StrSplit(text, kSeparator, absl::SkipWhitespace())) {
    values.emplace_back(absl::StripAsciiWhitespace(value));
  }
  return values;
}

absl::Status assign(CLI::Option& option, const Values& values, const std::string& source) {
  try {
    if (is_flag(option)) {
      if (values.size() != 1) return absl::InvalidArgumentError(absl::StrCat(source, ": write true or false"));
      option.add_result(option.get_flag_value(option.get_lnames().front(), values.front()));
    } else {
      if (values.size() != 1 && !takes_several(option)) {
        return absl::InvalidArgumentError(absl::StrCat(source, ": takes one value, not ", values.size()));
      }
      option.add_result(values);
    }
    option.run_callback();
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(absl::StrCat(source, ": ", error.what()));
  }
  return absl::OkStatus();
}

std::string value_of(const CLI::Option& option) {
  if (option.count() > 0) return absl::StrJoin(option.reduced_results(), std::string(1, kSeparator));
  return is_flag(option) ? "false" : option.get_default_str();
}

}  // namespace

std::string environment_name(const std::string& option) {
  return absl::StrCat("CURVECAST_", absl::AsciiStrToUpper(absl::StrReplaceAll(option, {{"-", "_"}})));
}

absl::StatusOr<std::vector<Setting>> configure(CLI::App& command, const std::string& file) {
  const std::map<std::string, CLI::Option*> options = configurable_options(command);
  std::map<std::string, Values> from_file;
  if (!file.empty()) {
    auto read = read_file(file, options);
    if (!read.ok()) return read.status();
    from_file = *std::move(read);
  }
  std::vector<Setting> settings;
  for (const auto& [name, option] : options) {
    const std::string variable = environment_name(name);
    const char* const value = std::getenv(variable.c_str());
    std::string source = "default";
    absl::Status status;
    if (option->count() > 0) {
      source = "flag";
    } else if (value != nullptr && *value != '\0') {
      source = variable;
      status = assign(*option, takes_several(*option) ? split(value) : Values{value}, source);
    } else if (const auto found = from_file.find(name); found != from_file.end() && found->second != Values{""}) {
      source = file;
      status = assign(*option, found->second, absl::StrCat(file, ": ", name));
    }
    if (!status.ok()) return status;
    settings.push_back({name, value_of(*option), std::move(source)});
  }
  return settings;
}

std::string to_configuration(const CLI::App& command) { return command.config_to_str(true, true); }

}  // namespace curvecast::cli
