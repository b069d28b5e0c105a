// The lowest ranks of a curve as a file: what first views show, without the surface that it was found on.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "core/curve/surface_curve.h"
#include "core/progressive/rank_tree.h"

namespace curvecast {

/// Grows when what the files hold changes.
inline constexpr std::uint32_t kRankFileVersion = 1;

struct RankFile {
  std::shared_ptr<const RankTree> tree;
  int level = 0;  // down to which it has all chunks
};

/// Saves the chunks of the levels that the tree has all of, down to `deepest` at most. `note`: whose they are. Errors as of
/// write_section_file. Precondition: deepest >= kChunkLevels.
absl::Status save_ranks(const std::string& path, const RankTree& tree, int deepest, std::string_view note = {});

/// Loads what save_ranks() saved with the same note, for the same curve, whose surface has `faces`. Errors as of
/// SectionFile::open, and DataLoss where the content makes no sense for them.
absl::StatusOr<RankFile> load_ranks(const std::string& path, const SurfaceCurve& curve, std::uint64_t faces,
                                    std::string_view note = {});

}  // namespace curvecast
