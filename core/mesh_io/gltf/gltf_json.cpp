#include "core/mesh_io/gltf/gltf_json.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace curvecast {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostLevels = 64;
constexpr int kMostValues = 2'000'000;

bool is_useless(std::string_view key) {
  constexpr std::string_view kUseless[] = {"extras", "animations", "skins", "cameras", "targets", "weights", "samplers"};
  return std::find(std::begin(kUseless), std::end(kUseless), key) != std::end(kUseless);
}

/// Builds the tree as the parser goes. The library's own way to leave values out goes over all siblings of each: quadratic time.
class TreeBuilder : public nlohmann::json_sax<Json> {
 public:
  Json root;
  std::string fault;  // empty: none
  std::size_t fault_at = 0;

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(Json::number_integer_t value) override { return put(value); }
  bool number_unsigned(Json::number_unsigned_t value) override { return put(value); }
  bool number_float(Json::number_float_t value, const std::string&) override { return put(value); }
  bool string(std::string& value) override { return put(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }  // no such thing in a text
  bool key(std::string& name) override {
    if (skipped_levels_ == 0) skip_next_ = is_useless(name);
    key_ = std::move(name);
    return true;
  }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
    fault_at = position;
    // Else a number beyond what can be kept.
    return fail(dynamic_cast<const Json::parse_error*>(&error) != nullptr ? "the JSON is malformed"
                                                                          : "the JSON holds a number out of range");
  }

 private:
  bool fail(std::string why) {
    fault = std::move(why);
    return false;
  }

  /// Where the value went; null when it is left out.
  Json* place(Json value) {
    if (std::exchange(skip_next_, false) || skipped_levels_ > 0) return nullptr;
    if (stack_.empty()) return &(root = std::move(value));
    Json& parent = *stack_.back();
    if (parent.is_object()) return &(parent[key_] = std::move(value));
    parent.push_back(std::move(value));
    return &parent.back();
  }

  bool put(Json value) {
    if (++values_ > kMostValues) return fail(absl::StrFormat("the JSON has more than %d values; split the scene", kMostValues));
    place(std::move(value));
    return true;
  }

  bool open(Json value) {
    if (++values_ > kMostValues) return fail(absl::StrFormat("the JSON has more than %d values; split the scene", kMostValues));
    if (stack_.size() + skipped_levels_ == kMostLevels) {
      return fail(absl::StrFormat("the JSON is nested deeper than %d levels", kMostLevels));
    }
    Json* const opened = place(std::move(value));
    opened == nullptr ? void(++skipped_levels_) : stack_.push_back(opened);
    return true;
  }

  bool close() {
    skipped_levels_ > 0 ? void(--skipped_levels_) : stack_.pop_back();
    return true;
  }

  std::vector<Json*> stack_;  // what is open; stays where it is, because only the innermost grows
  std::size_t skipped_levels_ = 0;
  bool skip_next_ = false;
  std::string key_;
  int values_ = 0;
};

}  // namespace

absl::StatusOr<Json> parse_gltf_json(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  TreeBuilder builder;
  if (!Json::sax_parse(text, &builder)) {
    if (builder.fault_at == 0) return absl::InvalidArgumentError(builder.fault);
    const std::string_view before = text.substr(0, std::min(builder.fault_at, text.size()));
    return absl::InvalidArgumentError(
        absl::StrFormat("line %d: %s", 1 + std::count(before.begin(), before.end(), '\n'), builder.fault));
  }
  if (!builder.root.is_object()) return absl::InvalidArgumentError("line 1: a glTF file holds a JSON object");
  return std::move(builder.root);
}

const Json* gltf_member(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::string gltf_string(const Json& object, const char* key) {
  const Json* const value = gltf_member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

std::int64_t gltf_number(const Json& object, const char* key) {
  const Json* const value = gltf_member(object, key);
  return value != nullptr && value->is_number_integer() ? value->get<std::int64_t>() : -1;
}

}  // namespace curvecast
