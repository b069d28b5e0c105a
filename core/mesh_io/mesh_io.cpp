#include "core/mesh_io/mesh_io.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "core/base/text_scanner.h"
#include "core/mesh_io/gltf/gltf_document.h"
#include "core/mesh_io/gltf/gltf_reader.h"
#include "core/mesh_io/obj_reader.h"
#include "core/mesh_io/off_reader.h"
#include "core/mesh_io/ply_reader.h"
#include "core/mesh_io/stl_reader.h"
#include "core/mesh_io/three_mf/three_mf_reader.h"
#include "core/mesh_io/three_mf/zip_archive.h"

namespace curvecast {
namespace {

bool is_obj_keyword(std::string_view word) {
  constexpr std::string_view kKeywords[] = {"v", "vn", "vt", "vp", "f", "l", "p", "o", "g", "s", "mtllib", "usemtl"};
  return std::find(std::begin(kKeywords), std::end(kKeywords), word) != std::end(kKeywords);
}

std::optional<MeshFormat> format_by_content(std::string_view bytes) {
  if (bytes.size() > 3 && bytes.starts_with("ply") && (bytes[3] == '\n' || bytes[3] == '\r')) return MeshFormat::kPly;
  if (is_binary_stl(bytes)) return MeshFormat::kStl;
  if (is_zip(bytes)) return MeshFormat::kThreeMf;
  if (is_gltf(bytes)) return MeshFormat::kGltf;
  TextScanner scanner(bytes);
  scanner.skip_space_and_comments('#');
  const std::string_view word = scanner.peek_word();
  if (is_off_keyword(word)) return MeshFormat::kOff;
  if (equals_ignoring_case(word, "solid")) return MeshFormat::kStl;
  if (is_obj_keyword(word)) return MeshFormat::kObj;
  return std::nullopt;
}

std::optional<MeshFormat> format_by_ending(std::string_view name) {
  constexpr std::pair<std::string_view, MeshFormat> kEndings[] = {
      {".ply", MeshFormat::kPly},   {".obj", MeshFormat::kObj},  {".off", MeshFormat::kOff},    {".stl", MeshFormat::kStl},
      {".gltf", MeshFormat::kGltf}, {".glb", MeshFormat::kGltf}, {".3mf", MeshFormat::kThreeMf}};
  for (const auto& [ending, format] : kEndings) {
    if (name.size() >= ending.size() && equals_ignoring_case(name.substr(name.size() - ending.size()), ending)) return format;
  }
  return std::nullopt;
}

absl::StatusOr<PolygonSoup> read_as(MeshFormat format, const MeshFile& file, const ExecutionContext& context) {
  const std::string_view bytes = file.text();
  switch (format) {
    case MeshFormat::kPly:
      return read_ply(file, context);
    case MeshFormat::kObj:
      return read_obj(file, context);
    case MeshFormat::kOff:
      return read_off(bytes, context);
    case MeshFormat::kStl:
      return read_stl(bytes, context);
    case MeshFormat::kGltf:
      return read_gltf(file, context);
    case MeshFormat::kThreeMf:
      return read_three_mf(file, context);
  }
  return absl::InternalError("unknown mesh format");
}

absl::Status error_in(std::string_view name, absl::StatusCode code, absl::string_view message) {
  return absl::Status(code, absl::StrFormat("%s: %s", name, message));
}

}  // namespace

absl::StatusOr<MeshFormat> detect_mesh_format(std::string_view name, std::span<const char> bytes) {
  std::optional<MeshFormat> format = format_by_content({bytes.data(), bytes.size()});
  if (!format) format = format_by_ending(name);
  if (format) return *format;
  return error_in(name, absl::StatusCode::kInvalidArgument,
                  "neither the content nor the name tells the format; give a PLY, OBJ, OFF, STL, glTF, GLB or 3MF file");
}

absl::StatusOr<PolygonSoup> read_mesh(const MeshFile& file, const ExecutionContext& context) {
  if (file.bytes.empty()) return error_in(file.name, absl::StatusCode::kInvalidArgument, "the file is empty");
  if (absl::Status status = context.check(); !status.ok()) return status;
  const absl::StatusOr<MeshFormat> format = detect_mesh_format(file.name, file.bytes);
  if (!format.ok()) return format.status();
  try {
    context.progress("read", 0);
    absl::StatusOr<PolygonSoup> soup = read_as(*format, file, context);
    if (!soup.ok()) {
      if (absl::IsCancelled(soup.status())) return soup;
      return error_in(file.name, soup.status().code(), soup.status().message());
    }
    if (soup->polygon_count() == 0) {
      return error_in(file.name, absl::StatusCode::kInvalidArgument,
                      absl::StrFormat("no faces: none of its polygons has three or more corners (the file has %d vertices)",
                                      soup->positions.size()));
    }
    context.progress("read", 1);
    return soup;
  } catch (const std::bad_alloc&) {
    return error_in(file.name, absl::StatusCode::kResourceExhausted, "not enough memory to read the file");
  } catch (const std::length_error&) {
    return error_in(file.name, absl::StatusCode::kResourceExhausted, "not enough memory to read the file");
  }
}

}  // namespace curvecast
