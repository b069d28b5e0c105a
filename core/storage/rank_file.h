// Ranked points of a curve as a file: those of the lowest ranks, which first views show, and deeper ones, without the surface
// that they were found on.
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
inline constexpr std::uint32_t kRankFileVersion = 4;

struct RankFile {
  std::shared_ptr<const RankTree> tree;
  int level = 0;  // down to which it has all chunks, as far as it was asked to be saved
};

struct SaveRanksOptions {
  int whole_levels = kChunkLevels;     // down to this level whole levels are saved, at least kChunkLevels
  std::size_t most_deeper_points = 0;  // about; of deeper chunks those that were looked at last, with those that they continue
};

/// Saves the chunks of the levels that the tree has all of, and some of the others. `note`: whose they are. Errors as of
/// write_section_file.
absl::Status save_ranks(const std::string& path, const RankTree& tree, const SaveRanksOptions& options,
                        std::string_view note = {});

/// Loads what save_ranks() saved with the same note, for the same curve, whose surface has `faces`. Errors as of
/// SectionFile::open, and DataLoss where the content makes no sense for them.
absl::StatusOr<RankFile> load_ranks(const std::string& path, const SurfaceCurve& curve, std::uint64_t faces,
                                    std::string_view note = {});

}  // namespace curvecast
