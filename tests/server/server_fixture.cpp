#include "server_fixture.h"

#include <absl/strings/str_cat.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <utility>

#include "tests/server/web/http_client.h"

namespace curvecast::server {

std::string sphere_off(int levels) {
  using Point = std::array<double, 3>;
  std::vector<Point> points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<std::array<int, 3>> faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                           {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (is_new) {
        Point p;
        for (int i = 0; i < 3; ++i) p[i] = points[a][i] + points[b][i];
        const double length = std::hypot(p[0], p[1], p[2]);
        for (double& x : p) x /= length;
        points.push_back(p);
      }
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  std::string out = absl::StrCat("OFF\n", points.size(), " ", faces.size(), " 0\n");
  for (const auto& p : points) absl::StrAppend(&out, p[0], " ", p[1], " ", p[2], "\n");
  for (const auto& f : faces) absl::StrAppend(&out, "3 ", f[0], " ", f[1], " ", f[2], "\n");
  return out;
}

void ServerFixture::start(ServerOptions options) {
  server_.reset();
  options.listen = "127.0.0.1:0";
  options.log = false;
  auto server = Server::start(options);
  ASSERT_TRUE(server.ok()) << server.status();
  server_ = *std::move(server);
  ASSERT_GT(server_->port(), 0);
}

std::string address_of(const Server& server) { return absl::StrCat("127.0.0.1:", server.port()); }

std::string metrics_of(const Server& server) {
  const bool has_admin = server.admin_port() > 0;
  return HttpClient(has_admin ? server.admin_port() : server.http_port()).get("/metrics").body;
}

std::string ServerFixture::address() const { return address_of(*server_); }

std::shared_ptr<grpc::Channel> ServerFixture::connect() const { return connect_to(*server_); }

std::shared_ptr<grpc::Channel> connect_to(const Server& server) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // else channels to one address share a connection
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 50);
  auto channel = grpc::CreateCustomChannel(address_of(server), grpc::InsecureChannelCredentials(), arguments);
  // gRPC 1.51 looks at errno of connect() only after allocating memory, which may change it: once in a while it gives
  // up a connection that is under way (with whatever error is there), and makes it with its next try.
  channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(30));
  return channel;
}

std::unique_ptr<Stub> client_sending(const Server& server, const std::string& key, const std::string& value) {
  class Sender final : public grpc::experimental::Interceptor, public grpc::experimental::ClientInterceptorFactoryInterface {
   public:
    Sender(std::string key, std::string value) : key_(std::move(key)), value_(std::move(value)) {}
    grpc::experimental::Interceptor* CreateClientInterceptor(grpc::experimental::ClientRpcInfo*) override {
      return new Sender(key_, value_);
    }
    void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
      if (methods->QueryInterceptionHookPoint(grpc::experimental::InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
        methods->GetSendInitialMetadata()->emplace(key_, value_);
      }
      methods->Proceed();
    }

   private:
    const std::string key_, value_;
  };
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own, as above
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> interceptors;
  interceptors.push_back(std::make_unique<Sender>(key, value));
  auto channel = grpc::experimental::CreateCustomChannelWithInterceptors(address_of(server), grpc::InsecureChannelCredentials(),
                                                                         arguments, std::move(interceptors));
  channel->WaitForConnected(std::chrono::system_clock::now() + std::chrono::seconds(30));
  return v1::CurvecastService::NewStub(channel);
}

void set_patience(grpc::ClientContext& context) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  constexpr std::chrono::minutes kPatience(30);  // ten times slower, more on few cores
#else
  constexpr std::chrono::minutes kPatience(2);
#endif
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
}

Uploaded upload(Stub& stub, const v1::UploadHeader& header, const std::string& bytes, std::size_t chunk) {
  Uploaded out;
  grpc::ClientContext context;
  set_patience(context);
  const auto writer = stub.UploadMesh(&context, &out.response);
  v1::UploadMeshRequest request;
  *request.mutable_header() = header;
  bool open = writer->Write(request);
  for (std::size_t at = 0; open && at < bytes.size(); at += chunk) {
    request.set_chunk(bytes.substr(at, chunk));
    open = writer->Write(request);
  }
  if (header.size_is_unknown()) {
    request.set_chunk("");
    writer->Write(request);
  }
  writer->WritesDone();
  out.status = writer->Finish();
  return out;
}

std::string upload(Stub& stub, const std::string& bytes) {
  v1::UploadHeader header;
  header.set_name("test.off");
  header.set_size(bytes.size());
  const Uploaded uploaded = upload(stub, header, bytes);
  EXPECT_TRUE(uploaded.status.ok()) << uploaded.status.error_message();
  return uploaded.response.mesh_id();
}

Created create(Stub& stub, const std::string& mesh_id, std::uint64_t max_points,
               const std::map<std::string, std::string>& companions) {
  v1::SessionOptions options;
  options.set_max_points(max_points);
  return create(stub, mesh_id, options, companions);
}

Created create(Stub& stub, const std::string& mesh_id, const v1::SessionOptions& options,
               const std::map<std::string, std::string>& companions) {
  Created out;
  grpc::ClientContext context;
  set_patience(context);
  v1::CreateSessionRequest request;
  request.set_mesh_id(mesh_id);
  *request.mutable_options() = options;
  request.mutable_companions()->insert(companions.begin(), companions.end());
  const auto reader = stub.CreateSession(&context, request);
  v1::CreateSessionResponse response;
  while (reader->Read(&response)) {
    EXPECT_FALSE(out.session.has_report()) << "a message after the session";
    if (response.has_progress()) out.progress.push_back(response.progress());
    if (response.has_session()) out.session = response.session();
  }
  out.status = reader->Finish();
  return out;
}

std::uint64_t Resampled::points() const {
  std::uint64_t sum = 0;
  for (const auto& block : blocks) sum += block.points().count();
  return sum;
}

std::string Resampled::bytes() const {
  std::string out;
  for (const auto& block : blocks) out += block.points().SerializeAsString();
  return out;
}

Resampled resample(Stub& stub, const std::string& session_id, const v1::SampleRequest& sample) {
  Resampled out;
  grpc::ClientContext context;
  set_patience(context);
  v1::ResampleRequest request;
  request.set_session_id(session_id);
  *request.mutable_sample() = sample;
  const auto reader = stub.Resample(&context, request);
  v1::ResampleResponse response;
  while (reader->Read(&response)) out.blocks.push_back(response);
  out.status = reader->Finish();
  return out;
}

v1::SampleRequest view_of(std::uint64_t points) {
  v1::SampleRequest sample;
  sample.set_points(points);
  sample.add_density()->mutable_view();
  sample.add_cameras()->mutable_eye()->set_z(3);
  return sample;
}

}  // namespace curvecast::server
