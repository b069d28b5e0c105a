// Reads mesh files: PLY (ASCII, little and big endian, polygons and tristrips), OBJ, OFF, STL (ASCII and binary), glTF and GLB,
// 3MF, with the colours, normals, texture coordinates, materials and named values in them.
#pragma once

#include <absl/status/statusor.h>

#include <span>
#include <string_view>

#include "core/base/execution_context.h"
#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/reading/mesh_file.h"

namespace curvecast {

enum class MeshFormat { kPly, kObj, kOff, kStl, kGltf, kThreeMf };  // kGltf: JSON and GLB

/// Detects the format by the content's first bytes, else by the ending of `name`.
/// InvalidArgument when neither tells.
absl::StatusOr<MeshFormat> detect_mesh_format(std::string_view name, std::span<const char> bytes);

/// Parses a mesh file. Every message starts with its name, followed by the line (text, from 1) or the element (binary, from 0) at
/// fault.
///
/// Reads a mesh. The result has at least one polygon, every polygon at least three corners, every index < V, every coordinate
/// finite. InvalidArgument when the bytes don't hold that: empty or truncated file, index out of range, NaN or infinite
/// coordinate, no faces, malformed header. Cancelled when the context says so. ResourceExhausted when memory runs out; it
/// stays within a small multiple of bytes.size() and of unpacking_bytes(), whatever counts the file claims. Polygons of one or
/// two corners are dropped.
absl::StatusOr<PolygonSoup> read_mesh(const MeshFile& file, const ExecutionContext& context = {});

}  // namespace curvecast
