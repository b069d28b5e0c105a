#include "server/web/web_connection_beast.h"

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>
#include <openssl/ssl.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "proto/tls/certificate_name.h"
#include "server/net/peer_name.h"
#include "server/net/proxy_queue.h"
#include "server/web/web_exchange_beast.h"
#include "server/web/web_socket_beast.h"

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

constexpr std::uint32_t kMaxHeader = 8 * 1024;        // bytes
constexpr std::size_t kMaxBuffered = 2 * kMaxHeader;  // requests that come before the answer to the one before
constexpr std::size_t kMostLingering = 1 << 20;       // bytes that are read for nobody
constexpr auto kLingering = std::chrono::seconds(2);

constexpr char kPageField[] = "Curvecast-Page";  // of requests that are answered later: browsers let no foreign page send it

using PlainResponse = http::response<http::string_body>;

PlainResponse plain(http::status status, std::string body) {
  PlainResponse response(status, 11);
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.body() = std::move(body);
  return response;
}

std::string_view text(beast::string_view view) { return {view.data(), view.size()}; }
absl::string_view to_absl(std::string_view view) { return {view.data(), view.size()}; }

PlainResponse to_response(WebAnswer made) {
  PlainResponse response(static_cast<http::status>(made.status), 11);
  response.set(http::field::content_type, made.type);
  for (const auto& [name, value] : made.header) response.set(name, value);
  response.body() = std::move(made.body);
  return response;
}

std::string name_of(const tcp::socket& socket) {
  boost::system::error_code error;
  const tcp::endpoint peer = socket.remote_endpoint(error);
  return peer_name((error ? tcp::endpoint() : peer).data());
}

/// Null where it is clear how long the body is: else other servers and this one could tell requests apart differently.
std::optional<PlainResponse> refuse_framing(const http::request<http::empty_body>& request) {
  const auto coding = request.find(http::field::transfer_encoding);
  if (coding == request.end()) return std::nullopt;
  if (request.version() < 11) return plain(http::status::bad_request, "HTTP/1.0 has no Transfer-Encoding\n");
  if (beast::iequals(coding->value(), "chunked")) return std::nullopt;
  return plain(http::status::not_implemented, "of Transfer-Encoding only chunked is taken\n");
}

struct Offer {
  bool has_ours = false;           // the subprotocol that we speak
  std::string authorization = {};  // of the token that came with it
};

/// Empty where it can be no token: it goes on to gRPC, which ends the process when it is given anything but printable ASCII.
std::string authorization_of(absl::string_view token) {
  token = absl::StripAsciiWhitespace(token);
  const bool is_text = std::all_of(token.begin(), token.end(), [](char c) { return absl::ascii_isprint(c); });
  return is_text && !token.empty() ? absl::StrCat("Bearer ", token) : "";
}

Offer read_offer(std::string_view subprotocols) {
  Offer offer;
  for (absl::string_view name : absl::StrSplit(absl::string_view(subprotocols.data(), subprotocols.size()), ',')) {
    name = absl::StripAsciiWhitespace(name);
    if (name == kSubprotocol) offer.has_ours = true;
    std::string token;
    if (absl::ConsumePrefix(&name, kBearerSubprotocol) && absl::WebSafeBase64Unescape(name, &token)) {
      offer.authorization = authorization_of(token);
    }
  }
  return offer;
}

}  // namespace

void WebHub::forget(BeastWebSocket& socket) {
  sockets.erase(&socket);
  if (!sockets.empty() || on_no_sockets == nullptr) return;
  std::exchange(on_no_sockets, nullptr)();
}

WebConnection::WebConnection(WebHub& hub, tcp::socket socket, std::function<void(WebConnection*)> on_gone)
    : hub_(hub),
      stream_(std::move(socket), hub.tls.get()),
      address_(name_of(stream_.next_layer().socket())),
      on_gone_(std::move(on_gone)),
      buffer_(kMaxBuffered),
      timer_(*hub.io) {}

WebConnection::~WebConnection() { on_gone_(this); }

void WebConnection::begin() {
  waiting_since_ = Clock::now();  // for a handshake, too
  const bool is_proxy = hub_.options.sockets && hub_.options.sockets->proxies.trusts(address_);
  is_proxy ? meet_proxy(Clock::now() + kProxyPatience) : shake_hands();
}

void WebConnection::meet_proxy(Clock::time_point end) {
  tcp::socket& socket = stream_.next_layer().socket();
  if (!socket.is_open()) return;  // abort()
  const std::optional<ProxyHeader> header = take_proxy_header(socket.native_handle(), end);
  if (!header) {
    timer_.expires_after(kProxyLook);
    timer_.async_wait([self = shared_from_this(), end](Error /*error*/) { self->meet_proxy(end); });
    return;
  }
  if (header->state == ProxyHeader::State::kBroken) return abort();
  if (!header->client.empty()) address_ = header->client;
  shake_hands();
}

void WebConnection::shake_hands() {
  if (stream_.tls() == nullptr) return read();
  stream_.next_layer().expires_after(hub_.options.time_out);
  stream_.tls()->async_handshake(asio::ssl::stream_base::server, [self = shared_from_this()](Error error) {
    if (!error) self->read();
  });
}

void WebConnection::abort() { lose_client(); }

void WebConnection::read() {
  waiting_since_ = Clock::now();
  parser_.emplace();
  parser_->header_limit(kMaxHeader);
  parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // none is read
  stream_.next_layer().expires_after(hub_.options.time_out);       // however slowly it comes
  http::async_read_header(stream_, buffer_, *parser_,
                          [self = shared_from_this()](Error error, std::size_t /*bytes*/) { self->receive(error); });
}

void WebConnection::receive(Error error) {
  waiting_since_.reset();
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    return refuse(http::status::request_header_fields_too_large, "the header is too long\n");
  }
  const bool is_malformed = error.category() == http::make_error_code(http::error::bad_method).category();
  if (error == http::error::end_of_stream || error == http::error::partial_message || (error && !is_malformed)) return close();
  if (error) return refuse(http::status::bad_request, "this is not HTTP/1.1\n");
  const bool has_body = !parser_->is_done();
  const Request& request = parser_->get();
  asked_ = {request.version(), request.keep_alive(), request.method() == http::verb::head};
  has_unread_body_ = has_body;
  body_.reset();
  if (auto refused = refuse_framing(request)) {
    has_unread_body_ = true;  // whatever follows is part of it
    return answer_now(*std::move(refused));
  }
  std::optional<Response> response;
  try {
    response = is_upgrade(request) ? upgrade(request) : answer(request, has_body);
  } catch (const std::exception& failure) {  // of the standard library, such as bad_alloc
    hub_.log->error("http: {}", failure.what());
    if (!stream_.is_there()) return;  // it was to become a WebSocket
    response = plain(http::status::internal_server_error, "the server failed\n");
  }
  if (response) answer_now(*std::move(response));
}

void WebConnection::answer_now(Response response) {
  open_question_ = 0;
  timer_.cancel();
  on_lost_ = nullptr;
  if (body_ != nullptr) has_unread_body_ = !body_->is_done();
  response.version(asked_.version);
  response.keep_alive(asked_.keeps_alive && !has_unread_body_);  // after a body that is not read nothing can follow
  write(std::move(response), asked_.is_head);
}

std::optional<WebConnection::Response> WebConnection::answer(const Request& request, bool has_body) {
  const std::string_view target = text(request.target());
  const std::string_view path = target.substr(0, target.find('?'));
  const WebLateRoutes* const late_routes = hub_.options.sockets ? &hub_.options.sockets->late_routes : nullptr;
  const bool is_late = late_routes != nullptr && late_routes->count(path) > 0;
  const auto route = hub_.routes.find(path);
  if (!is_late && route == hub_.routes.end()) {
    const bool has_resources = hub_.options.sockets && hub_.options.sockets->resources.begin != nullptr;
    if (has_resources && path.starts_with(hub_.options.sockets->resources.prefix)) return begin_exchange(request);
    return plain(http::status::not_found, "there is nothing of this name\n");
  }
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    Response response = plain(http::status::method_not_allowed, "only GET and HEAD are answered\n");
    response.set(http::field::allow, "GET, HEAD");
    return response;
  }
  if (has_body) return plain(http::status::payload_too_large, "no body is taken\n");
  if (is_late) return answer_later(request, late_routes->find(path)->second);
  return to_response(route->second());
}

std::optional<WebConnection::Response> WebConnection::answer_later(const Request& request,
                                                                   const WebLateRoutes::mapped_type& answer) {
  // Browsers name no origin where a page asks its own server: whoever asks counts as a page of the name by which it found us.
  // Pages of others can neither send this request's header nor read the answer.
  const std::string_view host = text(request[http::field::host]);
  const auto is_page_of = [&](std::string_view scheme) {
    return is_allowed(hub_.options.sockets->origins, absl::StrCat(to_absl(scheme), to_absl(host)), host);
  };
  if (request[kPageField].empty() || !(is_page_of("http://") || is_page_of("https://"))) {
    return plain(http::status::forbidden, "this is for pages of this server\n");
  }
  const absl::StatusOr<Peer> known = peer_of(request);
  if (!known.ok()) return plain(http::status::forbidden, absl::StrCat(known.status().message(), "\n"));
  const std::string_view target = text(request.target());
  const std::size_t mark = target.find('?');
  WebQuestion question{*known, mark == std::string_view::npos ? "" : std::string(target.substr(mark + 1))};
  absl::string_view token = to_absl(text(request[http::field::authorization]));
  if (absl::ConsumePrefix(&token, "Bearer ")) question.peer.authorization = authorization_of(token);

  open_question_ = ++last_question_;
  const auto finish = [number = last_question_](WebConnection& self, Response response) {
    if (self.open_question_ == number) self.answer_now(std::move(response));
  };
  timer_.expires_after(hub_.options.time_out);
  timer_.async_wait([self = shared_from_this(), finish](Error error) {
    if (!error) finish(*self, plain(http::status::service_unavailable, "the answer takes too long\n"));
  });
  answer(question, [io = hub_.io, waiting = weak_from_this(), finish](WebAnswer made) {
    asio::post(*io, [waiting, finish, made = std::move(made)]() mutable {
      if (const auto self = waiting.lock()) finish(*self, to_response(std::move(made)));
    });
  });
  return std::nullopt;
}

std::optional<WebConnection::Response> WebConnection::begin_exchange(const Request& request) {
  absl::StatusOr<Peer> known = peer_of(request);
  if (!known.ok()) return plain(http::status::forbidden, absl::StrCat(known.status().message(), "\n"));
  absl::string_view token = to_absl(text(request[http::field::authorization]));
  if (absl::ConsumePrefix(&token, "Bearer ")) known->authorization = authorization_of(token);
  const std::string_view target = text(request.target());
  const std::size_t mark = target.find('?');
  const auto field = [&](auto name) { return std::string(text(request[name])); };
  WebRequest asked{.method = std::string(text(request.method_string())),
                   .path = std::string(target.substr(0, mark)),
                   .query = mark == std::string_view::npos ? "" : std::string(target.substr(mark + 1)),
                   .host = field(http::field::host),
                   .origin = field(http::field::origin),
                   .fetch_site = field("Sec-Fetch-Site"),
                   .content_type = field(http::field::content_type),
                   .if_none_match = field(http::field::if_none_match),
                   .request_id = field("X-Request-Id"),
                   .preflight_method = field(http::field::access_control_request_method),
                   .has_body = has_unread_body_,
                   .peer = *std::move(known)};
  if (const auto bytes = parser_->content_length()) asked.body_bytes = *bytes;
  open_question_ = ++last_question_;
  if (has_unread_body_) body_ = std::make_unique<WebBody>(stream_, buffer_, std::move(*parser_), hub_.options.time_out);
  const auto exchange = std::make_shared<BeastExchange>(hub_.io, weak_from_this(), open_question_, std::move(asked));
  keep_watch();
  hub_.options.sockets->resources.begin(exchange);
  return std::nullopt;
}

void WebConnection::answer_exchange(std::uint64_t number, WebAnswer answer) {
  if (open_question_ != number) return;
  if (body_ != nullptr && body_->is_reading()) return lose_client();  // nothing can follow what is still being read
  held_ = std::move(answer.held);
  answer_now(to_response(std::move(answer)));
}

bool WebConnection::is_upgrade(const Request& request) const {
  const std::string_view target = text(request.target());
  return hub_.options.sockets && target.substr(0, target.find('?')) == hub_.options.sockets->path;
}

absl::StatusOr<Peer> WebConnection::peer_of(const Request& request) {
  std::vector<std::string_view> forwarded_for;
  const auto [begin, end] = request.equal_range("x-forwarded-for");
  for (auto field = begin; field != end; ++field) forwarded_for.push_back(text(field->value()));
  const auto client = hub_.options.sockets->proxies.client_of(address_, forwarded_for);
  Peer peer{.address = client.value_or(address_), .comes_by_proxy = client.has_value()};
  if (hub_.options.tls && !hub_.options.tls->client_authorities.empty()) {
    X509* const certificate = SSL_get_peer_certificate(stream_.tls()->native_handle());
    if (certificate == nullptr) return absl::UnauthenticatedError("a client's certificate is wanted");
    peer.certificate = tls::certificate_name(certificate);
    X509_free(certificate);
  }
  return peer;
}

std::optional<WebConnection::Response> WebConnection::upgrade(const Request& request) {
  const auto refused = [&](http::status status, std::string reason) {
    hub_.log->debug("http: no WebSocket for {}: {}", address_, reason);
    return plain(status, std::move(reason) + "\n");
  };
  if (!beast::websocket::is_upgrade(request)) {
    Response response = refused(http::status::upgrade_required, "this is for WebSockets");
    response.set(http::field::upgrade, "websocket");
    return response;
  }
  if (!is_allowed(hub_.options.sockets->origins, text(request[http::field::origin]), text(request[http::field::host]))) {
    return refused(http::status::forbidden, "pages of this origin may not connect");
  }
  absl::StatusOr<Peer> known = peer_of(request);
  if (!known.ok()) return refused(http::status::forbidden, std::string(known.status().message()));
  Peer peer = *std::move(known);
  const Offer offer = read_offer(text(request[http::field::sec_websocket_protocol]));
  if (!offer.has_ours) return refused(http::status::bad_request, absl::StrCat("the subprotocol spoken here is ", kSubprotocol));
  if (!hub_.takes_sockets) return refused(http::status::service_unavailable, "the server is shutting down");
  peer.authorization = offer.authorization;
  const absl::StatusOr<Caller> caller = hub_.options.sockets->identify(peer);
  absl::StatusOr<Admission::Ticket> ticket = hub_.admission->admit(caller.ok() ? caller->name : client_of_peer(peer.address));
  if (!ticket.ok()) return refused(http::status::too_many_requests, std::string(ticket.status().message()));
  const auto socket = std::make_shared<BeastWebSocket>(hub_.io, std::move(stream_), *std::move(ticket),
                                                       [&hub = hub_](BeastWebSocket& over) { hub.forget(over); });
  hub_.sockets.insert(socket.get());
  socket->accept(request, {peer, caller}, hub_.options.sockets->maker);
  return std::nullopt;
}

void WebConnection::refuse(http::status status, std::string reason) {
  Response response = plain(status, std::move(reason));
  response.keep_alive(false);
  write(std::move(response), false);
}

void WebConnection::write(Response response, bool is_head) {
  if (response.count(http::field::cache_control) == 0) response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  if (response.result() != http::status::no_content && response.result() != http::status::not_modified) {
    response.content_length(response.body().size());
  }
  if (is_head) response.body().clear();
  response_ = std::move(response);
  stream_.next_layer().expires_after(hub_.options.time_out + std::chrono::seconds(response_.body().size() / kLeastRate));
  http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t /*bytes*/) {
    self->held_.reset();
    if (!error && self->has_unread_body_) return self->linger();
    if (error || self->response_.need_eof()) return self->close();
    self->response_ = {};
    self->read();
  });
}

void WebConnection::linger() {
  if (stream_.tls() == nullptr && lingered_ == 0) {
    Error ignored;
    stream_.next_layer().socket().shutdown(tcp::socket::shutdown_send, ignored);
  }
  if (lingered_ == 0) stream_.next_layer().expires_after(kLingering);
  buffer_.clear();
  stream_.async_read_some(buffer_.prepare(kMaxBuffered), [self = shared_from_this()](Error error, std::size_t bytes) {
    self->lingered_ += bytes;
    if (error || self->lingered_ > kMostLingering) return self->close();
    self->linger();
  });
}

void WebConnection::close() {
  waiting_since_ = Clock::now();  // for the other side to do the same
  if (stream_.tls() != nullptr) {
    stream_.next_layer().expires_after(hub_.options.time_out);
    return stream_.tls()->async_shutdown([self = shared_from_this()](Error /*ignored*/) {});
  }
  Error ignored;
  stream_.next_layer().socket().shutdown(tcp::socket::shutdown_send, ignored);
}

}  // namespace curvecast::server
