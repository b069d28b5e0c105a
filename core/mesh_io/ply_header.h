// The header of a PLY file: which elements with which properties follow, and how they are written.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace curvecast {

enum class PlyFormat { kAscii, kBinaryLittleEndian, kBinaryBigEndian };
enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string_view name;
  PlyType type{};  // of the scalar, or of a list's items
  bool is_list = false;
  PlyType count_type{};  // of a list's length; an integer type
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

/// A line "comment TextureFile NAME", as MeshLab writes it.
struct PlyTexture {
  std::string_view name;
  std::size_t line = 0;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  std::vector<PlyTexture> textures;
  std::size_t body_offset = 0;  // bytes
  std::size_t body_line = 1;    // number of the line there, for text
};

std::size_t ply_type_bytes(PlyType type);
inline bool is_integer(PlyType type) { return type < PlyType::kFloat32; }

/// Reads a header, whose names point into `bytes`. InvalidArgument, starting with the line, when the header is malformed or has
/// no end.
absl::StatusOr<PlyHeader> parse_ply_header(std::string_view bytes);

}  // namespace curvecast
