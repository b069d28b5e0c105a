#include "client/lib/draco_points.h"

#include <absl/strings/str_cat.h>
#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/geometry_metadata.h>
#include <draco/metadata/metadata_decoder.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include "client/lib/append_values.h"

namespace curvecast::client {
namespace {

static_assert(std::endian::native == std::endian::little, "raw points are copied as they are");

constexpr std::uint64_t kPointsPerByte = 256;  // 70 were measured, for 4,000,000 points at 1 bit and normals at 2
constexpr std::uint64_t kFreePoints = 65'536;
constexpr std::uint64_t kMaxBytesPerPoint = 64;

using Vec = std::array<float, 3>;

absl::Status broken(absl::string_view what) { return absl::InvalidArgumentError(absl::StrCat("broken Draco data: ", what)); }

/// Adds up the attribute descriptions, which Draco writes the same way for its sequential and its kd-tree method.
absl::Status read_attributes(draco::DecoderBuffer* buffer, DracoHeaderInfo* info) {
  std::uint8_t groups = 0;
  std::uint32_t attributes = 0;
  if (!buffer->Decode(&groups) || !draco::DecodeVarint(&attributes, buffer)) return broken("it ends within its header");
  if (groups != 1) return broken(absl::StrCat("it has ", groups, " groups of attributes where point clouds have one"));
  for (std::uint32_t a = 0; a < attributes; ++a) {
    std::uint8_t kind = 0, type = 0, components = 0, normalised = 0;
    std::uint32_t id = 0;
    if (!buffer->Decode(&kind) || !buffer->Decode(&type) || !buffer->Decode(&components) || !buffer->Decode(&normalised) ||
        !draco::DecodeVarint(&id, buffer)) {
      return broken("it ends within its attributes");
    }
    const int size = draco::DataTypeLength(static_cast<draco::DataType>(type));
    if (size <= 0 || components == 0) return broken(absl::StrCat("attribute ", a, " is ", components, " of data type ", type));
    info->bytes_per_point += static_cast<std::uint64_t>(size) * components;
    if (info->bytes_per_point > kMaxBytesPerPoint) return broken("its attributes need more than 64 bytes per point");
  }
  return absl::OkStatus();
}

/// Not valid where a file's numbers are no floats.
RadiusRange to_range(double min, double max) {
  const double limit = std::numeric_limits<float>::max();
  if (!(min > 0 && min <= max && max <= limit)) return {};
  return {static_cast<float>(min), static_cast<float>(max)};
}

absl::StatusOr<DracoHeaderInfo> parse_header(std::string_view bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  std::array<char, 5> magic{};
  std::uint8_t major = 0, minor = 0, geometry = 0, method = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(&magic) || std::string_view(magic.data(), magic.size()) != "DRACO")
    return broken("it does not begin with DRACO");
  if (!buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&geometry) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags)) {
    return broken("it ends within its header");
  }
  if (major != draco::kDracoPointCloudBitstreamVersionMajor || minor > draco::kDracoPointCloudBitstreamVersionMinor) {
    return broken(absl::StrCat("its version is ", major, ".", minor, "; 2.0 to 2.3 are supported"));
  }
  if (geometry != draco::POINT_CLOUD) return broken("it holds no point cloud (a mesh, perhaps)");
  if (method > draco::POINT_CLOUD_KD_TREE_ENCODING) return broken(absl::StrCat("its encoding method is ", method));
  buffer.set_bitstream_version(static_cast<std::uint16_t>(major << 8 | minor));

  DracoHeaderInfo info;
  if ((flags & METADATA_FLAG_MASK) != 0) {
    draco::GeometryMetadata metadata;
    draco::MetadataDecoder decoder;
    if (!decoder.DecodeGeometryMetadata(&buffer, &metadata)) return broken("its metadata cannot be read");
    double min = 0, max = 0;
    if (metadata.GetEntryDouble(kRadiusMinEntry, &min) && metadata.GetEntryDouble(kRadiusMaxEntry, &max)) {
      info.radii = to_range(min, max);
    }
  }
  std::int32_t points = 0;
  if (!buffer.Decode(&points)) return broken("it ends within its header");
  if (points <= 0) return broken(absl::StrCat("it claims ", points, " points"));
  info.points = static_cast<std::uint64_t>(points);
  const std::uint64_t possible = std::min(kMaxPoints, kPointsPerByte * bytes.size() + kFreePoints);
  if (info.points > possible) {
    return broken(
        absl::StrCat("it claims ", info.points, " points in ", bytes.size(), " bytes; at most ", possible, " are accepted"));
  }
  if (absl::Status status = read_attributes(&buffer, &info); !status.ok()) {
    return status;
  }
  return info;
}

/// Copies an attribute of three floats, or an empty vector where there is none.
absl::StatusOr<std::vector<Vec>> copy_vectors(const draco::PointCloud& cloud, draco::GeometryAttribute::Type type,
                                              absl::string_view name) {
  std::vector<Vec> values;
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(type);
  if (attribute == nullptr) return values;
  if (attribute->num_components() != 3) return broken(absl::StrCat("its ", name, " attribute has not three components"));
  const std::size_t n = cloud.num_points();
  values.resize(n);
  if (attribute->data_type() == draco::DT_FLOAT32 && attribute->is_mapping_identity() && attribute->byte_offset() == 0 &&
      attribute->byte_stride() == sizeof(Vec) && attribute->buffer()->data_size() >= n * sizeof(Vec)) {
    std::memcpy(values.data(), attribute->buffer()->data(), n * sizeof(Vec));
  } else {
    for (std::size_t i = 0; i < n; ++i) {
      const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
      if (value.value() >= attribute->size() || !attribute->ConvertValue<float>(value, 3, values[i].data())) {
        return broken(absl::StrCat("its ", name, " attribute cannot be read"));
      }
    }
  }
  return values;
}

absl::Status check_finite(const std::vector<Vec>& values, absl::string_view name) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& [x, y, z] = values[i];
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) {
      return absl::InvalidArgumentError(absl::StrCat("the ", name, " of point ", i, " is not finite"));
    }
  }
  return absl::OkStatus();
}

absl::Status check_finite(const Points& points) {
  if (absl::Status status = check_finite(points.positions, "position"); !status.ok()) return status;
  if (absl::Status status = check_finite(points.normals, "normal"); !status.ok()) return status;
  for (std::size_t i = 0; i < points.radii.size(); ++i) {
    if (!std::isfinite(points.radii[i]) || points.radii[i] < 0) {
      return absl::InvalidArgumentError(absl::StrCat("the radius of point ", i, " is ", points.radii[i]));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<float>> decode_radii(const draco::PointCloud& cloud, RadiusRange range) {
  std::vector<float> radii;
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(draco::GeometryAttribute::GENERIC);
  if (!range.valid() || attribute == nullptr) return radii;
  if (attribute->data_type() != draco::DT_UINT8 || attribute->num_components() != 1) {
    return broken("its radius attribute is not one byte");
  }
  std::array<float, 256> table;
  const double ratio = static_cast<double>(range.max) / static_cast<double>(range.min);
  for (int code = 0; code < 256; ++code) table[code] = static_cast<float>(range.min * std::pow(ratio, code / 255.0));
  radii.resize(cloud.num_points());
  for (std::size_t i = 0; i < radii.size(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= attribute->size()) return broken("its radius attribute is too short");
    radii[i] = table[*attribute->GetAddress(value)];
  }
  return radii;
}

/// Draco's one byte per channel; no colours where a file holds any other type.
absl::StatusOr<std::vector<std::array<std::uint8_t, 3>>> decode_colours(const draco::PointCloud& cloud) {
  std::vector<std::array<std::uint8_t, 3>> colours;
  const draco::PointAttribute* attribute = cloud.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  if (attribute == nullptr || attribute->data_type() != draco::DT_UINT8) return colours;
  if (attribute->num_components() != 3 && attribute->num_components() != 4) return colours;
  colours.resize(cloud.num_points());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const draco::AttributeValueIndex value = attribute->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= attribute->size()) return broken("its colour attribute is too short");
    std::memcpy(colours[i].data(), attribute->GetAddress(value), 3);
  }
  return colours;
}

absl::StatusOr<Points> decode_checked(std::string_view bytes, RadiusRange range, std::uint64_t expected) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  auto cloud = decoder.DecodePointCloudFromBuffer(&buffer);
  if (!cloud.ok()) return broken(cloud.status().error_msg_string());
  if (cloud.value()->num_points() != expected) return broken("it holds another number of points than it claims");
  Points points;
  absl::StatusOr<std::vector<Vec>> positions = copy_vectors(*cloud.value(), draco::GeometryAttribute::POSITION, "position");
  if (!positions.ok()) return positions.status();
  if (positions->size() != expected) return broken("it has no positions");
  absl::StatusOr<std::vector<Vec>> normals = copy_vectors(*cloud.value(), draco::GeometryAttribute::NORMAL, "normal");
  if (!normals.ok()) return normals.status();
  absl::StatusOr<std::vector<float>> radii = decode_radii(*cloud.value(), range);
  if (!radii.ok()) return radii.status();
  absl::StatusOr<std::vector<std::array<std::uint8_t, 3>>> colours = decode_colours(*cloud.value());
  if (!colours.ok()) return colours.status();
  points.positions = *std::move(positions);
  points.normals = *std::move(normals);
  points.radii = *std::move(radii);
  points.colours = *std::move(colours);
  if (absl::Status status = check_finite(points); !status.ok()) return status;
  return points;
}

absl::Status check_size(absl::string_view what, std::size_t bytes, std::uint64_t expected) {
  if (bytes == expected) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(bytes, " bytes of ", what, " where ", expected, " belong"));
}

absl::StatusOr<Points> decode_raw(const v1::RawPoints& raw, std::uint64_t count) {
  if (absl::Status status = check_size("positions", raw.positions().size(), count * sizeof(Vec)); !status.ok()) return status;
  if (absl::Status status = check_size("normals", raw.normals().size(), count * sizeof(Vec)); !status.ok()) return status;
  if (absl::Status status = check_size("radii", raw.radii().size(), count * sizeof(float)); !status.ok()) return status;
  if (!raw.colours().empty()) {
    if (absl::Status status = check_size("colours", raw.colours().size(), 3 * count); !status.ok()) return status;
  }
  Points points;
  points.positions.resize(count);
  points.normals.resize(count);
  points.radii.resize(count);
  points.colours.resize(raw.colours().size() / 3);
  std::memcpy(points.positions.data(), raw.positions().data(), raw.positions().size());
  std::memcpy(points.normals.data(), raw.normals().data(), raw.normals().size());
  std::memcpy(points.radii.data(), raw.radii().data(), raw.radii().size());
  if (!points.colours.empty()) std::memcpy(points.colours.data(), raw.colours().data(), raw.colours().size());
  if (absl::Status status = check_finite(points); !status.ok()) return status;
  return points;
}

/// The attributes that were selected, each with a value for every point.
absl::Status decode_attributes(const v1::PointAttributes& in, std::size_t count, Points& points) {
  const auto read = [&](const std::string& bytes, auto& values) {
    return bytes.empty() || (append_values(bytes, values) && values.size() == count);
  };
  if (!read(in.curvatures(), points.curvatures) || !read(in.ranks(), points.ranks) || !read(in.faces(), points.faces) ||
      !read(in.barycentric(), points.barycentric)) {
    return absl::InvalidArgumentError(absl::StrCat("an attribute has not as many bytes as ", count, " points take"));
  }
  const auto is_finite = [](const std::array<float, 2>& v) { return std::isfinite(v[0]) && std::isfinite(v[1]); };
  if (!std::all_of(points.curvatures.begin(), points.curvatures.end(), is_finite) ||
      !std::all_of(points.barycentric.begin(), points.barycentric.end(), is_finite)) {
    return absl::InvalidArgumentError("an attribute is not finite");
  }
  return absl::OkStatus();
}

absl::StatusOr<Points> decode_data(const v1::PointBlock& block) {
  if (block.count() == 0 && block.has_raw()) return decode_raw(block.raw(), 0);
  if (block.count() == 0) return absl::InvalidArgumentError("it holds no points");
  if (block.has_raw()) return decode_raw(block.raw(), block.count());
  if (!block.has_draco()) return absl::InvalidArgumentError("it is neither Draco nor raw");
  const std::string& bytes = block.draco().data();
  absl::StatusOr<DracoHeaderInfo> header = check_draco_header(bytes);
  if (!header.ok()) return header.status();
  if (header->points != block.count()) {
    return absl::InvalidArgumentError(
        absl::StrCat("its Draco data claims ", header->points, " points, the block ", block.count()));
  }
  const RadiusRange range{block.draco().radius_min(), block.draco().radius_max()};
  if (!range.valid()) return absl::InvalidArgumentError(absl::StrCat("its radii run from ", range.min, " to ", range.max));
  absl::StatusOr<Points> points = decode_draco(bytes, range);
  if (points.ok() && (points->normals.empty() || points->radii.empty())) {
    return absl::InvalidArgumentError("its Draco data lacks normals or radii");
  }
  return points;
}

}  // namespace

absl::StatusOr<DracoHeaderInfo> check_draco_header(std::string_view bytes) {
  try {
    return parse_header(bytes);
  } catch (const std::exception& error) {
    return broken(error.what());
  }
}

absl::StatusOr<Points> decode_draco(std::string_view bytes, RadiusRange radii) {
  absl::StatusOr<DracoHeaderInfo> header = check_draco_header(bytes);
  if (!header.ok()) return header.status();
  try {
    return decode_checked(bytes, radii, header->points);
  } catch (const std::exception& error) {
    return broken(error.what());
  }
}

absl::StatusOr<Points> decode_block(const v1::PointBlock& block) {
  absl::StatusOr<Points> points = decode_data(block);
  absl::Status status = points.status();
  if (status.ok()) status = decode_attributes(block.attributes(), points->size(), *points);
  if (!status.ok()) return absl::DataLossError(absl::StrCat("the server sent a bad block of points: ", status.message()));
  points->origin = {block.origin().x(), block.origin().y(), block.origin().z()};
  for (const double o : points->origin) {
    if (!std::isfinite(o)) return absl::DataLossError("the server sent a bad block of points: its origin is not finite");
  }
  return points;
}

absl::StatusOr<Points> decode_blocks(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks) {
  std::uint64_t total = 0;
  for (const v1::PointBlock& block : blocks) total += block.count();
  if (total > kMaxPoints) return absl::DataLossError(absl::StrCat("the server sent ", total, " points in a frame"));
  const auto count = static_cast<std::size_t>(blocks.size());
  std::vector<absl::StatusOr<Points>> decoded(count, absl::UnknownError(""));
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t b = next++; b < count; b = next++) decoded[b] = decode_block(blocks[static_cast<int>(b)]);
  };
  {
    std::vector<std::jthread> helpers;
    for (std::size_t t = 1; t < std::min<std::size_t>(count, std::thread::hardware_concurrency()); ++t)
      helpers.emplace_back(work);
    work();
  }
  Points out;
  for (absl::StatusOr<Points>& points : decoded) {
    if (!points.ok()) return points.status();
    if (out.size() > 0 && points->origin != out.origin) return absl::DataLossError("the server sent blocks of different origins");
    append_points(*std::move(points), &out);
  }
  const auto is_whole = [&](const auto&... columns) { return ((columns.empty() || columns.size() == out.size()) && ...); };
  if (!is_whole(out.normals, out.radii, out.colours, out.curvatures, out.ranks, out.faces, out.barycentric)) {
    return absl::DataLossError("the server sent blocks of which not all have the same attributes");
  }
  return out;
}

std::uint64_t encoded_bytes(const google::protobuf::RepeatedPtrField<v1::PointBlock>& blocks) {
  return std::accumulate(blocks.begin(), blocks.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const v1::PointBlock& block) { return sum + encoded_bytes(block); });
}

std::uint64_t encoded_bytes(const v1::PointBlock& block) {
  const v1::RawPoints& raw = block.raw();
  const v1::PointAttributes& more = block.attributes();
  return block.draco().data().size() + more.curvatures().size() + more.ranks().size() + more.faces().size() +
         more.barycentric().size() + raw.positions().size() + raw.normals().size() + raw.radii().size() + raw.colours().size();
}

void append_points(Points more, Points* points) {
  if (points->positions.empty()) {
    *points = std::move(more);
    return;
  }
  if (more.origin != points->origin) {
    for (Vec& position : more.positions) {
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] = static_cast<float>(position[axis] + (more.origin[axis] - points->origin[axis]));
      }
    }
  }
  points->positions.insert(points->positions.end(), more.positions.begin(), more.positions.end());
  points->normals.insert(points->normals.end(), more.normals.begin(), more.normals.end());
  points->radii.insert(points->radii.end(), more.radii.begin(), more.radii.end());
  points->colours.insert(points->colours.end(), more.colours.begin(), more.colours.end());
  points->curvatures.insert(points->curvatures.end(), more.curvatures.begin(), more.curvatures.end());
  points->ranks.insert(points->ranks.end(), more.ranks.begin(), more.ranks.end());
  points->faces.insert(points->faces.end(), more.faces.begin(), more.faces.end());
  points->barycentric.insert(points->barycentric.end(), more.barycentric.begin(), more.barycentric.end());
}

}  // namespace curvecast::client
