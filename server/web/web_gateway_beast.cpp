#include "server/web/web_gateway.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <future>
#include <set>
#include <thread>
#include <utility>

#include "server/base/address.h"
#include "server/web/web_connection_beast.h"
#include "server/web/web_socket_beast.h"

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr char kSessionContext[] = "curvecast";
constexpr auto kEndOfResources = std::chrono::seconds(10);     // for calls that have been cancelled
constexpr auto kAcceptPause = std::chrono::milliseconds(100);  // when there are no descriptors left, say

absl::StatusOr<std::shared_ptr<asio::ssl::context>> make_context(const ServerTls& tls) {
  try {
    auto made = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_server);
    asio::ssl::context& context = *made;
    context.set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 | asio::ssl::context::no_sslv3 |
                        asio::ssl::context::no_tlsv1 | asio::ssl::context::no_tlsv1_1);
    context.use_certificate_chain(asio::buffer(tls.identity.certificates));
    context.use_private_key(asio::buffer(tls.identity.key), asio::ssl::context::pem);
    if (!tls.client_authorities.empty()) {
      context.add_certificate_authority(asio::buffer(tls.client_authorities));
      context.set_verify_mode(asio::ssl::verify_peer);  // of those who show one
      // Without a name of their own, sessions that are resumed are refused where certificates are looked at.
      SSL_CTX_set_session_id_context(context.native_handle(), reinterpret_cast<const unsigned char*>(kSessionContext),
                                     sizeof kSessionContext - 1);
    }
    return made;
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(absl::StrCat("the HTTP port cannot be encrypted: ", error.what()));
  }
}

class BeastGateway final : public WebGateway {
 public:
  BeastGateway(const WebGatewayOptions& options, WebRoutes routes, std::shared_ptr<spdlog::logger> log)
      : hub_{.io = std::make_shared<asio::io_context>(1),
             .options = options,
             .routes = std::move(routes),
             .log = std::move(log)} {}

  ~BeastGateway() override {
    asio::post(*hub_.io, [this] { end(); });
    work_.reset();
    if (thread_.joinable()) {
      thread_.join();  // once all connections are gone
    } else {
      hub_.io->run();
    }
    end_resources();
  }

  absl::Status listen() {
    const absl::StatusOr<Address> address = parse_address(hub_.options.listen);
    if (!address.ok()) return address.status();
    if (hub_.options.tls) {
      auto context = make_context(*hub_.options.tls);
      if (!context.ok()) return context.status();
      hub_.tls = *std::move(context);
    }
    error_code error;
    const auto found = tcp::resolver(*hub_.io).resolve(address->host, std::to_string(address->port),
                                                       tcp::resolver::passive | tcp::resolver::numeric_service, error);
    if (!error) {
      const tcp::endpoint endpoint = found.begin()->endpoint();
      acceptor_.open(endpoint.protocol(), error);
      if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);  // of connections that have just gone
      if (!error) acceptor_.bind(endpoint, error);
      if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
      if (!error) port_ = acceptor_.local_endpoint(error).port();
    }
    if (error) {
      return absl::UnavailableError(absl::StrCat("cannot listen on ", hub_.options.listen, ": ", error.message()));
    }
    prepare();
    accept();
    thread_ = std::thread([this] { run(); });
    return absl::OkStatus();
  }

  int port() const override { return port_; }

  absl::Status replace_tls(const ServerTls& tls) override {
    auto context = make_context(tls);
    if (!context.ok()) return context.status();
    asio::post(*hub_.io, [this, next = *std::move(context)]() mutable {
      if (hub_.tls != nullptr) hub_.tls.swap(next);  // connections have what they need of the old one
    });
    return absl::OkStatus();
  }

  void close_sockets(std::chrono::milliseconds patience) override {
    const auto closed = std::make_shared<std::promise<void>>();
    asio::post(*hub_.io, [this, closed] {
      hub_.takes_sockets = false;
      if (hub_.sockets.empty()) return closed->set_value();
      hub_.on_no_sockets = [closed] { closed->set_value(); };
      for (BeastWebSocket* socket : hub_.sockets) socket->close(WebSocketClose::kGoingAway, "the server is shutting down");
    });
    closed->get_future().wait_for(patience);
  }

 private:
  void prepare() {
    if (!hub_.options.sockets) return;
    const WebSocketOptions& sockets = *hub_.options.sockets;
    hub_.admission = std::make_shared<Admission>("WebSockets", sockets.max_sockets, sockets.max_sockets_of_client);
  }

  void run() {
    for (;;) {
      try {
        hub_.io->run();
        return;
      } catch (const std::exception& error) {  // the connection whose turn it was is gone
        hub_.log->error("http: {}", error.what());
      }
    }
  }

  void accept() {
    accepting_ = true;
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      accepting_ = false;
      if (stopped_) return;
      if (error) return pause();
      const absl::Cleanup next = [this] { accept_more(); };  // even where there is no memory for this one
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      const auto connection =
          std::make_shared<WebConnection>(hub_, std::move(socket), [this](WebConnection* gone) { note_gone(gone); });
      connections_.insert(connection.get());
      if (connections_.size() > hub_.options.max_connections) end_idlest();
      connection->begin();
    });
  }

  void pause() {
    accepting_ = true;
    timer_.expires_after(kAcceptPause);
    timer_.async_wait([this](error_code /*ignored*/) {
      if (!stopped_) accept();
    });
  }

  void accept_more() {
    if (!stopped_ && !accepting_ && connections_.size() <= hub_.options.max_connections) accept();
  }

  /// The connection that has waited longest for a request, if any does, gives way to a new one.
  void end_idlest() {
    WebConnection* idlest = nullptr;
    for (WebConnection* connection : connections_) {
      if (!connection->waiting_since()) continue;
      if (idlest == nullptr || *connection->waiting_since() < *idlest->waiting_since()) idlest = connection;
    }
    if (idlest != nullptr) idlest->abort();
  }

  void note_gone(WebConnection* connection) {
    connections_.erase(connection);
    accept_more();
  }

  /// Requests for resources have been cancelled, and may still ask for something that comes to nothing now.
  void end_resources() {
    if (!hub_.options.sockets || hub_.options.sockets->resources.are_open == nullptr) return;
    const auto end = std::chrono::steady_clock::now() + kEndOfResources;
    while (hub_.options.sockets->resources.are_open() && std::chrono::steady_clock::now() < end) {
      hub_.io->restart();
      hub_.io->poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  void end() {
    stopped_ = true;
    hub_.takes_sockets = false;
    error_code ignored;
    acceptor_.close(ignored);
    timer_.cancel();
    for (WebConnection* connection : connections_) connection->abort();
    for (BeastWebSocket* socket : std::set(hub_.sockets)) socket->abort();
  }

  WebHub hub_;
  int port_ = 0;
  // What follows belongs to the gateway's thread.
  std::set<WebConnection*> connections_;  // that are no WebSockets
  bool accepting_ = false;                // or about to
  bool stopped_ = false;
  asio::executor_work_guard<asio::io_context::executor_type> work_{hub_.io->get_executor()};
  tcp::acceptor acceptor_{*hub_.io};
  asio::steady_timer timer_{*hub_.io};
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<WebGateway>> WebGateway::start(const WebGatewayOptions& options, WebRoutes routes,
                                                              std::shared_ptr<spdlog::logger> log) {
  auto gateway = std::make_unique<BeastGateway>(options, std::move(routes), std::move(log));
  if (absl::Status status = gateway->listen(); !status.ok()) return status;
  return gateway;
}

}  // namespace curvecast::server
