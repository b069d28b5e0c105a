// The bytes that preprocessing and sampling make today. Caches, replicas and clients that resume count on them.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <string>
#include <string_view>
#include <vector>

#include "core/curve/curve_columns.h"
#include "core/pipeline/curve_surface.h"
#include "core/pipeline/pipeline.h"
#include "core/progressive/grow_ranks.h"
#include "core/progressive/sample_ranked.h"
#include "core/sample/move_apart.h"
#include "core/sample/resample.h"
#include "core/sample/spread_in_leaves.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

/// Hashes, 16 hexadecimal digits each.
struct Hashes {
  std::string curve, equalised, progressive, deep, relaxed;
};

struct Golden {
  const char* name;
  PolygonSoup (*shape)();
  Hashes hashes;
  std::uint64_t chart_faces = 0;
};

/// Where a hash differs on purpose, raise kAlgorithmVersion, and set this version and the new hashes here: sessions in caches
/// then belong to another version and are made again.
constexpr int kVersion = 14;

const Golden kGolden[] = {
    {"a bumpy ball",
     [] { return testing::jittered(testing::icosphere(4), 0.02); },
     {"854a5df0fa5aeeee", "5885f5988aaae41b", "603e597a51f09cd9", "dad08ac62fe927b9", "02535772cc967345"}},
    {"a torus",
     [] { return testing::torus(24, 48); },
     {"e8fdec243d9eca0e", "7f07bd9391a61292", "5db73af175005e90", "be3c627377e8f36a", "9fb773013a8dcaaa"}},
    {"a slab with nine holes",
     [] { return testing::perforated_slab(7, 7); },
     {"b3cec624c9fd4d35", "33959d27c5113545", "736df05420fb0996", "fe84288314d5a5aa", "6fc790888a0b6bb6"}},
    {"a bumpy ball in charts",
     [] { return testing::jittered(testing::icosphere(5), 0.02); },
     {"54d638a5ad94e5ec", "6265d0f6323cc20b", "1cd7546d78711fb6", "d9e51a8c4878feed", "a0cadbd95f7a7b14"},
     4000},
};

class Hash {
 public:
  Hash() : state_(XXH3_createState()) { XXH3_64bits_reset(state_); }
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;
  ~Hash() { XXH3_freeState(state_); }

  template <typename Values>
  void add(const Values& values) {
    XXH3_64bits_update(state_, values.data(), values.size() * sizeof(values[0]));
  }
  std::string digits() const {
    std::string text(16, '0');
    std::uint64_t hash = XXH3_64bits_digest(state_);
    for (std::size_t i = text.size(); i-- > 0; hash >>= 4) text[i] = "0123456789abcdef"[hash & 15];
    return text;
  }

 private:
  XXH3_state_t* state_;
};

std::string hash_of(const SurfaceCurve& curve) {
  Hash hash;
  visit_columns(curve, [&](const char*, const auto& column, ColumnLength) { hash.add(column); });
  return hash.digits();
}

std::string hash_of(const PointSet& points) {
  Hash hash;
  hash.add(points.positions);
  hash.add(points.normals);
  hash.add(points.radii);
  hash.add(points.vertices);
  hash.add(points.ranks);
  return hash.digits();
}

/// Points of deep levels: those of a view from a fiftieth of the diagonal.
std::string hash_from_near_by(const SurfaceCurve& curve, RankGrower& grower) {
  const std::size_t l = curve.size() / 3;
  const Vec3d place = curve.position(l).cast<double>() + curve.origin;
  const Vec3d eye = place + 0.02 * curve.box.diagonal() * curve.normal(l).cast<double>();
  const Density density({ScreenTerm{}, FrustumTerm{}}, {testing::camera_at(eye, place)});
  RankedWorkspace workspace;
  for (;;) {
    EXPECT_TRUE(sample_ranked(curve, grower.tree(), nullptr, density, 1500, workspace).ok());
    if (workspace.selection.lacking.empty()) break;
    if (!grower.grow(workspace.selection.most_lacking(), 4'000'000).ok()) return "cannot grow";
  }
  EXPECT_EQ(workspace.points.size(), 1500u);
  EXPECT_GT(grower.tree()->chunks().back()->id.level, kFirstLooseLevel);
  return hash_of(workspace.points);
}

Hashes hashes_of(const PolygonSoup& shape, std::uint64_t chart_faces) {
  const std::string off = testing::to_off(shape);
  const absl::StatusOr<Preprocessed> done = preprocess({"shape.off", off}, {.points = 5000, .chart_faces = chart_faces});
  EXPECT_TRUE(done.ok()) << done.status();
  if (!done.ok()) return {};
  const SurfaceCurve& curve = *done->curve;
  const Density density = testing::seen_from(Vec3d(1, 2, 9), {ViewTerm{}, CurvatureTerm{.floor = 0.2}});
  const absl::StatusOr<PointSet> equalised = resample(curve, {.points = 3000, .density = density, .seed = 5});
  const auto fixed = make_fixed_density(curve, density.terms);
  const auto grower = RankGrower::make(leaf_surface(*done), {.level = 6});
  RankedWorkspace workspace;
  EXPECT_TRUE(equalised.ok() && fixed.ok() && grower.ok());
  EXPECT_TRUE(sample_ranked(curve, (*grower)->tree(), fixed->get(), density, 1500, workspace).ok());
  absl::StatusOr<PointSet> relaxed = resample(curve, {.points = 2000});
  const auto base = curve_base(done->flattened);
  EXPECT_TRUE(relaxed.ok() && base.ok());
  find_places(curve, *relaxed);
  EXPECT_TRUE(move_apart(**base, 5, *relaxed).ok());
  return {hash_of(curve), hash_of(*equalised), hash_of(workspace.points), hash_from_near_by(curve, **grower), hash_of(*relaxed)};
}

TEST(Golden, BytesChangeOnlyWithTheVersionOfTheAlgorithm) {
  for (const Golden& golden : kGolden) {
    SCOPED_TRACE(golden.name);
    const Hashes now = hashes_of(golden.shape(), golden.chart_faces);
    if (kAlgorithmVersion == kVersion) {
      constexpr char kWhy[] = "bytes differ from those of the same kAlgorithmVersion: caches would mix both";
      EXPECT_EQ(now.curve, golden.hashes.curve) << kWhy;
      EXPECT_EQ(now.equalised, golden.hashes.equalised) << kWhy;
      EXPECT_EQ(now.progressive, golden.hashes.progressive) << kWhy;
      EXPECT_EQ(now.deep, golden.hashes.deep) << kWhy;
      EXPECT_EQ(now.relaxed, golden.hashes.relaxed) << kWhy;
    } else {
      ADD_FAILURE() << "the algorithm has another version: put kVersion = " << kAlgorithmVersion << " here, and \"" << now.curve
                    << "\", \"" << now.equalised << "\", \"" << now.progressive << "\", \"" << now.deep << "\", \"" << now.relaxed
                    << "\"";
    }
  }
}

TEST(Golden, AreTheSameOnOneThreadAndOnMany) {
  const std::string off = testing::to_off(kGolden[0].shape());
  ExecutionContext one, many;
  one.threads = 1;
  many.threads = 4;
  const absl::StatusOr<Preprocessed> a = preprocess({"shape.off", off}, {.points = 5000}, one);
  const absl::StatusOr<Preprocessed> b = preprocess({"shape.off", off}, {.points = 5000}, many);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(hash_of(*a->curve), hash_of(*b->curve));
}

}  // namespace
}  // namespace curvecast
