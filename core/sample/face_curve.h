// A curve over all faces of a mesh, without charts: from face to face as they follow one another in space, and through each of
// them by halves. Source of the curve in a face: Sierpinski, "Sur une nouvelle courbe continue qui remplit toute une aire plane"
// (1912).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// The way of the curve through a triangle, which it enters and leaves at the ends of one side; all of it passes parts in
/// proportion to their area.
class FaceWay {
 public:
  /// Along the longest side of a face, in the sense that goes rather along `direction` than against it.
  FaceWay(const TriangleMesh& mesh, std::uint32_t face, const Vec3d& direction);

  /// Weights of the face's second and third corner, where the curve has passed a part of the face, in [0, 1); the place is found
  /// by so many halvings, and on the middle of what is left.
  std::array<float, 2> at(double part, int halvings) const;

 private:
  Vec2d begin_, apex_, end_;  // weights
};

/// The mesh must outlive it. The same for any number of threads of the arena; to be dropped once the context is cancelled.
class FaceCurve {
 public:
  /// `largest`: faces of more area, in squared units, are divided by halves into pieces of this area at most, but no further than
  /// 2^kMostHalvings pieces; infinity: every face is one piece. Precondition: there are fewer than 2^32 pieces.
  explicit FaceCurve(const TriangleMesh& mesh, double largest, const ExecutionContext& context = {});

  static constexpr int kMostHalvings = 24;

  /// How many pieces there are, in the order of the curve.
  std::size_t size() const { return place_of_.size(); }
  std::uint32_t face(std::size_t piece) const { return order_[place_of_[piece]]; }
  double area(std::size_t piece) const;

  /// The way through one piece.
  struct Way {
    FaceWay way;
    double begin, share;  // of the piece in its face
    int halvings;         // that make the piece

    /// Weights on its face where the curve has passed a part of the piece, in [0, 1), found by so many more halvings.
    std::array<float, 2> at(double part, int more) const { return way.at(begin + part * share, halvings + more); }
  };
  Way way(std::size_t piece) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> order_;     // faces
  std::vector<std::uint32_t> begin_;     // F + 1: the first piece of each place in the order
  std::vector<std::uint32_t> place_of_;  // P: where in the order the piece's face is
};

}  // namespace curvecast
