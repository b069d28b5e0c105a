#include "server/convert/convert_points.h"

#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "core/curve/place_attributes.h"
#include "core/sample/splat_radius.h"
#include "server/convert/convert.h"
#include "server/convert/little_endian.h"

namespace curvecast::server {
namespace {

std::string rgb_bytes(const std::vector<Rgba8>& colours, std::size_t begin, std::size_t count) {
  std::string bytes;
  bytes.reserve(3 * count);
  for (std::size_t i = begin; i < begin + count; ++i) {
    for (const std::uint8_t value : {colours[i].r, colours[i].g, colours[i].b}) bytes += static_cast<char>(value);
  }
  return bytes;
}

v1::PointLimit to_proto(PointLimit limit) {
  switch (limit) {
    case PointLimit::kNone:
      return v1::POINT_LIMIT_UNSPECIFIED;
    case PointLimit::kBytes:
      return v1::POINT_LIMIT_BYTES;
    case PointLimit::kDensity:
      return v1::POINT_LIMIT_DENSITY;
    case PointLimit::kServer:
      return v1::POINT_LIMIT_SERVER;
    case PointLimit::kComing:
      return v1::POINT_LIMIT_COMING;
  }
  return v1::POINT_LIMIT_UNSPECIFIED;
}

std::array<float, 2> weights_of(const FacePlace& place) { return {place.weight_1, place.weight_2}; }

/// Where points [begin, begin + count) lie in the file.
template <typename InFile>
void put_places(const std::vector<FacePlace>& places, std::size_t begin, std::size_t count, const InFile& in_file,
                v1::PointAttributes& out) {
  std::vector<std::uint32_t> faces(count);
  std::vector<std::array<float, 2>> weights(count);
  for (std::size_t i = 0; i < count; ++i) {
    const FacePlace place = in_file(places[begin + i]);
    faces[i] = place.face;
    weights[i] = weights_of(place);
  }
  out.set_faces(little_endian(faces, 0, count));
  out.set_barycentric(little_endian(weights, 0, count));
}

}  // namespace

v1::FrameStatistics to_proto(const PointSetStatistics& statistics) {
  v1::FrameStatistics out;
  out.set_density_seconds(statistics.density_seconds);
  out.set_equalise_seconds(statistics.equalise_seconds);
  out.set_encode_seconds(statistics.encode_seconds);
  out.set_curve_vertices(statistics.curve_vertices);
  out.set_wanted_points(statistics.wanted_points);
  out.set_limit(to_proto(statistics.limit));
  return out;
}

v1::PointAttributes to_proto(const PointSet& points, std::size_t begin, std::size_t count, const SurfaceCurve& curve,
                             const LeafSurface* surface, const PointAttributes& wanted) {
  const auto column = [&](const auto& value_of) {
    std::vector<decltype(value_of(std::size_t{}))> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = value_of(begin + i);
    return little_endian(values, 0, count);
  };
  v1::PointAttributes out;
  // Zeros where the surface cannot be used.
  const auto surface_column = [&](const auto& value_at) {
    const SurfaceData* const all = points.has_moved ? surface->data() : nullptr;
    return column([&](std::size_t i) {
      const FacePlace& place = points.places[i];
      const SurfaceData* const data = points.has_moved ? all : surface->data_of(points.vertices[i], place.face);
      using Value = decltype(value_at(*data, place, i));
      return data == nullptr ? Value{} : value_at(*data, place, i);
    });
  };
  if (wanted.curvatures && points.has_moved) {
    out.set_curvatures(surface_column([](const SurfaceData& data, const FacePlace& place, std::size_t /*i*/) {
      return curvatures_at(data, place.face, weights_of(place));
    }));
  } else if (wanted.curvatures) {
    out.set_curvatures(column([&](std::size_t i) {
      const std::uint32_t l = points.vertices[i];
      return std::array<float, 2>{curve.curvature_min[l], curve.curvature_max[l]};
    }));
  }
  if (wanted.rank) out.set_ranks(little_endian(points.ranks, begin, count));
  if (wanted.surface) {
    const auto in_file = [&](const FacePlace& place) { return place_in_file(place, curve.face_sources); };
    put_places(points.places, begin, count, in_file, out);
  }
  if (wanted.directions) {
    out.set_directions(surface_column([&](const SurfaceData& data, const FacePlace& place, std::size_t i) {
      const Vec3f direction = direction_min_at(data, place.face, weights_of(place), points.normals[i]);
      return std::array<float, 3>{direction.x(), direction.y(), direction.z()};
    }));
  }
  for (std::size_t s = 0; wanted.scalars && s < curve.scalars.size(); ++s) {
    v1::ScalarValues& scalar = *out.add_scalars();
    scalar.set_name(curve.scalars[s].name);
    scalar.set_values(surface_column([&](const SurfaceData& data, const FacePlace& place, std::size_t /*i*/) {
      return scalar_at(data, s, place.face, weights_of(place));
    }));
  }
  return out;
}

v1::PointAttributes to_proto(const ScatteredPoints& scattered, std::size_t begin, std::size_t count, bool places) {
  // Of `width` numbers each.
  const auto part = [&](const std::vector<float>& column, std::size_t width) {
    return little_endian(column, width * begin, width * count);
  };
  v1::PointAttributes out;
  if (!scattered.curvatures.empty()) out.set_curvatures(part(scattered.curvatures, 2));
  if (!scattered.directions.empty()) out.set_directions(part(scattered.directions, 3));
  for (const auto& [name, values] : scattered.scalars) {
    v1::ScalarValues& scalar = *out.add_scalars();
    scalar.set_name(name);
    scalar.set_values(part(values, 1));
  }
  if (!scattered.points.ranks.empty()) out.set_ranks(little_endian(scattered.points.ranks, begin, count));
  if (places)
    put_places(
        scattered.points.places, begin, count, [](const FacePlace& place) { return place; }, out);
  return out;
}

absl::StatusOr<v1::PointBlock> to_proto(const PointSet& points, std::size_t begin, std::size_t count, const Box3d& box,
                                        const std::optional<DracoOptions>& draco) {
  v1::PointBlock block;
  block.set_count(static_cast<std::uint32_t>(count));
  *block.mutable_origin() = to_proto(points.origin);
  if (!draco) {
    v1::RawPoints& raw = *block.mutable_raw();
    raw.set_positions(little_endian(points.positions, begin, count));
    raw.set_normals(little_endian(points.normals, begin, count));
    raw.set_radii(little_endian(points.radii, begin, count));
    if (!points.colours.empty()) raw.set_colours(rgb_bytes(points.colours, begin, count));
    return block;
  }
  // The session's own box, not the block's: all frames and blocks share one lattice.
  DracoOptions options = *draco;
  options.box_min = box.min - points.origin;
  options.box_size = (box.max - box.min).maxCoeff();
  options.radius_max = static_cast<double>(SplatRadius::largest(box));
  float radius_min = 0, radius_max = 0;
  absl::StatusOr<std::string> data = encode_draco(points, begin, count, options, &radius_min, &radius_max);
  if (!data.ok()) return data.status();
  v1::DracoPoints& out = *block.mutable_draco();
  out.set_data(*std::move(data));
  out.set_radius_min(radius_min);
  out.set_radius_max(radius_max);
  return block;
}

v1::PointEdits to_proto(const RankDelta& delta, const ListDelta& places, const SurfaceCurve& curve) {
  v1::PointEdits edits;
  const auto write = [](const std::vector<std::uint32_t>& indices, auto& out) {
    out.Reserve(static_cast<int>(indices.size()));
    std::uint32_t last = 0;
    for (const std::uint32_t i : indices) out.Add(i - std::exchange(last, i));
  };
  write(places.removed, *edits.mutable_removed());
  write(places.added, *edits.mutable_added());
  std::uint32_t last = 0;
  for (std::size_t i = 0; i < places.resized.size(); ++i) {
    const int steps = int{delta.resized[i].point.rung} - int{delta.resized[i].from};
    for (int step = 0; step < std::abs(steps); ++step) {
      const std::uint32_t gap = places.resized[i] - std::exchange(last, places.resized[i]);
      edits.add_resized(2 * gap + (steps > 0 ? 1 : 0));
    }
  }
  edits.set_radius_max(SplatRadius::largest(curve));
  return edits;
}

}  // namespace curvecast::server
