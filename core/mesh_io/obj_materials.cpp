#include "core/mesh_io/obj_materials.h"

#include <absl/strings/str_format.h>

#include <optional>
#include <set>

#include "core/mesh_io/mtl_reader.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/texture_loader.h"

namespace curvecast {

std::uint32_t ObjMaterials::use(std::string_view rest_of_line, std::size_t line) {
  const std::string_view name = trimmed(rest_of_line);
  const auto [known, is_new] = number_of_.try_emplace(name, static_cast<std::uint32_t>(used_.size()));
  if (is_new) used_.push_back({name, line});
  return known->second;
}

std::vector<Material> ObjMaterials::resolve(const MeshFile& file, std::vector<std::string>& warnings) const {
  std::vector<Material> materials(used_.size());
  std::vector<bool> described(used_.size(), false);
  for (std::size_t i = 0; i < used_.size(); ++i) materials[i].name = display_name(used_[i].text);
  TextureLoader textures(file, warnings);
  std::set<std::string> seen;
  bool all_there = true;
  for (const Place& statement : libraries_) {
    for (const std::string_view written : library_names(statement.text)) {
      const std::optional<std::string> library = safe_companion_name(written);
      if (library && !seen.insert(*library).second) continue;
      const auto bytes = library && file.companion ? file.companion(*library) : std::nullopt;
      if (!bytes) {
        all_there = false;
        add_warning(
            warnings, statement.line,
            absl::StrFormat("the material library '%s' is not there, so its materials are white.", display_name(written)));
        continue;
      }
      for (const MtlMaterial& found : read_mtl({bytes->data(), bytes->size()})) {
        const auto wanted = number_of_.find(found.name);
        if (wanted == number_of_.end() || described[wanted->second]) continue;
        described[wanted->second] = true;
        Material& material = materials[wanted->second];
        material.colour = found.colour;
        if (found.texture.empty()) continue;
        material.texture = textures.load(found.texture, *library, absl::StrFormat("line %d of %s", found.line, *library));
      }
    }
  }
  for (std::size_t i = 0; i < used_.size() && all_there && !libraries_.empty(); ++i) {
    if (described[i] || used_[i].text.empty()) continue;
    add_warning(warnings, used_[i].line,
                absl::StrFormat("the material '%s' is in none of the material libraries, so it is white.", materials[i].name));
  }
  return materials;
}

}  // namespace curvecast
