// What the HTTP port reads of a browser: requests for pages and probes, and WebSockets with all that comes over them, through the
// gateway's own connections and sockets, with their limits. The other end is a pair of local sockets, and all of it runs on one
// thread, but for calls. Streams of views are real ones of a server without sessions; all other calls are answered by an echo,
// for what those read is the fuzzer `request`'s. Of an input
//   1 byte    whose bits say whether a good request for a WebSocket goes first (0), whether what follows is messages to be put
//             into frames (1), whether callers have to show tokens (2), and whether the request shows a good one (3)
//   the rest  the connection's bytes, or for each message: a byte with FIN and opcode, 2 bytes of its length, and its bytes
#include <absl/cleanup/cleanup.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <google/protobuf/stubs/logging.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <memory>
#include <string>

#include "server/base/log.h"
#include "server/base/options.h"
#include "server/web/web_calls.h"
#include "server/web/web_connection_beast.h"
#include "server/web/web_routes.h"
#include "server/web/web_socket_beast.h"
#include "tests/fuzz/fuzz_bytes.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

const google::protobuf::LogSilencer no_log;  // of each text that is no UTF-8

namespace asio = boost::asio;
using boost::system::error_code;
using Local = asio::local::stream_protocol;

constexpr char kToken[] = "secret";
constexpr char kPage[] = "<!DOCTYPE html>";

/// Any call: each message comes back.
class Echo final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(grpc::GenericCallbackServerContext* /*context*/) override { return new Call; }

 private:
  class Call final : public grpc::ServerGenericBidiReactor {
   public:
    Call() { StartRead(&message_); }
    void OnReadDone(bool ok) override {
      if (!ok) return Finish(grpc::Status::OK);
      StartWrite(&message_);
    }
    void OnWriteDone(bool ok) override {
      if (!ok) return Finish(grpc::Status::CANCELLED);
      message_.Clear();
      StartRead(&message_);
    }
    void OnDone() override { delete this; }

   private:
    grpc::ByteBuffer message_;
  };
};

/// What connections share, all but the gateway's thread.
class World {
 public:
  explicit World(std::shared_ptr<const server::Tokens> tokens)
      : engine_({.threads = 1, .max_view_rate = 1e6}, log_, nullptr, std::move(tokens)) {
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&echo_);
    server_ = builder.BuildAndStart();
    expect(server_ != nullptr, "gRPC does not start");
    channel_ = server_->InProcessChannel({});
  }

  server::WebHub hub(std::shared_ptr<asio::io_context> io) {
    server::WebGatewayOptions options;
    options.sockets = {.path = "/v1/socket",
                       .identify = [this](const server::Peer& peer) { return identify(engine_, peer); },
                       .maker = web_calls(engine_, channel_),
                       .origins = {.others = {"https://example.org"}}};
    const server::WebFile page = {.path = "/index.html", .type = "text/html", .gzip = kPage, .is_immutable = false};
    server::WebRoutes routes = server::page_routes({&page, 1});
    routes.merge(server::probe_routes({.dead = [] { return ""; }, .unready = [] { return "not yet"; }}));
    routes.merge(server::metrics_routes(engine_));
    return {.io = std::move(io),
            .options = std::move(options),
            .routes = std::move(routes),
            .log = log_,
            .admission = std::make_shared<server::Admission>("WebSockets", 10, 10)};
  }

 private:
  const std::shared_ptr<spdlog::logger> log_ = server::make_logger(false, false);
  server::Engine engine_;
  Echo echo_;
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

// Made before the first input, and there until the process ends: threads of gRPC may still look at them.
World* open_world = nullptr;
World* closed_world = nullptr;

std::string upgrade_request(bool shows_token) {
  const std::string token = absl::WebSafeBase64Escape(shows_token ? kToken : "another");
  return absl::StrCat(
      "GET /v1/socket HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nOrigin: http://127.0.0.1:8080\r\nConnection: Upgrade\r\n"
      "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
      "Sec-WebSocket-Protocol: ",
      server::kSubprotocol, ", ", server::kBearerSubprotocol, token, "\r\n\r\n");
}

/// As browsers send it: masked.
std::string frame(std::uint8_t beginning, std::string_view message) {
  constexpr std::array<char, 4> kMask = {'\x12', '\x34', '\x56', '\x78'};
  constexpr std::uint8_t kMasked = 0x80;
  constexpr std::size_t kMostShort = 125, kTwoBytes = 126;
  std::string bytes(1, static_cast<char>(beginning));
  if (message.size() <= kMostShort) {
    bytes += static_cast<char>(kMasked | message.size());
  } else {
    bytes += static_cast<char>(kMasked | kTwoBytes);
    bytes += static_cast<char>(message.size() >> 8);
    bytes += static_cast<char>(message.size() & 0xff);
  }
  bytes.append(kMask.begin(), kMask.end());
  for (std::size_t i = 0; i < message.size(); ++i) bytes += static_cast<char>(message[i] ^ kMask[i % kMask.size()]);
  return bytes;
}

std::string connection_bytes(Bytes& bytes, std::uint8_t bits) {
  std::string out = (bits & 1) != 0 ? upgrade_request((bits & 8) != 0) : "";
  if ((bits & 2) == 0) return out.append(bytes.take_all());
  while (!bytes.empty()) {
    const std::uint8_t beginning = bytes.take();
    const std::uint16_t size = bytes.take<std::uint16_t>();
    out += frame(beginning, bytes.take_text(size));
  }
  return out;
}

/// Sends bytes, and takes whatever comes until the other side ends.
class Browser {
 public:
  Browser(asio::io_context& io, int descriptor, std::string bytes) : socket_(io, Local(), descriptor), bytes_(std::move(bytes)) {
    asio::async_write(socket_, asio::buffer(bytes_), [this](error_code /*ignored*/, std::size_t /*bytes*/) {
      error_code ignored;
      socket_.shutdown(Local::socket::shutdown_send, ignored);
    });
    read();
  }
  const std::string& received() const { return received_; }

 private:
  void read() {
    socket_.async_read_some(asio::buffer(buffer_), [this](error_code error, std::size_t size) {
      received_.append(buffer_.data(), size);
      if (!error) read();
    });
  }

  Local::socket socket_;
  const std::string bytes_;
  std::array<char, 16384> buffer_;
  std::string received_;
};

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const std::uint8_t bits = bytes.take();
  std::array<int, 2> ends{};
  expect(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0, "no sockets");
  const auto io = std::make_shared<asio::io_context>(1);
  server::WebHub hub = ((bits & 4) != 0 ? closed_world : open_world)->hub(io);
  Browser browser(*io, ends[0], connection_bytes(bytes, bits));
  int gone = 0;
  {
    asio::ip::tcp::socket socket(*io, asio::ip::tcp::v4(), ends[1]);  // of another family, which nobody looks at
    std::make_shared<server::WebConnection>(hub, std::move(socket), [&](server::WebConnection*) { ++gone; })->begin();
  }
  io->run();  // until nothing is left that could happen
  expect(gone == 1 && hub.sockets.empty(), "a connection that does not end");
  expect(browser.received().empty() || browser.received().starts_with("HTTP/1."), "an answer that is not HTTP");
}

}  // namespace curvecast::fuzzing

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  using namespace curvecast;
  fuzzing::open_world = new fuzzing::World(nullptr);
  // SHA-256 of kToken.
  constexpr char kTokens[] = "anna 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n";
  const auto tokens = server::Tokens::parse(kTokens, "tokens");
  fuzzing::expect(tokens.ok(), tokens.status().ToString());
  fuzzing::closed_world = new fuzzing::World(*tokens);
  return 0;
}
