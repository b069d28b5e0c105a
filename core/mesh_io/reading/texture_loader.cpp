#include "core/mesh_io/reading/texture_loader.h"

#include <absl/strings/str_format.h>

#include <new>
#include <utility>

#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/texture_image.h"

namespace curvecast {

void add_warning(std::vector<std::string>& warnings, std::string sentence) {
  constexpr std::size_t kMost = 32;
  if (warnings.size() < kMost) {
    warnings.push_back(std::move(sentence));
  } else if (warnings.size() == kMost) {
    warnings.emplace_back("There are more warnings than these.");
  }
}

void add_warning(std::vector<std::string>& warnings, std::size_t line, std::string_view message) {
  add_warning(warnings, absl::StrFormat("line %d: %s", line, message));
}

std::shared_ptr<const Image> TextureLoader::load(std::string_view written, std::string_view parent, std::string_view where) {
  const std::optional<std::string> name = safe_companion_name(written, parent);
  if (!name) {
    add_warning(warnings_,
                absl::StrFormat("%s: the texture's name '%s' is not a name of a file beside the mesh, so it is left out.", where,
                                display_name(written)));
    return nullptr;
  }
  const auto [known, is_new] = known_.try_emplace(*name);
  if (!is_new) return known->second;
  const auto bytes = file_.companion ? file_.companion(*name) : std::nullopt;
  if (!bytes) {
    add_warning(warnings_, absl::StrFormat("%s: the texture '%s' is not there, so it is left out.", where, *name));
    return nullptr;
  }
  return known->second = decode(*bytes, *name, where);
}

std::shared_ptr<const Image> TextureLoader::decode(std::span<const char> bytes, std::string_view name, std::string_view where) {
  absl::StatusOr<Image> image;
  try {
    image = decode_texture(bytes, pixels_left_);
  } catch (const std::bad_alloc&) {
    image = absl::ResourceExhaustedError("needs more memory than there is");
  }
  if (!image.ok()) {
    add_warning(warnings_, absl::StrFormat("%s: the texture '%s' %s, so it is left out.", where, name, image.status().message()));
    return nullptr;
  }
  pixels_left_ -= image->rgba.size() / 4;
  return std::make_shared<const Image>(*std::move(image));
}

}  // namespace curvecast
