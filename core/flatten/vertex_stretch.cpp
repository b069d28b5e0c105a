#include "core/flatten/vertex_stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/cross.h"
#include "core/flatten/mean_value.h"

namespace curvecast {
namespace {

/// Twice the area of (u, p, q); 0 where rounding leaves its sign in doubt.
double certain_area(const Vec2d& u, const Vec2d& p, const Vec2d& q) {
  constexpr double kDoubt = 16 * std::numeric_limits<double>::epsilon();
  const Vec2d a = p - u;
  const Vec2d b = q - u;
  const double first = a.x() * b.y();
  const double second = a.y() * b.x();
  const double area = first - second;
  return area > kDoubt * (std::abs(first) + std::abs(second)) ? area : 0;
}

// Needles get this part of an equal-sided triangle's shape, or nothing would keep them from collapsing.
constexpr double kFattening = 1e-8;
// Steps are longer than Newton's: what is smooth over many vertices settles in fewer sweeps (successive over-relaxation).
constexpr double kOverrelaxation = 1.7;
// An energy that a step lowers to this part of it is worth trying to lower more.
constexpr double kSteep = 0.6;

/// What is left of the convex polygon on the left of the line from p to q.
void clip(std::vector<Vec2d>& polygon, const Vec2d& p, const Vec2d& q) {
  std::vector<Vec2d> kept;
  const auto side = [&](const Vec2d& x) { return cross(q - p, x - p); };
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d& a = polygon[i];
    const Vec2d& b = polygon[(i + 1) % polygon.size()];
    const double at_a = side(a);
    const double at_b = side(b);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) kept.emplace_back(a + at_a / (at_a - at_b) * (b - a));
  }
  polygon = std::move(kept);
}

}  // namespace

void VertexStretch::reset(const Vec3d& position, bool closed) {
  position_ = position;
  closed_ = closed;
  neighbours_.clear();
  corners_.clear();
}

void VertexStretch::add_neighbour(const Vec3d& position, const Vec2d& uv) { neighbours_.push_back({position - position_, uv}); }

void VertexStretch::finish() {
  const std::size_t n = neighbours_.size();
  for (std::size_t i = 0; i + (closed_ ? 0 : 1) < n; ++i) {
    const Neighbour& p = neighbours_[i];
    const Neighbour& q = neighbours_[i + 1 < n ? i + 1 : 0];
    const double dot = p.edge.dot(q.edge);
    const double p_squared = p.edge.squaredNorm();
    const double q_squared = q.edge.squaredNorm();
    const double fat = kFattening * (p_squared + q_squared);
    const double at_vertex = dot + fat;
    const double at_p = p_squared - dot + fat;
    const double at_q = q_squared - dot + fat;
    const double area_squared = at_vertex * (at_p + at_q) + at_p * at_q;  // of the parallelogram
    const double half_area = 0.25 * std::sqrt(std::max(0.0, area_squared));
    corners_.push_back({p.uv, q.uv, at_vertex, at_p, at_q, half_area, spread_ / half_area});
  }
}

double VertexStretch::energy(const Vec2d& uv) const {
  double sum = 0;
  for (const Corner& c : corners_) {
    const double area = certain_area(uv, c.p, c.q);
    if (!(area > 0)) return kInvalid;
    const double lengths =
        c.at_vertex * (c.q - c.p).squaredNorm() + c.at_p * (c.q - uv).squaredNorm() + c.at_q * (c.p - uv).squaredNorm();
    sum += (c.half_area / (area * area) + c.spread) * lengths;
  }
  return sum;
}

VertexStretch::Improvement VertexStretch::improve(Vec2d& uv, const std::optional<Vec2d>& direction) const {
  double before = 0;
  Vec2d gradient = Vec2d::Zero();
  double xx = 0, xy = 0, yy = 0;  // the Hessian
  for (const Corner& c : corners_) {
    const Vec2d to_p = c.p - uv;
    const Vec2d to_q = c.q - uv;
    const double area = cross(to_p, to_q);
    const double r = 1 / area;
    const double k = c.half_area * r * r;
    const double lengths = c.at_vertex * (c.q - c.p).squaredNorm() + c.at_p * to_q.squaredNorm() + c.at_q * to_p.squaredNorm();
    const Vec2d slope = -2 * (c.at_p * to_q + c.at_q * to_p);            // of the lengths
    const Vec2d turn(r * (c.p.y() - c.q.y()), r * (c.q.x() - c.p.x()));  // of the area, over the area
    before += (k + c.spread) * lengths;
    gradient += k * (slope - 2 * lengths * turn) + c.spread * slope;
    const double straight = 2 * (c.at_p + c.at_q);
    xx += c.spread * straight + k * (straight - 4 * slope.x() * turn.x() + 6 * lengths * turn.x() * turn.x());
    xy += k * (-2 * (slope.x() * turn.y() + slope.y() * turn.x()) + 6 * lengths * turn.x() * turn.y());
    yy += c.spread * straight + k * (straight - 4 * slope.y() * turn.y() + 6 * lengths * turn.y() * turn.y());
  }
  Vec2d step;
  if (direction) {
    const Vec2d& d = *direction;
    const double bend = d.x() * d.x() * xx + 2 * d.x() * d.y() * xy + d.y() * d.y() * yy;
    const double push = gradient.dot(d);
    step = -push / std::max(std::abs(bend), 1e-300) * d;
  } else {
    // Lift the Hessian's eigenvalues until both are clearly positive.
    const double mean = 0.5 * (xx + yy);
    const double spread = std::sqrt(std::max(0.0, mean * mean - (xx * yy - xy * xy)));
    const double least = mean - spread;
    const double wanted = 1e-3 * (std::abs(mean) + spread);
    const double lift = least < wanted ? wanted - least : 0;
    xx += lift;
    yy += lift;
    const double determinant = xx * yy - xy * xy;
    step = -Vec2d(yy * gradient.x() - xy * gradient.y(), xx * gradient.y() - xy * gradient.x()) / determinant;
  }
  // Not so far that a triangle would lose nearly all of its area.
  double length = kOverrelaxation;
  for (const Corner& c : corners_) {
    const double area = cross(c.p - uv, c.q - uv);
    const double change = (c.p.y() - c.q.y()) * step.x() + (c.q.x() - c.p.x()) * step.y();
    if (length * change < -0.9 * area) length = -0.9 * area / change;
  }
  constexpr int kHalvings = 4;
  for (int i = 0; i < kHalvings; ++i, length *= 0.5) {
    double after = energy(uv + length * step);
    if (!(after < before)) continue;
    // Beside a nearly collapsed triangle the energy is like the inverse square of a distance, which a Newton step only raises by
    // a third.
    while (after < kSteep * before) {
      const double farther = energy(uv + 2 * length * step);
      if (!(farther < after)) break;
      length *= 2;
      after = farther;
    }
    uv += length * step;
    return {before, before - after};
  }
  return {before, 0};
}

std::optional<Vec2d> VertexStretch::place() const { return closed_ ? place_inside() : place_on_border(); }

std::optional<Vec2d> VertexStretch::place_inside() const {
  const std::size_t n = neighbours_.size();
  Vec2d sum = Vec2d::Zero();
  double total = 0;
  double before = half_tangent(neighbours_[n - 1].edge, neighbours_[0].edge);
  for (std::size_t i = 0; i < n; ++i) {
    const double after = half_tangent(neighbours_[i].edge, neighbours_[i + 1 < n ? i + 1 : 0].edge);
    const double weight = (before + after) / neighbours_[i].edge.norm();
    sum += weight * neighbours_[i].uv;
    total += weight;
    before = after;
  }
  const Vec2d mean = sum / total;
  if (valid(mean)) return mean;

  Vec2d low = neighbours_[0].uv;
  Vec2d high = low;
  for (const Neighbour& x : neighbours_) {
    low = low.cwiseMin(x.uv);
    high = high.cwiseMax(x.uv);
  }
  std::vector<Vec2d> kernel = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  for (const Corner& c : corners_) clip(kernel, c.p, c.q);
  if (kernel.empty()) return std::nullopt;
  Vec2d middle = Vec2d::Zero();
  for (const Vec2d& x : kernel) middle += x / static_cast<double>(kernel.size());
  if (valid(middle)) return middle;
  return std::nullopt;
}

std::optional<Vec2d> VertexStretch::place_on_border() const {
  const Neighbour& next = neighbours_.front();
  const Neighbour& previous = neighbours_.back();
  const Vec2d side = next.uv - previous.uv;
  double low = 0;
  double high = 1;
  for (const Corner& c : corners_) {
    // The area of (place, p, q) is linear along the side.
    const double at_low = cross(c.p - previous.uv, c.q - previous.uv);
    const double at_high = cross(c.p - next.uv, c.q - next.uv);
    if (at_low <= 0 && at_high <= 0) return std::nullopt;
    const double zero = at_low / (at_low - at_high);
    if (at_low < 0) low = std::max(low, zero);
    if (at_high < 0) high = std::min(high, zero);
  }
  const double before = previous.edge.norm();
  const double by_length = before / std::max(before + next.edge.norm(), 1e-300);
  const double margin = 0.1 * (high - low);
  const double t = by_length > low + margin && by_length < high - margin ? by_length : 0.5 * (low + high);
  const Vec2d there = previous.uv + t * side;
  if (valid(there)) return there;
  return std::nullopt;
}

}  // namespace curvecast
