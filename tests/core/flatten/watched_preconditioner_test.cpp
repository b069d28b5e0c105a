#include "core/flatten/watched_preconditioner.h"

#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <vector>

namespace curvecast {
namespace {

using Plain = Eigen::IncompleteLUT<double>;
using Matrix = Eigen::SparseMatrix<double>;

/// Of a grid of n x n unknowns, each bound to its neighbours, to those after it otherwise than to those before.
Matrix grid(int n) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> weight(0.5, 1.5);
  std::vector<Eigen::Triplet<double>> entries;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      double sum = 1e-3;
      const auto bind = [&](int i, int j) {
        if (i < 0 || j < 0 || i >= n || j >= n) return;
        const double w = weight(random);
        sum += w;
        entries.emplace_back(y * n + x, j * n + i, -w);
      };
      bind(x - 1, y), bind(x + 1, y), bind(x, y - 1), bind(x, y + 1);
      entries.emplace_back(y * n + x, y * n + x, sum);
    }
  }
  Matrix matrix(n * n, n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(WatchedPreconditioner, HasTheNumbersOfThatWithoutAWatch) {
  const Matrix matrix = grid(40);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 2);
  Plain plain;
  plain.compute(matrix);
  Watched<Plain> watched;
  watched.compute(matrix);
  EXPECT_EQ(watched.info(), Eigen::Success);
  EXPECT_EQ(watched.solve(right), Eigen::VectorXd(plain.solve(right)));
}

TEST(WatchedPreconditioner, SolvesAsThatWithoutAWatch) {
  const Matrix matrix = grid(30);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 2);
  Eigen::BiCGSTAB<Matrix, Plain> plain(matrix);
  Eigen::BiCGSTAB<Matrix, Watched<Plain>> watched(matrix);
  const Eigen::VectorXd solved = watched.solve(right);
  EXPECT_EQ(solved, Eigen::VectorXd(plain.solve(right)));
  EXPECT_LT((matrix * solved - right).norm(), 1e-9);
}

TEST(WatchedPreconditioner, EndsWhileItIsMadeAndWhileItSolves) {
  const Matrix matrix = grid(20);
  const Eigen::VectorXd right = Eigen::VectorXd::Ones(matrix.rows());
  std::atomic<bool> cancel = false;
  const ExecutionContext context{.cancel = &cancel};
  Watched<Plain> made;
  Watched<Eigen::DiagonalPreconditioner<double>> diagonal;
  {
    const WatchedContext watched(context);
    made.compute(matrix);
    diagonal.compute(matrix);
    EXPECT_NO_THROW((void)made.solve(right));
    cancel = true;
    EXPECT_THROW((void)made.solve(right), Cancelled);
    EXPECT_THROW((void)diagonal.solve(right), Cancelled);
    Watched<Plain> other;
    EXPECT_THROW(other.compute(matrix), Cancelled);
  }
  EXPECT_NO_THROW((void)made.solve(right)) << "nobody watches any more";
}

}  // namespace
}  // namespace curvecast
