// Turns edges until the angles across each add up to no more than 180 degrees: what Delaunay's condition is on a surface.
// Source: Lawson, "Software for C1 surface interpolation" (1977), with angles measured in space.
#pragma once

#include <cstdint>
#include <vector>

#include "core/remesh/halfedge_mesh.h"

namespace curvecast {

class AngleFlips {
 public:
  /// Must not outlive the mesh.
  explicit AngleFlips(HalfedgeMesh& mesh) : mesh_(mesh) {}

  /// Has the edge of h looked at by the next run().
  void add(std::uint32_t h) { open_.push_back(h); }
  /// The edges around v, and those across its faces.
  void add_around(std::uint32_t v);
  void add_all();

  /// Turns edges that were added, and those around them as far as these are to be turned then. An edge is turned where the angles
  /// across it are too large, those across the turned one would not be, the topology allows it, and no triangle folds over.
  void run();

 private:
  bool wants_flip(std::uint32_t h) const;

  HalfedgeMesh& mesh_;
  std::vector<std::uint32_t> open_;
};

}  // namespace curvecast
