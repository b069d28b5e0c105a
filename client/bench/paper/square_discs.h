// Figure 6: equal discs about points of the unit square, with the star discrepancy of the points and what the discs cover.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <vector>

#include "client/bench/paper/hosted_mesh.h"
#include "client/bench/paper/paper_report.h"
#include "core/base/execution_context.h"
#include "core/base/image.h"

namespace curvecast::cli::bench {

struct DiscsPicture {
  SquareDiscs numbers;
  Image image;  // the square
};

/// Returns the radius of discs about n points: one and a half times that of discs which just touch where they lie densest, so
/// that the square is covered twice over.
double disc_radius(std::size_t n);

/// Draws n points of each kind: random ones, Niederreiter's, Hammersley's, those of sample elimination, ours jittered and
/// progressive. `square`: square_obj(). `side`: of the pictures, pixels. Errors as of HostedMesh; Cancelled.
absl::StatusOr<std::vector<DiscsPicture>> draw_square_discs(const HostedMesh& square, std::size_t n, int side,
                                                            const ExecutionContext& context);

}  // namespace curvecast::cli::bench
