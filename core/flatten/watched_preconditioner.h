// Eigen's preconditioners, which know nothing of contexts, ended from within.
#pragma once

#include <Eigen/Core>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <cmath>
#include <compare>
#include <utility>

#include "core/base/execution_context.h"

namespace curvecast {

/// Thrown where work ends early.
struct Cancelled {};

/// The context of what this thread works at while the object is there, for what Eigen and CGAL make themselves.
class WatchedContext {
 public:
  explicit WatchedContext(const ExecutionContext& context) : before_(std::exchange(here, &context)) {}
  WatchedContext(const WatchedContext&) = delete;
  WatchedContext& operator=(const WatchedContext&) = delete;
  ~WatchedContext() { here = before_; }

  static void end_if_cancelled() {
    if (here != nullptr && here->cancelled()) throw Cancelled();
  }

 private:
  static inline thread_local const ExecutionContext* here = nullptr;
  const ExecutionContext* const before_;
};

/// Looks in each step of the solver whether it shall go on.
template <typename Preconditioner>
class Watched : public Preconditioner {
 public:
  template <typename Right>
  auto solve(const Right& right) const {
    WatchedContext::end_if_cancelled();
    return Preconditioner::solve(right);
  }
};

/// A double. Whoever takes a root of it is looked after: IncompleteLUT does so once for each row, and has no other place for
/// that.
class WatchedNumber {
 public:
  WatchedNumber() = default;
  WatchedNumber(double value) : value_(value) {}  // NOLINT(google-explicit-constructor): as any number
  explicit operator double() const { return value_; }

  WatchedNumber operator-() const { return -value_; }
  WatchedNumber& operator+=(WatchedNumber b) { return *this = *this + b; }
  WatchedNumber& operator-=(WatchedNumber b) { return *this = *this - b; }
  friend WatchedNumber operator+(WatchedNumber a, WatchedNumber b) { return a.value_ + b.value_; }
  friend WatchedNumber operator-(WatchedNumber a, WatchedNumber b) { return a.value_ - b.value_; }
  friend WatchedNumber operator*(WatchedNumber a, WatchedNumber b) { return a.value_ * b.value_; }
  friend WatchedNumber operator/(WatchedNumber a, WatchedNumber b) { return a.value_ / b.value_; }
  friend bool operator==(WatchedNumber a, WatchedNumber b) { return a.value_ == b.value_; }
  friend auto operator<=>(WatchedNumber a, WatchedNumber b) { return a.value_ <=> b.value_; }
  friend WatchedNumber abs(WatchedNumber a) { return std::abs(a.value_); }
  friend WatchedNumber sqrt(WatchedNumber a) {
    WatchedContext::end_if_cancelled();
    return std::sqrt(a.value_);
  }

 private:
  double value_ = 0;
};

}  // namespace curvecast

template <>
struct Eigen::NumTraits<curvecast::WatchedNumber> : Eigen::NumTraits<double> {
  using Real = curvecast::WatchedNumber;
  using NonInteger = curvecast::WatchedNumber;
  using Nested = curvecast::WatchedNumber;
  using Literal = curvecast::WatchedNumber;
};

namespace curvecast {

/// Looks while it is made, too: for igea that takes three seconds. The numbers are those of IncompleteLUT<double>.
template <>
class Watched<Eigen::IncompleteLUT<double>> {
 public:
  template <typename Matrix>
  Watched& compute(const Matrix& matrix) {
    lu_.compute(matrix.template cast<WatchedNumber>().eval());
    return *this;
  }
  template <typename Right>
  Eigen::VectorXd solve(const Right& right) const {
    WatchedContext::end_if_cancelled();
    return lu_.solve(right.template cast<WatchedNumber>().eval()).template cast<double>();
  }
  Eigen::ComputationInfo info() const { return lu_.info(); }

 private:
  Eigen::IncompleteLUT<WatchedNumber> lu_;
};

}  // namespace curvecast
