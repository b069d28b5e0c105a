#include "core/mesh_io/three_mf/three_mf_reader.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/text_scanner.h"
#include "core/mesh_io/reading/companion_name.h"
#include "core/mesh_io/reading/mesh_reading.h"
#include "core/mesh_io/three_mf/three_mf_model.h"
#include "core/mesh_io/three_mf/xml_stream.h"
#include "core/mesh_io/three_mf/zip_archive.h"

namespace curvecast {
namespace {

constexpr std::string_view kRelations = "_rels/.rels", kEnding = ".model";

/// Finds the model part among the package's relations.
class RelationsParser : public XmlHandler {
 public:
  absl::Status start(const XmlName& name, const XmlAttributes& attributes) override {
    constexpr std::string_view kModel = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
    if (name.local == "Relationship" && attributes.find("Type") == kModel && target.empty()) {
      target = attributes.find("Target").value_or("");
    }
    return absl::OkStatus();
  }
  absl::Status end() override { return absl::OkStatus(); }

  std::string target;
};

absl::Status in_part(std::string_view part, const absl::Status& status) {
  if (status.ok() || absl::IsCancelled(status)) return status;
  return absl::Status(status.code(), absl::StrFormat("%s: %s", display_name(part), status.message()));
}

absl::Status parse_part(const ZipArchive& archive, const ZipEntry& entry, XmlHandler& handler,
                        const std::function<absl::Status(std::size_t bytes)>& on_block) {
  XmlStream stream(handler);
  absl::Status status = archive.read(entry, [&](std::span<const char> block) {
    absl::Status parsed = stream.take(block);
    return parsed.ok() ? on_block(block.size()) : parsed;
  });
  if (status.ok()) status = stream.finish();
  return in_part(entry.name, status);
}

/// The part that the package says is its model.
absl::StatusOr<const ZipEntry*> find_root(const ZipArchive& archive) {
  const ZipEntry* const relations = archive.find(kRelations);
  if (relations == nullptr) return absl::InvalidArgumentError("this is a ZIP archive, but no 3MF: it has no '_rels/.rels'");
  RelationsParser parser;
  absl::Status status = parse_part(archive, *relations, parser, [](std::size_t) { return absl::OkStatus(); });
  if (!status.ok()) return status;
  if (parser.target.empty()) return absl::InvalidArgumentError("this is a ZIP archive, but no 3MF: '_rels/.rels' names no model");
  std::string_view name = parser.target;
  if (name.starts_with('/')) name.remove_prefix(1);
  const ZipEntry* const root = archive.find(name);
  if (root != nullptr) return root;
  return absl::InvalidArgumentError(
      absl::StrFormat("the model '%s' is not in the archive, or is packed in a way that is not read", display_name(name)));
}

bool ends_as_model(std::string_view part) {
  return part.size() > kEnding.size() && equals_ignoring_case(part.substr(part.size() - kEnding.size()), kEnding);
}

/// Of all parts that may be read as models.
std::uint64_t unpacked_bytes(const ZipArchive& archive, const ZipEntry& root) {
  std::uint64_t sum = 0;
  for (const ZipEntry& entry : archive.entries()) {
    if (ends_as_model(entry.name) || &entry == &root) sum += entry.size;
  }
  return sum;
}

// How many there may be however small the file is.
constexpr std::uint64_t kElements = 4'000'000, kComponents = 250'000;

class ThreeMfReader {
 public:
  ThreeMfReader(const ExecutionContext& context, const ZipArchive& archive, const ZipEntry& root)
      : archive_(archive), root_(root), unpacked_(unpacked_bytes(archive, root)), monitor_(context, unpacked_) {
    soup_.polygon_begin.push_back(0);
  }

  absl::StatusOr<PolygonSoup> read() {
    const absl::StatusOr<const ThreeMfModel*> model = model_of(root_.name);
    if (!model.ok()) return model.status();
    // First counted, so that the soup takes what it needs and no more.
    std::uint64_t vertices = 0, triangles = 0;
    const auto count = [&](const ThreeMfObject& object, std::uint32_t, const Eigen::Affine3d&) {
      absl::Status status = check_room(vertices += object.positions.size(), "vertices");
      status.Update(check_room(triangles += object.triangles.size(), "triangles"));
      return status;
    };
    if (absl::Status status = place_all(**model, count); !status.ok()) return status;
    soup_.positions.reserve(vertices);
    soup_.indices.reserve(3 * triangles);
    soup_.polygon_begin.reserve(triangles + 1);
    const auto add = [this](const ThreeMfObject& object, std::uint32_t id, const Eigen::Affine3d& world) {
      return add_object(object, id, world);
    };
    if (absl::Status status = place_all(**model, add); !status.ok()) return status;
    MeshAttributes& attributes = soup_.attributes;
    if (!attributes.face_colours.empty()) attributes.face_colours.resize(soup_.polygon_count());
    if (attributes.materials.empty()) {
      attributes.material_of_face.clear();
    } else {
      attributes.material_of_face.resize(soup_.polygon_count(), MeshAttributes::kNoMaterial);
    }
    return std::move(soup_);
  }

 private:
  /// Parses the part when it is first asked for. Names differ in case, and parts are still the same.
  absl::StatusOr<const ThreeMfModel*> model_of(const std::string& part) {
    const ThreeMfModel*& model = model_by_name_[part];
    if (model != nullptr) return model;
    const ZipEntry* const entry = archive_.find(part);
    if (entry == nullptr)
      return absl::InvalidArgumentError(absl::StrFormat("the part '%s' is not in the archive", display_name(part)));
    if (entry != &root_ && !ends_as_model(part)) {
      return absl::InvalidArgumentError(absl::StrFormat("the part '%s' is no model by its name", display_name(part)));
    }
    const auto [parsed, is_new] = models_.try_emplace(entry->index);
    model = &parsed->second;
    if (!is_new) return model;
    ThreeMfParser parser(parsed->second, soup_.attributes.materials, soup_.warnings);
    const absl::Status status = parse_part(archive_, *entry, parser, [&](std::size_t bytes) {
      done_ += bytes;
      return monitor_.look(done_) ? absl::OkStatus() : monitor_.status();
    });
    if (!status.ok()) return status;
    return model;
  }

  using Visit = std::function<absl::Status(const ThreeMfObject& object, std::uint32_t id, const Eigen::Affine3d& world)>;

  /// Visits every object that the build of the root model shows, as often as it does.
  absl::Status place_all(const ThreeMfModel& model, const Visit& visit) {
    instances_ = 0;
    for (const ThreeMfInstance& item : model.build) {
      if (absl::Status status = place(item, model, root_.name, Eigen::Affine3d::Identity(), 0, visit); !status.ok())
        return status;
    }
    return absl::OkStatus();
  }

  absl::Status place(const ThreeMfInstance& instance, const ThreeMfModel& model, const std::string& part,
                     const Eigen::Affine3d& parent, int level, const Visit& visit) {
    constexpr int kMostLevels = 32;
    if (level == kMostLevels) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "object %d: components are nested deeper than %d levels; is one a part of itself?", instance.object, kMostLevels));
    }
    if (absl::Status status = check_room(++instances_, "components", kComponents); !status.ok()) return status;
    if (!monitor_.tick(done_)) return monitor_.status();
    const std::string& named = model.parts[instance.part];
    const std::string& home = named.empty() ? part : named;
    const absl::StatusOr<const ThreeMfModel*> owner = named.empty() ? &model : model_of(named);
    if (!owner.ok()) return owner.status();
    const auto found = (*owner)->objects.find(instance.object);
    if (found == (*owner)->objects.end()) {
      return absl::InvalidArgumentError(absl::StrFormat("%s: there is no object %d", display_name(home), instance.object));
    }
    const Eigen::Affine3d world = instance.transform != nullptr ? parent * *instance.transform : parent;
    if (absl::Status status = visit(found->second, instance.object, world); !status.ok()) return status;
    for (const ThreeMfInstance& component : found->second.components) {
      if (absl::Status status = place(component, **owner, home, world, level + 1, visit); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status add_object(const ThreeMfObject& object, std::uint32_t id, const Eigen::Affine3d& world) {
    const std::size_t first = soup_.positions.size(), faces = soup_.polygon_count();
    for (std::size_t i = 0; i < object.positions.size(); ++i) {
      if (!monitor_.tick(done_)) return monitor_.status();
      const Vec3d p = world * object.positions[i];
      if (!is_finite(p)) return absl::InvalidArgumentError(absl::StrFormat("object %d, vertex %d: %s", id, i, kNotFinite));
      soup_.positions.push_back(p);
    }
    const bool mirrored = world.linear().determinant() < 0;
    for (std::array<std::uint32_t, 3> triangle : object.triangles) {
      if (!monitor_.tick(done_)) return monitor_.status();
      if (mirrored) std::swap(triangle[1], triangle[2]);
      for (const std::uint32_t vertex : triangle) soup_.indices.push_back(static_cast<std::uint32_t>(first + vertex));
      soup_.polygon_begin.push_back(static_cast<std::uint32_t>(soup_.indices.size()));
    }
    add_looks(object.looks, faces);
    return absl::OkStatus();
  }

  void add_looks(const std::vector<ThreeMfLook>& looks, std::size_t faces) {
    MeshAttributes& attributes = soup_.attributes;
    const auto differs = [](const ThreeMfLook& look) { return look.colour != Rgba8{}; };
    if (std::any_of(looks.begin(), looks.end(), differs)) {
      attributes.face_colours.reserve(soup_.polygon_begin.capacity());
      attributes.face_colours.resize(faces);
      for (const ThreeMfLook& look : looks) attributes.face_colours.push_back(look.colour);
    }
    if (looks.empty()) return;
    attributes.material_of_face.reserve(soup_.polygon_begin.capacity());
    attributes.material_of_face.resize(faces, MeshAttributes::kNoMaterial);
    for (const ThreeMfLook& look : looks) attributes.material_of_face.push_back(look.material);
  }

  // Components and items can repeat a mesh any number of times.
  absl::Status check_room(std::uint64_t count, std::string_view what, std::uint64_t anyway = kElements) const {
    constexpr std::uint64_t kBytesEach = 4;
    const std::uint64_t most = std::min<std::uint64_t>(anyway + unpacked_ / kBytesEach, UINT32_MAX / 3);
    if (count <= most) return absl::OkStatus();
    return absl::InvalidArgumentError(
        absl::StrFormat("the build repeats its objects until it has more than %d %s; split it", most, what));
  }

  const ZipArchive& archive_;
  const ZipEntry& root_;
  const std::uint64_t unpacked_;
  ReadMonitor monitor_;
  std::size_t done_ = 0;  // bytes
  std::uint64_t instances_ = 0;
  PolygonSoup soup_;
  std::map<std::uint64_t, ThreeMfModel> models_;              // by entry of the archive
  std::map<std::string, const ThreeMfModel*> model_by_name_;  // of the part
};

}  // namespace

std::uint64_t three_mf_unpacked_bytes(std::span<const char> bytes) {
  const absl::StatusOr<ZipArchive> archive = ZipArchive::open(bytes);
  if (!archive.ok()) return 0;
  const absl::StatusOr<const ZipEntry*> root = find_root(*archive);
  return root.ok() ? unpacked_bytes(*archive, **root) : 0;
}

absl::StatusOr<PolygonSoup> read_three_mf(const MeshFile& file, const ExecutionContext& context) {
  const absl::StatusOr<ZipArchive> archive = ZipArchive::open(file.bytes);
  if (!archive.ok()) return archive.status();
  const absl::StatusOr<const ZipEntry*> root = find_root(*archive);
  if (!root.ok()) return root.status();
  return ThreeMfReader(context, *archive, **root).read();
}

}  // namespace curvecast
