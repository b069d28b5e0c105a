#include "core/mesh_io/gltf/meshopt_view.h"

#include <absl/strings/str_format.h>
#include <meshoptimizer.h>

#include <cstddef>
#include <string_view>

#include "core/mesh_io/reading/companion_name.h"

namespace curvecast {
namespace {

enum class Mode { kAttributes, kTriangles, kIndices };

/// The most bytes that a compressed one can stand for: 16 values take two bits at least, a triangle or an index one byte.
std::uint64_t most_per_byte(Mode mode, std::uint64_t stride) {
  return mode == Mode::kAttributes ? 64 : mode == Mode::kTriangles ? 3 * stride : stride;
}

absl::StatusOr<Mode> mode_of(const GltfMeshopt& view) {
  if (view.mode == "ATTRIBUTES") return Mode::kAttributes;
  if (view.mode == "TRIANGLES") return Mode::kTriangles;
  if (view.mode == "INDICES") return Mode::kIndices;
  return absl::InvalidArgumentError(absl::StrFormat("there is no meshopt mode '%s'", display_name(view.mode)));
}

absl::Status check_filter(const GltfMeshopt& view, Mode mode) {
  if (view.filter.empty()) return absl::OkStatus();
  if (mode == Mode::kAttributes) {
    if (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) return absl::OkStatus();
    if (view.filter == "QUATERNION" && view.stride == 8) return absl::OkStatus();
    if (view.filter == "EXPONENTIAL") return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrFormat("there is no meshopt filter '%s' for elements of %d bytes in mode %s",
                                                    display_name(view.filter), view.stride, view.mode));
}

absl::Status check(const GltfMeshopt& view, Mode mode, std::uint64_t bytes) {
  constexpr std::uint64_t kMostStride = 256;
  const bool fits = mode == Mode::kAttributes ? view.stride > 0 && view.stride <= kMostStride && view.stride % 4 == 0
                                              : view.stride == 2 || view.stride == 4;
  if (!fits) {
    return absl::InvalidArgumentError(
        absl::StrFormat("its meshopt data has a byteStride of %d, which there is none of in mode %s", view.stride, view.mode));
  }
  if (mode == Mode::kTriangles && view.count % 3 != 0) {
    return absl::InvalidArgumentError(absl::StrFormat("its meshopt triangles have %d corners, no multiple of 3", view.count));
  }
  if (absl::Status status = check_filter(view, mode); !status.ok()) return status;
  if (view.count > UINT32_MAX || view.count * view.stride / most_per_byte(mode, view.stride) > bytes) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "its meshopt data claims %d elements of %d bytes, more than its %d bytes can hold", view.count, view.stride, bytes));
  }
  return absl::OkStatus();
}

void apply_filter(std::string_view filter, std::vector<char>& bytes, std::size_t count, std::size_t stride) {
  if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(bytes.data(), count, stride);
  if (filter == "QUATERNION") meshopt_decodeFilterQuat(bytes.data(), count, stride);
  if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(bytes.data(), count, stride);
}

}  // namespace

std::uint64_t most_meshopt_bytes(const GltfMeshopt& view) {
  const absl::StatusOr<Mode> mode = mode_of(view);
  return mode.ok() && check(view, *mode, view.length).ok() ? view.count * view.stride : 0;
}

absl::StatusOr<std::vector<char>> decode_meshopt(const GltfMeshopt& view, std::span<const char> bytes) {
  const absl::StatusOr<Mode> mode = mode_of(view);
  if (!mode.ok()) return mode.status();
  if (absl::Status status = check(view, *mode, bytes.size()); !status.ok()) return status;
  const std::size_t count = view.count, stride = view.stride;
  std::vector<char> out(count * stride);
  const auto* const from = reinterpret_cast<const unsigned char*>(bytes.data());
  int failed = 0;
  if (*mode == Mode::kAttributes) failed = meshopt_decodeVertexBuffer(out.data(), count, stride, from, bytes.size());
  if (*mode == Mode::kTriangles) failed = meshopt_decodeIndexBuffer(out.data(), count, stride, from, bytes.size());
  if (*mode == Mode::kIndices) failed = meshopt_decodeIndexSequence(out.data(), count, stride, from, bytes.size());
  if (failed != 0) return absl::InvalidArgumentError("its meshopt data is broken");
  // The library's filters take four elements at a time, the rest from a copy of its own.
  apply_filter(view.filter, out, count, stride);
  return out;
}

}  // namespace curvecast
