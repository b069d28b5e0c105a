#include "core/progressive/ranked_workspace.h"

#include <gtest/gtest.h>

namespace curvecast {
namespace {

TEST(RankedWorkspace, CountsWhatASelectionLacks) {
  RankedWorkspace workspace;
  EXPECT_EQ(workspace.byte_size(), 0u);
  workspace.selection.lacking.reserve(1000);
  EXPECT_EQ(workspace.byte_size(), 1000 * sizeof(ChunkId));
}

TEST(RankedWorkspace, CountsEveryMember) {
  RankedWorkspace workspace;
  std::size_t bytes = 0;
  const auto fill = [&](auto& vector) {
    vector.reserve(100);
    bytes += 100 * sizeof(vector[0]);
    EXPECT_EQ(workspace.byte_size(), bytes);
  };
  PointSet& points = workspace.points;
  fill(points.positions), fill(points.normals), fill(points.radii), fill(points.vertices), fill(points.places),
      fill(points.ranks), fill(points.colours);
  RankSelection& selection = workspace.selection;
  fill(selection.parts), fill(selection.shown), fill(selection.rungs), fill(selection.lacking);
  fill(workspace.density), fill(workspace.shown), fill(workspace.refs), fill(workspace.discs);
  fill(workspace.delta.added), fill(workspace.delta.removed), fill(workspace.delta.resized);
  ListDelta& list = workspace.list_delta;
  fill(list.added), fill(list.removed), fill(list.resized);
  for (ListDelta::Scratch* scratch : {&list.of_added, &list.of_removed, &list.of_resized}) {
    fill(scratch->keys), fill(scratch->sorting), fill(scratch->curve_positions);
  }
}

}  // namespace
}  // namespace curvecast
