// The faces of most binary PLY files, read in runs: triangles, all of the same size.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/mesh/polygon_soup.h"
#include "core/mesh_io/ply_columns.h"
#include "core/mesh_io/ply_header.h"

namespace curvecast {

/// What of a face is taken, by the numbers of its properties.
struct PlyFaceLayout {
  static constexpr std::size_t kNotThere = SIZE_MAX;

  std::size_t indices = kNotThere;
  std::size_t texcoord = kNotThere;  // list of u and v of each corner
  std::vector<PlyColumn> columns = {};
};

/// Texture coordinates for the soup's corners from `first` on: zero where there are too few, and for those before without any.
inline void append_uv(PolygonSoup& soup, std::size_t first, const std::vector<Vec2f>& uv) {
  soup.attributes.uv.resize(first, Vec2f::Zero());
  const std::size_t count = std::min(uv.size(), soup.indices.size() - first);
  soup.attributes.uv.insert(soup.attributes.uv.end(), uv.begin(), uv.begin() + static_cast<std::ptrdiff_t>(count));
}

/// Plain faces have a list of indices (1-byte length, 4-byte indices), maybe one of texture coordinates (1-byte length, float),
/// and else scalars only.
class PlyPlainFaces {
 public:
  PlyPlainFaces() = default;
  PlyPlainFaces(const PlyElement& element, const PlyFaceLayout& layout, std::uint64_t vertices) {
    if (vertices == 0) return;
    std::size_t size = 0;
    columns_ = layout.columns;
    for (std::size_t j = 0; j < element.properties.size(); ++j) {
      const PlyProperty& property = element.properties[j];
      const bool is_indices = j == layout.indices;
      const bool is_texcoord = j == layout.texcoord;
      if (property.is_list && !is_indices && !is_texcoord) return;
      if (property.is_list && (ply_type_bytes(property.count_type) != 1 || ply_type_bytes(property.type) != 4)) return;
      if (is_texcoord && property.type != PlyType::kFloat32) return;
      if (is_indices) indices_ = size;
      if (is_texcoord) texcoord_ = size;
      for (PlyColumn& column : columns_) {
        if (column.property == j) column.offset = size;
      }
      size += is_indices ? 1 + 3 * 4 : is_texcoord ? 1 + 6 * 4 : ply_type_bytes(property.type);
    }
    const bool negative = element.properties[layout.indices].type == PlyType::kInt32;
    largest_index_ = std::min<std::uint64_t>(vertices - 1, negative ? INT32_MAX : UINT32_MAX);
    size_ = size;
  }

  /// Takes the run of triangles that comes next, at most `most`; returns how many. 0 when a polygon, a fault or the end comes
  /// next, to be looked at one by one, and always when the faces are not plain.
  template <class Source>
  std::size_t read(Source& source, PolygonSoup& soup, std::uint64_t most) {
    if (size_ == 0) return 0;
    constexpr std::uint64_t kLongestRun = 4096;  // small enough to be still in the cache the second time
    const std::size_t room = std::min({most, kLongestRun, source.remaining() / size_, (UINT32_MAX - soup.indices.size()) / 3});
    const char* const elements = source.data();
    const char* const p = elements + indices_;
    const bool has_uv = texcoord_ != PlyFaceLayout::kNotThere;
    const auto is_plain = [&](std::size_t i) { return p[i * size_] == 3 && (!has_uv || elements[i * size_ + texcoord_] == 6); };
    std::size_t run = 0;
    while (run < room && is_plain(run)) ++run;
    const std::size_t old_size = soup.indices.size();
    soup.indices.resize(old_size + 3 * run);
    std::uint32_t largest = 0;
    for (std::size_t i = 0; i < run; ++i) {
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t index = Source::template at<std::uint32_t>(p + i * size_ + 1 + 4 * corner);
        largest = std::max(largest, index);
        soup.indices[old_size + 3 * i + corner] = index;
      }
    }
    if (largest > largest_index_) {
      soup.indices.resize(old_size);
      return 0;
    }
    for (const PlyColumn& column : columns_) copy_column<Source>(column, elements, size_, soup.polygon_count(), run);
    if (has_uv) {
      uv_.clear();
      for (std::size_t i = 0; i < run; ++i) {
        const char* const q = elements + i * size_ + texcoord_ + 1;
        for (int corner = 0; corner < 3; ++corner) {
          uv_.emplace_back(Source::template at<float>(q + 8 * corner), Source::template at<float>(q + 8 * corner + 4));
        }
      }
      append_uv(soup, old_size, uv_);
    }
    for (std::size_t i = 1; i <= run; ++i) soup.polygon_begin.push_back(static_cast<std::uint32_t>(old_size + 3 * i));
    source.advance(run * size_);
    return run;
  }

 private:
  std::size_t size_ = 0;                             // of a triangle, bytes; 0: not plain
  std::size_t indices_ = 0;                          // offset of the list
  std::size_t texcoord_ = PlyFaceLayout::kNotThere;  // the same
  std::uint64_t largest_index_ = 0;
  std::vector<PlyColumn> columns_;
  std::vector<Vec2f> uv_;  // of the run at hand
};

}  // namespace curvecast
