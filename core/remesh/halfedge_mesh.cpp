#include "core/remesh/halfedge_mesh.h"

#include <utility>

namespace curvecast {

HalfedgeMesh::HalfedgeMesh(TriangleMesh mesh, std::size_t more) : TriangleMesh(std::move(mesh)) {
  positions.reserve(positions.size() + more);
  triangles.reserve(triangles.size() + 2 * more);
  twins.reserve(twins.size() + 6 * more);
  outgoing_.reserve(positions.size() + more);
  outgoing_.assign(positions.size(), kNone);
  for (std::uint32_t h = 0; h < twins.size(); ++h) {
    std::uint32_t& out = outgoing_[from(h)];
    if (out == kNone || twins[h] == kNone) out = h;
  }
}

bool HalfedgeMesh::has_edge(std::uint32_t v, std::uint32_t w) const {
  bool found = false;
  for_each_neighbour(v, [&](std::uint32_t x) { found |= x == w; });
  return found;
}

void HalfedgeMesh::mark_feature(std::uint32_t h) {
  if (features_.empty()) {
    features_.reserve(twins.capacity());
    features_.assign(twins.size(), false);
  }
  set_feature(h, true);
  set_feature(twins[h], true);
}

std::uint32_t HalfedgeMesh::count_features(std::uint32_t v) const {
  std::uint32_t count = 0;
  if (!features_.empty()) for_each_outgoing(v, [&](std::uint32_t h) { count += features_[h] ? 1 : 0; });
  return count;
}

std::uint32_t HalfedgeMesh::add_vertex(const Vec3d& position) {
  positions.push_back(position);
  outgoing_.push_back(kNone);
  return static_cast<std::uint32_t>(positions.size() - 1);
}

/// Returns its first halfedge, (a, b).
std::uint32_t HalfedgeMesh::add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto h = static_cast<std::uint32_t>(twins.size());
  triangles.push_back({a, b, c});
  twins.insert(twins.end(), 3, kNone);
  if (!features_.empty()) features_.insert(features_.end(), 3, false);
  return h;
}

void HalfedgeMesh::split_face(std::uint32_t f, std::uint32_t v) {
  const auto [a, b, c] = triangles[f];
  const std::uint32_t h = 3 * f, of_b = twins[h + 1], of_c = twins[h + 2];
  const std::uint32_t second = add_face(b, c, v), third = add_face(c, a, v);
  triangles[f][2] = v;
  set_feature(second, is_feature(h + 1));
  set_feature(third, is_feature(h + 2));
  set_feature(h + 1, false);
  set_feature(h + 2, false);
  join(second, of_b);
  join(third, of_c);
  join(h + 1, second + 2);
  join(second + 1, third + 2);
  join(third + 1, h + 2);
  if (outgoing_[b] == h + 1) outgoing_[b] = second;
  if (outgoing_[c] == h + 2) outgoing_[c] = third;
  outgoing_[v] = h + 2;
}

std::uint32_t HalfedgeMesh::split_edge(std::uint32_t h, std::uint32_t v) {
  const std::uint32_t t = twins[h];
  // The half of a side's face that lies beyond v.
  const auto halve = [&](std::uint32_t side) {
    const std::uint32_t next = next_halfedge(side), end = to(side), corner = apex(side);
    const std::uint32_t beyond = twins[next], rest = add_face(v, end, corner);
    triangles[side / 3][next % 3] = v;
    set_feature(rest, is_feature(side));
    set_feature(rest + 1, is_feature(next));
    set_feature(next, false);
    join(rest + 1, beyond);
    join(rest + 2, next);
    if (outgoing_[end] == next) outgoing_[end] = rest + 1;
    return rest;
  };
  const std::uint32_t rest = halve(h);
  if (t == kNone) {
    outgoing_[v] = rest;  // it leaves along the border
    return rest;
  }
  const std::uint32_t rest_of_twin = halve(t);
  join(rest, t);
  join(h, rest_of_twin);
  outgoing_[v] = rest;
  return rest;
}

bool HalfedgeMesh::may_flip(std::uint32_t h) const {
  const std::uint32_t t = twins[h];
  if (t == kNone || is_feature(h)) return false;
  const std::uint32_t c = apex(h), d = apex(t);
  return c != d && !has_edge(c, d);
}

void HalfedgeMesh::flip(std::uint32_t h) {
  const std::uint32_t t = twins[h];
  const std::uint32_t n = next_halfedge(h), p = previous_halfedge(h), tn = next_halfedge(t), tp = previous_halfedge(t);
  const std::uint32_t a = from(h), b = to(h), c = from(p), d = from(tp);
  const std::uint32_t beyond_n = twins[n], beyond_p = twins[p], beyond_tn = twins[tn], beyond_tp = twins[tp];
  const bool of_n = is_feature(n), of_p = is_feature(p), of_tn = is_feature(tn), of_tp = is_feature(tp);
  // (a, b, c) becomes (d, c, a) with h from d to c; (b, a, d) becomes (c, d, b) with t from c to d.
  triangles[h / 3][h % 3] = d;
  triangles[h / 3][n % 3] = c;
  triangles[h / 3][p % 3] = a;
  triangles[t / 3][t % 3] = c;
  triangles[t / 3][tn % 3] = d;
  triangles[t / 3][tp % 3] = b;
  join(n, beyond_p);    // (c, a)
  join(p, beyond_tn);   // (a, d)
  join(tn, beyond_tp);  // (d, b)
  join(tp, beyond_n);   // (b, c)
  set_feature(n, of_p);
  set_feature(p, of_tn);
  set_feature(tn, of_tp);
  set_feature(tp, of_n);
  // Where the outgoing halfedge has gone elsewhere: any that leaves inside; on the border the same edge as before.
  const auto update = [&](std::uint32_t v, std::uint32_t before, std::uint32_t now) {
    if (outgoing_[v] == before) outgoing_[v] = now;
  };
  update(a, h, p), update(a, tn, p);
  update(b, t, tp), update(b, n, tp);
  update(c, p, n), update(d, tp, tn);
}

/// Says whether features stay the lines that they are when from(h) moves onto to(h): it lies on none, or within one along which
/// it goes, and no two become one.
bool HalfedgeMesh::keeps_features(std::uint32_t h) const {
  if (features_.empty()) return true;
  const std::uint32_t count = count_features(from(h));
  if (count == 0) return true;
  if (count != 2 || !features_[h] || on_border(from(h))) return false;
  const std::uint32_t t = twins[h];
  const auto joins = [&](std::uint32_t side) { return features_[next_halfedge(side)] && features_[previous_halfedge(side)]; };
  return !joins(h) && !joins(t);
}

bool HalfedgeMesh::may_collapse(std::uint32_t h) const {
  const std::uint32_t v = from(h), u = to(h), t = twins[h];
  const bool is_border = on_border(v);
  if (is_border && t != kNone) return false;  // it moves along the border only
  if (!keeps_features(h)) return false;
  const std::uint32_t a = apex(h), b = t == kNone ? kNone : apex(t);
  // The only neighbours that both have lie across the edge.
  std::uint32_t degree = 0;
  bool fits = true;
  for_each_neighbour(v, [&](std::uint32_t x) {
    ++degree;
    if (fits && x != u && x != a && x != b) fits = !has_edge(x, u);
  });
  if (!fits) return false;
  const auto may_lose_one = [&](std::uint32_t x) {
    std::uint32_t neighbours = 0;
    for_each_neighbour(x, [&](std::uint32_t /*w*/) { ++neighbours; });
    return neighbours > (on_border(x) ? 2u : 3u);
  };
  const bool takes_one = degree == (is_border ? 2u : 3u);  // nothing is left around v to make up for it
  return may_lose_one(a) && (b == kNone || may_lose_one(b)) && (!takes_one || may_lose_one(u));
}

void HalfedgeMesh::collapse(std::uint32_t h) {
  const std::uint32_t v = from(h), u = to(h), t = twins[h];
  const std::uint32_t n = next_halfedge(h), p = previous_halfedge(h);
  for_each_outgoing(v, [&](std::uint32_t out) { triangles[out / 3][out % 3] = u; });
  // What leaves along a halfedge that goes, leaves along the one that takes its place: on the border if that was there.
  const auto leave = [&](std::uint32_t x, std::uint32_t before, std::uint32_t now) {
    if (outgoing_[x] == before) outgoing_[x] = now;
  };
  const std::uint32_t beyond_n = twins[n], beyond_p = twins[p];
  const auto join_sides = [&](std::uint32_t a, std::uint32_t b, bool is_one) {
    join(a, b);
    set_feature(a, is_one);
    set_feature(b, is_one);
  };
  join_sides(beyond_n, beyond_p, is_feature(n) || is_feature(p));
  leave(from(p), p, beyond_n);
  leave(u, n, beyond_p);
  if (t != kNone) {
    const std::uint32_t tn = next_halfedge(t), tp = previous_halfedge(t);
    const std::uint32_t beyond_tn = twins[tn];
    join_sides(beyond_tn, twins[tp], is_feature(tn) || is_feature(tp));
    leave(from(tp), tp, beyond_tn);
    leave(u, t, beyond_p);
    triangles[t / 3] = {kNone, kNone, kNone};
  }
  triangles[h / 3] = {kNone, kNone, kNone};
  outgoing_[v] = kNone;
}

std::vector<std::uint32_t> HalfedgeMesh::compact() {
  std::vector<std::uint32_t> kept, vertex(positions.size(), kNone), face(triangles.size(), kNone);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    if (!has_vertex(v)) continue;
    vertex[v] = static_cast<std::uint32_t>(kept.size());
    positions[kept.size()] = positions[v];
    kept.push_back(v);
  }
  std::uint32_t faces = 0;
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    if (has_face(f)) face[f] = faces++;
  }
  const auto renumbered = [&](std::uint32_t h) { return h == kNone ? kNone : 3 * face[h / 3] + h % 3; };
  for (std::uint32_t f = 0; f < triangles.size(); ++f) {
    if (face[f] == kNone) continue;
    const Triangle t = triangles[f];
    triangles[face[f]] = {vertex[t[0]], vertex[t[1]], vertex[t[2]]};
    for (std::uint32_t i = 0; i < 3; ++i) {
      twins[3 * face[f] + i] = renumbered(twins[3 * f + i]);
      if (!features_.empty()) features_[3 * face[f] + i] = features_[3 * f + i];
    }
  }
  for (std::size_t i = 0; i < kept.size(); ++i) outgoing_[i] = renumbered(outgoing_[kept[i]]);
  positions.resize(kept.size());
  outgoing_.resize(kept.size());
  triangles.resize(faces);
  twins.resize(3 * std::size_t{faces});
  if (!features_.empty()) features_.resize(twins.size());
  return kept;
}

}  // namespace curvecast
