// Points with all columns, and readers of bytes that have nothing in common with the writers.
#pragma once

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// Points of a unit sphere, evenly spread, whose ranks are a permutation that leaves none but the first where it was.
class SpherePoints {
 public:
  explicit SpherePoints(std::size_t count);

  /// All columns; they live as long as this.
  PointColumns columns() const;
  /// Returns the point that has this rank, which is the one that a file should have there.
  std::size_t with_rank(std::size_t rank) const { return points_[rank]; }

  std::vector<std::array<float, 3>> positions, normals, directions;
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::array<float, 2>> curvatures, barycentric;
  std::vector<float> radii, heights;
  std::vector<std::uint32_t> ranks, faces;

 private:
  std::vector<std::size_t> points_;  // by rank
};

/// Takes one number after the other; past the end they are 0, and `failed` is set.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Number>
  Number next() {
    Number number{};
    if (bytes_.size() < at_ + sizeof(Number)) {
      failed_ = true;
      return number;
    }
    std::memcpy(&number, bytes_.data() + at_, sizeof(Number));
    at_ += sizeof(Number);
    return number;
  }
  std::string text(std::size_t length);  // up to the first NUL of these bytes
  void skip(std::size_t bytes) { at_ += bytes; }
  std::size_t at() const { return at_; }
  bool at_end() const { return !failed_ && at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

}  // namespace curvecast::formats
