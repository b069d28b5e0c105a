// Triangles on their way through repair, and where in the file each came from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/vec.h"

namespace curvecast {

struct FaceList {
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> corners;   // 3 F: the soup's corner; empty where nobody asks
  std::vector<std::uint32_t> polygons;  // F: the soup's polygon; empty while each face is the polygon of its own number

  /// Writes down which polygon each face is, where that is not written yet: before faces come and go.
  void note_polygons() {
    if (!polygons.empty()) return;
    polygons.resize(triangles.size());
    std::iota(polygons.begin(), polygons.end(), 0u);
  }
  /// Makes face `from` the face number `to`.
  void move(std::size_t from, std::size_t to) {
    triangles[to] = triangles[from];
    if (!polygons.empty()) polygons[to] = polygons[from];
    for (std::size_t i = 0; i < 3 && !corners.empty(); ++i) corners[3 * to + i] = corners[3 * from + i];
  }
  /// Adds the faces of another list of the same soup. Of both or neither is written which polygons they are.
  void append(const FaceList& more) {
    triangles.insert(triangles.end(), more.triangles.begin(), more.triangles.end());
    corners.insert(corners.end(), more.corners.begin(), more.corners.end());
    polygons.insert(polygons.end(), more.polygons.begin(), more.polygons.end());
  }
  /// Turns face f over.
  void flip(std::size_t f) {
    std::swap(triangles[f][1], triangles[f][2]);
    if (!corners.empty()) std::swap(corners[3 * f + 1], corners[3 * f + 2]);
  }
  /// Keeps the first `count` faces.
  void resize(std::size_t count) {
    triangles.resize(count);
    if (!polygons.empty()) polygons.resize(count);
    if (!corners.empty()) corners.resize(3 * count);
  }
};

}  // namespace curvecast
