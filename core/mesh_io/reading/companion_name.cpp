#include "core/mesh_io/reading/companion_name.h"

#include <absl/strings/escaping.h>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace curvecast {
namespace {

constexpr std::size_t kLongestPath = 255;
constexpr std::size_t kLongestName = 128;

// Bytes of the UTF-8 sequence at `text`'s start; 0 where there is none (overlong forms and surrogates too).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  const std::size_t length = first < 0x80 ? 1 : first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
  if (length == 0 || length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F)) return 0;
  if ((first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F)) return 0;
  return length;
}

}  // namespace

bool is_plain_text(std::string_view text) {
  while (!text.empty()) {
    const auto c = static_cast<std::uint8_t>(text.front());
    const std::size_t length = utf8_length(text);
    if (length == 0 || c < 0x20 || c == 0x7F) return false;
    if (c == 0xC2 && static_cast<std::uint8_t>(text[1]) < 0xA0) return false;  // U+0080 .. U+009F are controls too
    text.remove_prefix(length);
  }
  return true;
}

std::optional<std::string> safe_companion_name(std::string_view name) {
  if (name.size() > 16 * kLongestPath || !is_plain_text(name)) return std::nullopt;
  std::vector<std::string_view> components;
  // A slash in front, a drive's or protocol's colon, or a way up: only the last component can be meant for here.
  bool whole = !name.starts_with('/') && !name.starts_with('\\');
  while (!name.empty()) {
    const std::size_t end = std::min(name.find_first_of("/\\:"), name.size());
    const std::string_view component = name.substr(0, end);
    if (end < name.size() && name[end] == ':') whole = false;
    if (component == "..") whole = false;
    if (!component.empty() && component != ".") components.push_back(component);
    name.remove_prefix(std::min(end + 1, name.size()));
  }
  if (components.empty() || components.back() == "..") return std::nullopt;
  if (!whole) components.erase(components.begin(), components.end() - 1);
  std::string safe;
  for (const std::string_view component : components) {
    if (!safe.empty()) safe += '/';
    safe += component;
  }
  if (safe.size() > kLongestPath) return std::nullopt;
  return safe;
}

std::optional<std::string> safe_companion_name(std::string_view name, std::string_view parent) {
  std::optional<std::string> safe = safe_companion_name(name);
  const std::size_t slash = parent.rfind('/');
  if (!safe || slash == std::string_view::npos) return safe;
  return safe_companion_name(std::string(parent.substr(0, slash + 1)) + *safe);
}

std::string display_name(std::string_view name) {
  std::size_t length = std::min(name.size(), kLongestName);
  if (is_plain_text(name)) {
    while (length < name.size() && length > 0 && (static_cast<std::uint8_t>(name[length]) & 0xC0) == 0x80) --length;
    return std::string(name.substr(0, length));
  }
  return absl::CHexEscape({name.data(), length});
}

}  // namespace curvecast
