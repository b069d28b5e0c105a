// A reflection client: learns the API from the server alone. The messages of reflection itself are taken from the descriptors
// that gRPC's library brings, for their generated headers are not installed.
#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <google/protobuf/dynamic_message.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>

#include <memory>
#include <string>
#include <vector>

#include "server_fixture.h"

namespace curvecast::server {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::DescriptorPool;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using ::testing::Contains;

class ServerReflection : public ServerFixture {
 protected:
  /// A message of grpc.reflection.v1alpha.
  std::unique_ptr<Message> make(const std::string& name) {
    const Descriptor* type = DescriptorPool::generated_pool()->FindMessageTypeByName("grpc.reflection.v1alpha." + name);
    EXPECT_NE(type, nullptr) << name;
    return std::unique_ptr<Message>(factory_.GetPrototype(type)->New());
  }

  /// Sets one string field of a request and returns the answer.
  std::unique_ptr<Message> ask(const std::string& field, const std::string& value) {
    auto request = make("ServerReflectionRequest");
    request->GetReflection()->SetString(request.get(), request->GetDescriptor()->FindFieldByName(field), value);
    grpc::GenericStub stub(connect());
    grpc::CompletionQueue queue;
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub.PrepareCall(&context, "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", &queue);
    void* tag = nullptr;
    bool ok = false;
    stream->StartCall(nullptr);
    EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
    const grpc::Slice sent(request->SerializeAsString());
    stream->WriteLast(grpc::ByteBuffer(&sent, 1), {}, nullptr);
    EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
    grpc::ByteBuffer buffer;
    stream->Read(&buffer, nullptr);
    EXPECT_TRUE(queue.Next(&tag, &ok) && ok);
    grpc::Slice received;
    EXPECT_TRUE(buffer.DumpToSingleSlice(&received).ok());
    auto answer = make("ServerReflectionResponse");
    EXPECT_TRUE(answer->ParseFromArray(received.begin(), static_cast<int>(received.size())));
    grpc::Status status;
    stream->Finish(&status, nullptr);
    EXPECT_TRUE(queue.Next(&tag, &ok));
    EXPECT_TRUE(status.ok()) << status.error_message();
    queue.Shutdown();
    while (queue.Next(&tag, nullptr)) {
    }
    return answer;
  }

  static const Message& part(const Message& message, const std::string& field) {
    return message.GetReflection()->GetMessage(message, message.GetDescriptor()->FindFieldByName(field));
  }

  google::protobuf::DynamicMessageFactory factory_;
};

TEST_F(ServerReflection, ListsItsServices) {
  const auto answer = ask("list_services", "*");
  const Message& list = part(*answer, "list_services_response");
  std::vector<std::string> names;
  const FieldDescriptor* field = list.GetDescriptor()->FindFieldByName("service");
  for (int i = 0; i < list.GetReflection()->FieldSize(list, field); ++i) {
    const Message& service = list.GetReflection()->GetRepeatedMessage(list, field, i);
    names.push_back(service.GetReflection()->GetString(service, service.GetDescriptor()->FindFieldByName("name")));
  }
  EXPECT_THAT(names, Contains("curvecast.v1.CurvecastService"));
  EXPECT_THAT(names, Contains("grpc.health.v1.Health"));
}

TEST_F(ServerReflection, DescribesItsMethods) {
  const auto answer = ask("file_containing_symbol", "curvecast.v1.CurvecastService.StreamViews");
  const Message& files = part(*answer, "file_descriptor_response");
  const FieldDescriptor* field = files.GetDescriptor()->FindFieldByName("file_descriptor_proto");
  DescriptorPool pool;  // knows only what the server tells; dependencies come after what needs them
  for (int i = files.GetReflection()->FieldSize(files, field); i-- > 0;) {
    google::protobuf::FileDescriptorProto file;
    ASSERT_TRUE(file.ParseFromString(files.GetReflection()->GetRepeatedString(files, field, i)));
    ASSERT_NE(pool.BuildFile(file), nullptr) << file.name();
  }
  const auto* method = pool.FindMethodByName("curvecast.v1.CurvecastService.StreamViews");
  ASSERT_NE(method, nullptr);
  EXPECT_TRUE(method->client_streaming() && method->server_streaming());
  EXPECT_EQ(method->input_type()->full_name(), "curvecast.v1.StreamViewsRequest");
  EXPECT_NE(method->output_type()->FindFieldByName("frame"), nullptr);
}

TEST_F(ServerReflection, SaysWhatIsNotThere) {
  const auto answer = ask("file_containing_symbol", "curvecast.v1.Nonsense");
  const Message& error = part(*answer, "error_response");
  EXPECT_EQ(error.GetReflection()->GetInt32(error, error.GetDescriptor()->FindFieldByName("error_code")), grpc::NOT_FOUND);
}

}  // namespace
}  // namespace curvecast::server
