#include "core/mesh_io/mesh_companions.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/gltf/gltf_document.h"
#include "core/mesh_io/mesh_io.h"
#include "core/mesh_io/mtl_reader.h"
#include "core/mesh_io/ply_header.h"
#include "core/mesh_io/reading/companion_name.h"

namespace curvecast {
namespace {

/// Notes names that are asked for; answers with the bytes of those that are there.
class Collector {
 public:
  explicit Collector(const MeshFile& file) : file_(file) {}

  bool full() const { return missing_.size() >= kMaxCompanions; }
  std::optional<std::span<const char>> want(std::optional<std::string> name) {
    if (!name || full() || !seen_.insert(*name).second) return std::nullopt;
    std::optional<std::span<const char>> bytes;
    if (file_.companion) bytes = file_.companion(*name);
    if (!bytes) missing_.push_back(*std::move(name));
    return bytes;
  }
  std::vector<std::string> take() { return std::move(missing_); }

 private:
  const MeshFile& file_;
  std::set<std::string> seen_;
  std::vector<std::string> missing_;
};

void collect_obj(std::string_view text, Collector& collector) {
  constexpr std::string_view kKeyword = "mtllib";
  const std::boyer_moore_horspool_searcher searcher(kKeyword.begin(), kKeyword.end());
  for (std::size_t at = 0; !collector.full();) {
    const auto found = std::search(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), searcher);
    if (found == text.end()) return;
    const auto begin = static_cast<std::size_t>(found - text.begin());
    at = begin + kKeyword.size();
    std::size_t line = begin;  // a keyword stands first in its line
    while (line > 0 && (text[line - 1] == ' ' || text[line - 1] == '\t')) --line;
    if (line > 0 && text[line - 1] != '\n' && text[line - 1] != '\r') continue;
    for (const std::string_view written : library_names(TextScanner(text.substr(at)).line_rest())) {
      const std::optional<std::string> library = safe_companion_name(written);
      const auto bytes = collector.want(library);
      if (!bytes) continue;
      for (const MtlMaterial& material : read_mtl({bytes->data(), bytes->size()})) {
        if (!material.texture.empty()) collector.want(safe_companion_name(material.texture, *library));
      }
    }
  }
}

void collect_ply(const PlyHeader& header, Collector& collector) {
  for (const PlyTexture& texture : header.textures) collector.want(safe_companion_name(texture.name));
}

void collect_gltf(const GltfDocument& document, Collector& collector) {
  for (const GltfSource& buffer : document.buffers) {
    if (!buffer.file.empty()) collector.want(safe_companion_name(buffer.file));
  }
  for (const GltfSource& image : document.images) {
    if (image.is_base_colour && !image.file.empty()) collector.want(safe_companion_name(image.file));
  }
}

}  // namespace

absl::StatusOr<std::vector<std::string>> mesh_companions(const MeshFile& file) {
  const absl::StatusOr<MeshFormat> format = detect_mesh_format(file.name, file.bytes);
  if (!format.ok()) return format.status();
  Collector collector(file);
  if (*format == MeshFormat::kObj) {
    collect_obj(file.text(), collector);
  } else if (*format == MeshFormat::kPly) {
    // What is wrong with a header is for the reader to say.
    if (const absl::StatusOr<PlyHeader> header = parse_ply_header(file.text()); header.ok()) collect_ply(*header, collector);
  } else if (*format == MeshFormat::kGltf) {
    if (const absl::StatusOr<GltfDocument> document = parse_gltf(file.text()); document.ok()) collect_gltf(*document, collector);
  }
  return collector.take();
}

}  // namespace curvecast
