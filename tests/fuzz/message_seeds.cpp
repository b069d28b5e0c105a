#include "tests/fuzz/message_seeds.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/util/delimited_message_util.h>

#include <cstdint>
#include <memory>
#include <utility>

#include "core/pipeline/pipeline.h"
#include "curvecast/v1/curvecast.pb.h"
#include "server/frame/pack_points.h"
#include "server/frame/session_sampler.h"
#include "server/session/session.h"
#include "server/session/session_surface.h"
#include "tests/fuzz/fuzz_expect.h"

namespace curvecast::fuzzing {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr char kMesh[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nproperty float heat\nelement face 2\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0 255 0 0 1\n1 0 0 0 255 0 2\n0 1 0 0 0 255 3\n1 1 1 9 9 9 4\n3 0 1 2\n3 1 3 2\n";

/// All fields are set to something small, but of each oneof one: the `choice`-th.
void fill(Message& message, int choice, int depth = 0) {
  constexpr int kDeepest = 6;
  const google::protobuf::Descriptor& type = *message.GetDescriptor();
  const google::protobuf::Reflection& to = *message.GetReflection();
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor* const field = type.field(i);
    const auto* const oneof = field->real_containing_oneof();
    if (oneof != nullptr && oneof->field(choice % oneof->field_count()) != field) continue;
    const auto set = [&](const auto& single, const auto& repeated, auto value) {
      field->is_repeated() ? (to.*repeated)(&message, field, value) : (to.*single)(&message, field, value);
    };
    using To = google::protobuf::Reflection;
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_DOUBLE:
        set(&To::SetDouble, &To::AddDouble, 0.5 + i);
        break;
      case FieldDescriptor::CPPTYPE_FLOAT:
        set(&To::SetFloat, &To::AddFloat, 0.5F);
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        set(&To::SetUInt64, &To::AddUInt64, std::uint64_t{10});
        break;
      case FieldDescriptor::CPPTYPE_UINT32:
        set(&To::SetUInt32, &To::AddUInt32, std::uint32_t{10});
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        set(&To::SetBool, &To::AddBool, true);
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        set(&To::SetEnumValue, &To::AddEnumValue,
            field->enum_type()->value(choice % field->enum_type()->value_count())->number());
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        set(&To::SetString, &To::AddString, std::string("x"));
        break;
      case FieldDescriptor::CPPTYPE_MESSAGE:
        if (depth == kDeepest) break;
        fill(field->is_repeated() ? *to.AddMessage(&message, field) : *to.MutableMessage(&message, field), choice, depth + 1);
        break;
      default:
        break;
    }
  }
}

void append(std::string& input, const Message& message) {
  google::protobuf::io::StringOutputStream stream(&input);
  expect(google::protobuf::util::SerializeDelimitedToZeroCopyStream(message, &stream), "a message cannot be written");
}

template <typename Request>
void add_filled(std::vector<Seed>& seeds) {
  constexpr int kChoices = 10;  // the most fields of a oneof
  for (int choice = 0; choice < kChoices; ++choice) {
    Request request;
    fill(request, choice);
    append(seeds.emplace_back(Seed{"request", ""}).input, request);
  }
}

void add_requests(std::vector<Seed>& seeds) {
  add_filled<v1::StreamViewsRequest>(seeds);
  add_filled<v1::SampleRequest>(seeds);
  add_filled<v1::SessionOptions>(seeds);
  add_filled<v1::MeasureRequest>(seeds);
  std::string conversation;
  v1::StreamViewsRequest open, view, ack;
  open.mutable_open()->set_session_id(std::string(32, 'a'));
  append(conversation, open);
  for (std::uint64_t sequence = 1; sequence < 4; ++sequence) {
    view.mutable_view()->set_sequence(sequence);
    view.mutable_view()->mutable_sample()->set_points(10 * sequence);
    ack.mutable_ack()->set_sequence(sequence);
    append(conversation, view);
    append(conversation, ack);
  }
  seeds.push_back({"request", conversation});
}

/// Points of a small mesh as a server packs them, twice; the second time in place of some of the first.
std::string frames(const server::Session& session, const server::PointSetRequest& request) {
  server::ViewCache views;
  auto sampled = server::sample_points(session, request, views, {});
  expect(sampled.ok(), sampled.status().ToString());
  const auto packed = server::pack(*std::move(sampled), request);
  expect(packed.ok(), packed.status().ToString());
  v1::PointFrame frame;
  for (const v1::PointBlock& block : packed->blocks) *frame.add_points() = block;
  std::string input;
  append(input, frame);
  v1::PointEdits& edits = *frame.mutable_edits();
  for (std::uint32_t i = 0; i < request.options.points; ++i) edits.add_added(2 * i);
  edits.add_resized(3);
  edits.set_radius_max(1);
  append(input, frame);
  edits.Clear();
  for (std::uint32_t i = 0; i < 2 * request.options.points; ++i) edits.add_removed(i);
  for (std::uint32_t i = 0; i < request.options.points; ++i) edits.add_added(i);
  append(input, frame);
  return input;
}

void add_frames(std::vector<Seed>& seeds) {
  constexpr std::uint64_t kPoints = 20;
  server::Session session;
  session.options = {.points = kPoints, .omega = 2};
  auto made = preprocess({"a.ply", std::string(kMesh)}, session.options);
  expect(made.ok(), made.status().ToString());
  session.preprocessed = *std::move(made);
  session.surface = std::make_shared<server::SessionSurface>(session.preprocessed.flattened);
  session.revisions->publish(session.preprocessed.curve);
  for (const bool has_all : {false, true}) {
    const server::PointAttributes attributes = {
        .curvatures = has_all, .surface = has_all, .directions = has_all, .scalars = has_all};
    for (const std::optional<DracoOptions>& draco :
         {std::optional<DracoOptions>(), std::optional<DracoOptions>(DracoOptions{})}) {
      server::PointSetRequest request{.attributes = attributes, .options = {.points = kPoints}, .draco = draco};
      seeds.push_back({"frame", frames(session, request)});
    }
  }
}

}  // namespace

void add_messages(std::vector<Seed>& seeds) {
  add_requests(seeds);
  add_frames(seeds);
}

}  // namespace curvecast::fuzzing
