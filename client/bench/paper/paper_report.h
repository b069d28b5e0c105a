// All that the benchmark of the paper finds: what the page shows and the JSON file holds.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "client/bench/paper/paper_values.h"
#include "client/bench/paper/ways.h"
#include "client/bench/peers/ring_test.h"

namespace curvecast::cli::bench {

/// One line of figure 5.
struct RingLine {
  std::string name;
  std::uint64_t curve_vertices = 0;  // of the curve that was sampled; 0: none
  RingTest test;
};

/// A remeshed surface beside the original: of distances there and back the larger ones.
struct RemeshError {
  std::string way;
  int percent = 0;  // of the original triangles that were asked for
  std::uint64_t triangles = 0;
  double mean = 0, rms = 0, max = 0;  // % of the diagonal of the original's box
};

/// Points in the unit square and what discs about them cover: figure 6.
struct SquareDiscs {
  std::string name;
  double star_discrepancy = 0, covered = 0;
};

struct Picture {
  std::string figure;   // "2 b"
  std::string caption;  // what is to be seen
  std::string png;      // bytes of the file
};

struct MeshFindings {
  std::string file;                  // its name without folders
  const PaperMesh* paper = nullptr;  // its row, or null
  std::uint64_t faces = 0, vertices = 0;
  std::array<StageTimes, 2> seconds;  // by Way
  std::vector<double> ring_sizes;     // N of each set
  std::vector<RingLine> rings;        // first those of the two ways
  std::vector<RemeshError> remeshes;
};

struct PaperFindings {
  std::string machine;
  bool quick = false;
  std::uint64_t seed = 0;
  std::uint64_t table_points = 0;  // N of table 1
  std::vector<MeshFindings> meshes;
  std::uint64_t square_points = 0;  // of figure 6
  double disc_radius = 0;
  std::vector<SquareDiscs> squares;
  std::vector<Picture> pictures;
};

/// What has to hold for ours to be as good as the paper's.
struct Claim {
  std::string text;
  double ours = 0, paper = 0;
  bool holds = false;
};

/// Returns what the numbers of every mesh that the paper has say: each stage faster, gradients as steep, random points as random.
/// Quick findings say nothing of gradients.
std::vector<Claim> claims_of(const PaperFindings& findings);

}  // namespace curvecast::cli::bench
