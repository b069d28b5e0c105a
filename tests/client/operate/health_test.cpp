// `curvecast health` as a process, and Client::check_health(), asking real servers and others.
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <memory>
#include <thread>

#include "client/lib/client.h"
#include "tests/client/cli_fixture.h"
#include "tests/proto/tls/certificate_files.h"
#include "tests/server/server_fixture.h"

namespace curvecast::cli {
namespace {

using client::Health;
using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr milliseconds kPatience{30'000};

class HealthTest : public CliTest {
 protected:
  /// One in this process. It is not ready yet where `ready` is false.
  static std::unique_ptr<server::Server> start(bool ready) {
    absl::StatusOr<std::unique_ptr<server::Server>> server =
        server::Server::start({.listen = "127.0.0.1:0", .log = false, .ready = ready});
    EXPECT_TRUE(server.ok()) << server.status();
    return server.ok() ? *std::move(server) : nullptr;
  }
  static std::string address_of(const server::Server& server) { return "127.0.0.1:" + std::to_string(server.port()); }
};

TEST_F(HealthTest, FollowsTheServer) {
  const std::unique_ptr<server::Server> server = start(false);
  ASSERT_NE(server, nullptr);
  const std::string address = address_of(*server);
  client::Client client(client::make_connection(client::tcp_channel(address)));
  const auto health = [&] { return client.check_health(kPatience); };
  EXPECT_EQ(health().value(), Health::kNotServing);
  expect_failure({"health", address}, 4, "server " + address + ": NOT_SERVING");
  expect_failure({"health", address, "--json"}, 4, "NOT_SERVING");
  server->set_ready();
  EXPECT_EQ(health().value(), Health::kServing);
  EXPECT_EQ(run({"health", address}).out, "SERVING\n");
  EXPECT_EQ(run({"health", "--server", address}).status, 0);
  EXPECT_EQ(run_json({"health", address}), json({{"server", address}, {"status", "SERVING"}}));
  server->retire();
  EXPECT_EQ(health().value(), Health::kNotServing);
  expect_failure({"health", address}, 4, "NOT_SERVING");
}

TEST_F(HealthTest, AsksAServerInTheSameProcessToo) {
  const std::unique_ptr<server::Server> server = start(true);
  ASSERT_NE(server, nullptr);
  client::Client client(client::make_connection(server->in_process_channel()));
  EXPECT_EQ(client.check_health(kPatience).value(), Health::kServing);
}

TEST_F(HealthTest, NobodyIsNotHealthy) {
  std::string address;
  {
    const std::unique_ptr<server::Server> server = start(true);
    ASSERT_NE(server, nullptr);
    address = address_of(*server);
  }
  expect_failure({"health", address}, 4, address);
}

TEST_F(HealthTest, WhoDoesNotAnswerInTimeIsNotHealthy) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none"});
  const std::string address = server.rest_of_line("listening on ");
  EXPECT_EQ(run({"health", address}).status, 0);
  server.signal(SIGSTOP);  // the kernel still takes connections
  const auto start = std::chrono::steady_clock::now();
  expect_failure({"health", address, "--deadline", "0.5"}, 4, "no answer within 0.5 s");
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(500));
  client::Client client(client::make_connection(client::tcp_channel(address)));
  std::stop_source stop;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(milliseconds(100));
    stop.request_stop();
  });
  EXPECT_TRUE(absl::IsCancelled(client.check_health(kPatience * 100, stop.get_token()).status()));
  server.signal(SIGCONT);
  EXPECT_EQ(run({"health", address}).status, 0);
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(HealthTest, AnotherServerIsNotCurvecast) {
  for (const bool has_health : {false, true}) {
    grpc::EnableDefaultHealthCheckService(has_health);
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    const std::unique_ptr<grpc::Server> other = builder.BuildAndStart();
    ASSERT_NE(other, nullptr);
    expect_failure({"health", "127.0.0.1:" + std::to_string(port)}, 4, "no Curvecast server");
  }
}

TEST_F(HealthTest, NeedsNoTokenButTheEncryptionOfTheServer) {
  const testing::CertificateFiles files;
  const std::string tokens = temporary("health_tokens"), ca = files.cert("ca");
  std::ofstream(tokens) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";  // "secret"
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none", "--tokens", tokens, "--tls-cert", files.cert("ca-server"),
                  "--tls-key", files.key("ca-server")});
  const std::string address = server.rest_of_line("listening on ");
  EXPECT_EQ(run({"health", address, "--tls-ca", ca}).out, "SERVING\n");
  const std::string secret = temporary("health_secret");
  std::ofstream(secret) << "secret\n";
  EXPECT_EQ(run({"health", address, "--tls-ca", ca, "--token-file", secret}).out, "SERVING\n");
  expect_failure({"health", address}, 4, "--tls-ca");
  expect_failure({"health", address, "--tls-ca", files.cert("other")}, 4, "certificate");
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(HealthTest, RefusesWhatItCannotDo) {
  expect_failure({"health", "--deadline", "0"}, 2, "--deadline");
  expect_failure({"health", "--deadline", "soon"}, 2, "--deadline");
  expect_failure({"health", "a:1", "b:2"}, 2, "");
  EXPECT_THAT(run({"health", "--help"}).out, HasSubstr("127.0.0.1:50051"));
}

}  // namespace
}  // namespace curvecast::cli
