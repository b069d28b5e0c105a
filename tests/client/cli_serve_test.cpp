// `curvecast serve` as a process.
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <list>
#include <sstream>

#include "tests/client/cli_fixture.h"
#include "tests/proto/tls/certificate_files.h"
#include "tests/server/eventually.h"
#include "tests/server/net/proxy_relay.h"
#include "tests/server/web/http_client.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::cli {
namespace {

using ::testing::HasSubstr;

// How HTTP/2 begins, with settings that set nothing; their last byte is the string's end.
constexpr char kPreface[] = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0";

class ServeTest : public CliTest {};

TEST_F(ServeTest, GivesTheSameBytesAsInProcess) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--open", sphere_});
  const std::string address = server.rest_of_line("listening on ");
  ASSERT_TRUE(server.wait_for("session ")) << server.err();
  const std::string remote = temporary("remote.ply"), local = temporary("local.ply");
  const json far = run_json({"sample", sphere_, "-n", "70000", "--seed", "3", "-o", remote, "--server", address});
  const json near = run_json({"sample", sphere_, "-n", "70000", "--seed", "3", "-o", local});
  EXPECT_EQ(far["session_id"], near["session_id"]);
  EXPECT_EQ(bytes_of(remote), bytes_of(local));
  EXPECT_EQ(run_json({"info", sphere_, "--server", address})["mesh"]["genus"], 0);
  EXPECT_EQ(run_json({"stream", sphere_, "--frames", "3", "-n", "500", "--server", address})["frames"], 3);
  const json opened = run_json({"preprocess", sphere_, "--server", address});
  EXPECT_THAT(server.out(), HasSubstr("session " + opened["session_id"].get<std::string>()));
  server.signal(SIGTERM);
  const Finished finished = server.finish();
  EXPECT_EQ(finished.status, 0) << finished.err;
}

TEST_F(ServeTest, JsonFollowsWhenAllIsOpen) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--open", sphere_, "--json", "--quiet"});
  ASSERT_TRUE(server.wait_for("session_id")) << server.err();
  ASSERT_TRUE(server.wait_for("\n}"));
  const json object = json::parse(server.out(), nullptr, false);
  EXPECT_GT(object["port"], 0);
  EXPECT_EQ(object["sessions"][0]["mesh"], sphere_);
  server.signal(SIGINT);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, ServesOnWhenNobodyReadsItsLines) {
  const std::string second = write_sphere("second_served.off", 20);
  Process reader({"-c", R"(("$0" serve --listen 127.0.0.1:0 --open "$1" --open "$2" & echo "pid $!"; wait) | head -n 2)",
                  CURVECAST_COMMAND, sphere_, second},
                 "/bin/sh");
  const std::string address = reader.rest_of_line("listening on ");
  const auto pid = static_cast<pid_t>(std::stol(reader.rest_of_line("pid ")));
  Finished sessions;
  // The second mesh is opened once the lines of the first are written.
  EXPECT_TRUE(server::eventually([&] {
    sessions = run({"sessions", "--server", address});
    return sessions.status != 0 || sessions.out.find("second_served") != std::string::npos;
  }));
  EXPECT_EQ(sessions.status, 0) << sessions.err;
  if (sessions.status == 0) {
    EXPECT_EQ(::kill(pid, SIGTERM), 0);
  }
  reader.finish();
}

/// The one child of a process; 0: there is none yet.
pid_t child_of(pid_t pid) {
  const std::string task = std::to_string(pid);
  pid_t child = 0;
  std::ifstream("/proc/" + task + "/task/" + task + "/children") >> child;
  return child;
}

bool is_running(pid_t pid) {
  std::string field, state;
  std::ifstream(("/proc/" + std::to_string(pid) + "/stat")) >> field >> field >> state;
  return !state.empty() && state != "Z";
}

TEST_F(ServeTest, TheServerOfABenchmarkEndsWithIt) {
  Process bench({"bench", "stream", sphere_, "--seconds", "600"});
  ASSERT_TRUE(bench.wait_for(": upload")) << bench.err();  // to its server
  const pid_t server = child_of(bench.pid());
  ASSERT_GT(server, 0);
  EXPECT_TRUE(is_running(server));
  bench.signal(SIGKILL);
  bench.finish();
  EXPECT_TRUE(server::eventually([&] { return !is_running(server); }));
}

TEST_F(ServeTest, StopsWhileItOpensAMesh) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--open", write_sphere("big_served.off", 400)});
  ASSERT_TRUE(server.wait_for("big_served.off: ")) << server.err();
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, RefusesWhatItCannotDo) {
  Process server({"serve", "--listen", "127.0.0.1:0"});
  const std::string address = server.rest_of_line("listening on ");
  expect_failure({"serve", "--listen", address}, 4, address);
  expect_failure({"serve", "--listen", "nonsense"}, 3, "nonsense");
  expect_failure({"serve", "--listen", "127.0.0.1:0", "--http", address}, 4, address);
  expect_failure({"serve", "--server", address}, 3, "--server");
  for (const char* flag : {"--max-sessions", "--drain", "--log-format", "--threads"}) {
    expect_failure({"serve", flag, "-1"}, 2, flag);
  }
  Finished finished = run({"serve", "--listen", "127.0.0.1:0", "--open", "/nonexistent/mesh.off"});
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.err, HasSubstr("/nonexistent/mesh.off"));
}

// More connections than the server has descriptors: silent ones on both ports, and some that begin to speak HTTP/2.
TEST_F(ServeTest, ACrowdOfConnectionsKeepsNobodyOut) {
  Process server({"-c", R"(ulimit -n 256; exec "$0" serve --listen 127.0.0.1:0 --http 127.0.0.1:0)", CURVECAST_COMMAND},
                 "/bin/sh");
  rlimit limit = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &limit), 0);
  limit.rlim_cur = limit.rlim_max;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &limit), 0);  // of this process
  const std::string address = server.rest_of_line("listening on "), http = server.rest_of_line("http on ");
  const int port = std::stoi(address.substr(address.rfind(':') + 1)), http_port = std::stoi(http.substr(http.rfind(':') + 1));
  const auto readiness = [&] { return server::HttpClient(http_port).get("/readyz").status; };
  run_json({"info", sphere_, "--server", address});
  {
    std::list<server::HttpClient> crowd;
    for (int i = 0; i < 1000; ++i) {
      crowd.emplace_back(i % 3 == 0 ? http_port : port);
      if (i % 3 == 1) crowd.back().send(std::string(kPreface, sizeof kPreface));
      if (i % 100 == 99) {
        EXPECT_EQ(readiness(), 200) << i;
      }
    }
    run_json({"info", sphere_, "--server", address});
    EXPECT_EQ(readiness(), 200);
  }
  run_json({"info", sphere_, "--server", address});
  EXPECT_EQ(readiness(), 200);
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

// gRPC makes a connection again while somebody waits for it, and fails all calls until then. That is for a process of its own to
// show: the wait of any other gRPC in this one would do.
TEST_F(ServeTest, AConnectionThatWasResetIsMadeAgain) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none"});
  const std::string address = server.rest_of_line("listening on ");
  const server::ProxyRelay relay(std::stoi(address.substr(address.rfind(':') + 1)), "", 2);
  run_json({"info", sphere_, "--server", "127.0.0.1:" + std::to_string(relay.port())});
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, WhoIsOpenToAllSaysSo) {
  for (const char* address : {"0.0.0.0:0", "[::]:0"}) {
    expect_failure({"serve", "--listen", address, "--http", "none"}, 3, "--open-to-all");
    expect_failure({"serve", "--listen", "127.0.0.1:0", "--http", address}, 3, "--tokens");
  }
  const std::string tokens = temporary("open_tokens");
  std::ofstream(tokens) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";  // "secret"
  Process open({"serve", "--listen", "0.0.0.0:0", "--http", "none", "--open-to-all"});
  Process known({"serve", "--listen", "0.0.0.0:0", "--http", "none", "--tokens", tokens});
  Process local({"serve", "--listen", "localhost:0", "--http", "none"});
  for (Process* process : {&open, &known, &local}) {
    EXPECT_NE(process->rest_of_line("listening on "), "");
    process->signal(SIGTERM);
    EXPECT_EQ(process->finish().status, 0);
  }
}

// For each: printf %s "anna's" | sha256sum
constexpr char kAnna[] = "anna 8f68ce373d4607a65f1b1ce5c42eef43dcc492fdf17a5bb36bdca6d656ca21da\n";
constexpr char kBert[] = "bert a1eeb16073426839c5dfabc8fc71999ccbcee5ee0ce82ca9588a528582c4bb17\n";

TEST_F(ServeTest, ReadsTokensAnewWhenItIsTold) {
  const std::string tokens = temporary("live_tokens"), annas = temporary("annas_token"), berts = temporary("berts_token");
  std::ofstream(annas) << "anna's";
  std::ofstream(berts) << "bert's";
  std::ofstream(tokens) << kAnna;
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none", "--tokens", tokens});
  const std::string address = server.rest_of_line("listening on ");
  const auto status_with = [&](const std::string& token) {
    return run({"sessions", "--server", address, "--token-file", token}).status;
  };
  EXPECT_EQ(status_with(annas), 0);
  EXPECT_NE(status_with(berts), 0);
  std::ofstream(tokens) << kBert;
  server.signal(SIGHUP);
  ASSERT_TRUE(server.wait_for("tokens read anew")) << server.err();
  EXPECT_NE(status_with(annas), 0);
  EXPECT_EQ(status_with(berts), 0);
  std::ofstream(tokens) << "nonsense\n";
  server.signal(SIGHUP);
  ASSERT_TRUE(server.wait_for("tokens stay as they were: " + tokens)) << server.err();
  EXPECT_EQ(status_with(berts), 0);
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, IsReadyWhenItsMeshesAreOpen) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "127.0.0.1:0", "--open", write_sphere("slow_served.off", 300)});
  const std::string address = server.rest_of_line("http on ");
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  EXPECT_EQ(server::HttpClient(port).get("/healthz").status, 200);
  EXPECT_EQ(server::HttpClient(port).get("/readyz").body, "meshes are being prepared\n");
  ASSERT_TRUE(server.wait_for("session ")) << server.err();
  int status = 0;  // 0: no answer
  do {
    status = server::HttpClient(port).get("/readyz").status;
  } while (status == 503);  // the line comes a moment before
  EXPECT_EQ(status, 200);
  const std::string metrics = server::HttpClient(port).get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("curvecast_requests_total{code=\"OK\",method=\"CreateSession\"} 1\n"));
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, SaysWhereABrowserFindsTheViewer) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--open", write_sphere("viewed.off", 20)});
  const std::string http = server.rest_of_line("http on ");
  ASSERT_TRUE(server.wait_for("session ")) << server.err();
  const server::HttpClient::Response page = server::HttpClient(std::stoi(http.substr(http.rfind(':') + 1))).get("/");
  if (page.status == 200) {  // else built without it
    EXPECT_THAT(page.header, HasSubstr("text/html"));
    ASSERT_TRUE(server.wait_for("look at http://" + http + "/#session=")) << server.out();
  }
  Process second({"serve", "--listen", "127.0.0.1:0"});
  EXPECT_NE(second.rest_of_line("http on "), http);  // the default port is taken, at least by the first one
  Process none({"serve", "--listen", "127.0.0.1:0", "--http", "none", "--open", write_sphere("unviewed.off", 20)});
  ASSERT_TRUE(none.wait_for("session ")) << none.err();
  for (Process* process : {&server, &second, &none}) {
    process->signal(SIGTERM);
    const Finished finished = process->finish();
    EXPECT_EQ(finished.status, 0);
    EXPECT_EQ(finished.out.find("http") == std::string::npos, process == &none) << finished.out;
  }
}

TEST_F(ServeTest, ALameDuckServesOnWhileItSaysThatItEnds) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--http", "none", "--admin", "0", "--lame-duck", "3600"});
  const std::string address = server.rest_of_line("listening on "), admin = server.rest_of_line("admin on 127.0.0.1:");
  const auto readiness = [&] { return server::HttpClient(std::stoi(admin)).get("/readyz").status; };
  EXPECT_EQ(readiness(), 200);
  server.signal(SIGTERM);
  EXPECT_TRUE(server::eventually([&] { return readiness() == 503; }));
  run_json({"info", sphere_, "--server", address});
  EXPECT_EQ(readiness(), 503);
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 130);
}

TEST_F(ServeTest, TheSecondSignalEndsItAtOnce) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--drain", "3600"});
  const std::string address = server.rest_of_line("listening on ");
  Process client({"preprocess", write_sphere("big_drained.off", 400), "-n", "4000000", "--server", address});
  ASSERT_TRUE(client.wait_for("repair")) << client.err();
  server.signal(SIGTERM);
  ASSERT_TRUE(server.wait_for("running calls get 3600 s")) << server.err();
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 130);
  EXPECT_EQ(client.finish().status, 4);
}

TEST_F(ServeTest, CallsThatTakeLongerThanTheDrainAreCancelled) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--drain", "0.1"});
  const std::string address = server.rest_of_line("listening on ");
  Process client({"preprocess", write_sphere("big_cancelled.off", 400), "-n", "4000000", "--server", address});
  ASSERT_TRUE(client.wait_for("repair")) << client.err();
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
  EXPECT_EQ(client.finish().status, 4);
}

TEST_F(ServeTest, ADiskThatDoesNotGetOnHoldsUpTheEndForAWhileOnly) {
  const testing::TemporaryFolder cache;
  const std::vector<std::string> arguments = {"serve", "--listen", "127.0.0.1:0", "--http",  "none",      "--open",
                                              sphere_, "-n",       "1000",        "--cache", cache.path()};
  const auto expect_end_with_all_saved = [&] {
    Process server(arguments);
    const std::string id = server.rest_of_line("session ").substr(0, 32);
    server.signal(SIGTERM);
    EXPECT_EQ(server.finish().status, 0);
    const std::vector<std::string> names = cache.names();
    EXPECT_TRUE(std::ranges::any_of(names, [&](auto& name) { return name.starts_with(id) && name.ends_with(".curve"); }));
    EXPECT_TRUE(std::ranges::none_of(names, [](auto& name) { return name.ends_with("-tmp"); })) << "it had been killed";
    return id;
  };
  const std::string id = expect_end_with_all_saved();
  for (const std::string& name : cache.names()) {
    if (name.starts_with(id)) std::filesystem::remove(cache / name);  // the mesh stays
  }
  std::vector<std::string> stuck = {"-c",
                                    R"(export LD_PRELOAD="$0" ASAN_OPTIONS="$ASAN_OPTIONS:verify_asan_link_order=0"; exec "$@")",
                                    CURVECAST_STUCK_DISK, CURVECAST_COMMAND};
  stuck.insert(stuck.end(), arguments.begin(), arguments.end());
  stuck.insert(stuck.end(), {"--drain", "0", "--max-stop-time", "0.2"});
  Process server(stuck, "/bin/sh");
  EXPECT_EQ(server.rest_of_line("session ").substr(0, 32), id) << server.err();
  server.signal(SIGTERM);
  const Finished finished = server.finish();
  EXPECT_EQ(finished.status, 4) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("session " + id + " is not cached: there was no time left"));
  EXPECT_THAT(finished.err, HasSubstr("the server could not end in time; sessions that are not in the cache: 1"));
  EXPECT_EQ(expect_end_with_all_saved(), id);
}

TEST_F(ServeTest, SettingsComeFromFlagsTheEnvironmentAndAFile) {
  const std::string file = temporary("serve.toml");
  std::ofstream(file) << "listen = \"127.0.0.1:1\"\nmax-upload = \"1MB\"\nmax-sessions = 5\nthreads = 2\ndrain = 0.5\n";
  ASSERT_EQ(::setenv("CURVECAST_MAX_SESSIONS", "6", 1), 0);
  ASSERT_EQ(::setenv("CURVECAST_THREADS", "1", 1), 0);
  const Finished printed = run({"serve", "--config", file, "--threads", "3", "--print-config"});
  Process server({"serve", "--config", file, "--listen", "127.0.0.1:0"});
  const std::string address = server.rest_of_line("listening on ");
  ::unsetenv("CURVECAST_MAX_SESSIONS");
  ::unsetenv("CURVECAST_THREADS");
  EXPECT_EQ(printed.status, 0) << printed.err;
  for (const char* line : {"\nlisten=\"127.0.0.1:1\"\n", "\nmax-upload=1048576\n", "\nmax-sessions=6\n", "\nthreads=3\n",
                           "\ndrain=0.5\n", "\nlog-format=\"text\"\n", "\nmax-curve-vertices=20000000\n"}) {
    EXPECT_THAT(printed.out, HasSubstr(line));
  }
  for (const std::string& line :
       {std::string("setting listen = 127.0.0.1:0 (flag)"), "setting drain = 0.5 (" + file + ")",
        std::string("setting threads = 1 (CURVECAST_THREADS)"), std::string("setting log-format = text (default)")}) {
    EXPECT_THAT(server.err(), HasSubstr(line));
  }
  EXPECT_LT(server.err().find("curvecast 0."), server.err().find("setting "));
  // The limit is in force: the sphere is larger than nothing, but this one than a megabyte.
  expect_failure({"info", write_sphere("large.off", 300), "--server", address}, 4, "1048576");
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
  // What was printed is such a file again.
  const std::string again = temporary("again.toml");
  std::ofstream(again) << printed.out;
  EXPECT_EQ(run({"serve", "--config", again, "--print-config"}).out, printed.out);
}

TEST_F(ServeTest, SaysWhatIsWrongWithItsSettings) {
  const std::string file = temporary("wrong.toml");
  std::ofstream(file) << "lisen = \"127.0.0.1:0\"\n";
  expect_failure({"serve", "--config", file}, 3,
                 file + ": there is no setting named lisen; there are: admin, area, base-density, cache, ");
  std::ofstream(file) << "verbose = true\nquiet = true\n";
  expect_failure({"serve", "--config", file}, 3, "quiet and verbose");
  expect_failure({"serve", "--config", "/nonexistent.toml"}, 3, "/nonexistent.toml");
}

TEST_F(ServeTest, EncryptsForThoseWhoBelieveIt) {
  const testing::CertificateFiles files;
  Process server({"serve", "--listen", "127.0.0.1:0", "--tls-cert", files.cert("ca-server"), "--tls-key", files.key("ca-server"),
                  "--tls-client-ca", files.cert("ca")});
  const std::string address = server.rest_of_line("listening on "), ca = files.cert("ca");
  const std::string cert = files.cert("ca-client"), key = files.key("ca-client");
  run_json({"info", sphere_, "--server", address, "--tls-ca", ca, "--tls-cert", cert, "--tls-key", key});
  expect_failure({"info", sphere_, "--server", address, "--tls-ca", ca}, 4, address);
  expect_failure({"info", sphere_, "--server", address}, 4, "--tls-ca");
  expect_failure({"info", sphere_, "--server", address, "--tls-ca", files.cert("other")}, 4, "certificate");
  expect_failure({"info", sphere_, "--server", address, "--tls-ca", "/nonexistent.pem"}, 3, "/nonexistent.pem");
  expect_failure({"info", sphere_, "--server", address, "--tls-cert", cert}, 3, "belong together");
  expect_failure({"info", sphere_, "--tls-ca", ca}, 3, "--server");
  expect_failure({"serve", "--listen", "127.0.0.1:0", "--tls-cert", cert, "--tls-key", files.key("other-client")}, 3,
                 "does not belong to the certificate");
  server.signal(SIGTERM);
  EXPECT_EQ(server.finish().status, 0);
}

TEST_F(ServeTest, LogsRequestsAsJson) {
  Process server({"serve", "--listen", "127.0.0.1:0", "--log-format", "json", "--verbose"});
  const std::string address = server.rest_of_line("listening on ");
  run_json({"info", sphere_, "--server", address});
  ASSERT_TRUE(server.wait_for("InspectMesh")) << server.err();
  server.signal(SIGTERM);
  const Finished finished = server.finish();
  EXPECT_EQ(finished.status, 0);
  std::istringstream lines(finished.err);
  std::string line;
  int requests = 0;
  while (std::getline(lines, line)) {
    const json object = json::parse(line, nullptr, false);
    ASSERT_TRUE(object.is_object()) << line;
    expect_keys(object, {"time", "level", "message"});
    if (!object.contains("method")) continue;
    ++requests;
    expect_keys(object, {"peer", "code", "ms", "request_id"});
    EXPECT_GE(object["ms"].get<double>(), 0);
    EXPECT_EQ(object["request_id"].get<std::string>().size(), 16U);
  }
  EXPECT_GE(requests, 2);  // UploadMesh and InspectMesh
}

}  // namespace
}  // namespace curvecast::cli
