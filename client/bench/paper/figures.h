// Which pictures each figure has, and what their captions say.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <string>
#include <vector>

#include "client/bench/paper/hosted_mesh.h"
#include "client/bench/paper/paper_report.h"
#include "core/base/execution_context.h"
#include "core/base/image.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast::cli::bench {

/// Collects pictures, and tells how far it is. Errors as of Pictures; Cancelled.
class Figures {
 public:
  /// `side`: of the pictures, pixels. The context outlives it.
  Figures(int side, const ExecutionContext& context) : side_(side), context_(context) {}

  /// Figure 1's left half and figure 6. `square`: square_obj(). Adds the numbers of figure 6 to `squares`.
  absl::Status draw_square(const HostedMesh& square, std::size_t points, std::vector<SquareDiscs>& squares);
  /// Figure 8. `sphere`: sphere_off().
  absl::Status draw_sphere(const HostedMesh& sphere);
  /// Figure 1's right half, 2 and 7, of one mesh. `original`: the same mesh, repaired.
  absl::Status draw_stages(const HostedMesh& mesh, const TriangleMesh& original, const std::string& name);
  /// Figures 3, 4 and 9, of every mesh. `paper`: its row, or null.
  absl::Status draw_samplings(const HostedMesh& mesh, const std::string& name, const PaperMesh* paper);

  /// Returns all pictures, by figure.
  std::vector<Picture> take();

 private:
  absl::Status add(const char* figure, const std::string& caption, const absl::StatusOr<Image>& image);

  int side_;
  const ExecutionContext& context_;
  std::vector<Picture> pictures_;
};

}  // namespace curvecast::cli::bench
