// What a client takes from a server: frames of any bytes, one after the other, on the points that the good ones before left.
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/stubs/logging.h>

#include <algorithm>
#include <optional>
#include <string>

#include "client/lib/point_blocks.h"
#include "client/lib/point_edits.h"
#include "client/lib/protocol.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

const google::protobuf::LogSilencer no_log;  // of each text that is no UTF-8

bool is_whole(const client::Points& points) {
  const auto fits = [&](const auto&... columns) { return ((columns.empty() || columns.size() == points.size()) && ...); };
  return fits(points.normals, points.radii, points.colours, points.curvatures, points.ranks, points.faces, points.barycentric,
              points.directions) &&
         std::all_of(points.scalars.begin(), points.scalars.end(),
                     [&](const auto& scalar) { return scalar.values.size() == points.size(); });
}

void take(const v1::PointFrame& frame, client::Points& held) {
  const absl::StatusOr<client::Points> points = client::decode_blocks(frame.points());
  if (!points.ok()) return expect(absl::IsDataLoss(points.status()), points.status().ToString());
  expect(is_whole(*points), "decode_blocks: columns of different lengths");
  expect(points->size() <= client::kMaxPoints, "decode_blocks: too many points");
  const absl::StatusOr<client::Points> edited = client::apply_edits(held, frame.edits(), *points);
  if (!edited.ok()) return expect(absl::IsInvalidArgument(edited.status()), edited.status().ToString());
  expect(is_whole(*edited), "apply_edits: columns of different lengths");
  expect(edited->size() == held.size() - static_cast<std::size_t>(frame.edits().removed_size()) + points->size(),
         "apply_edits: another number of points");
  held = *edited;
}

}  // namespace
}  // namespace curvecast::fuzzing

/// Frames, each after its length as a varint.
void curvecast::fuzzing::take_input(const std::uint8_t* data, std::size_t size) {
  google::protobuf::io::CodedInputStream input(data, static_cast<int>(size));
  client::Points held;
  std::uint32_t length = 0;
  while (input.ReadVarint32(&length)) {
    std::string bytes;
    if (!input.ReadString(&bytes, static_cast<int>(std::min<std::uint32_t>(length, 1 << 20)))) break;
    v1::PointFrame frame;
    if (frame.ParseFromString(bytes)) take(frame, held);
  }
}
