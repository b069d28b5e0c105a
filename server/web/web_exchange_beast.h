// Requests for resources on a connection of the HTTP port.
#pragma once

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <functional>
#include <memory>

#include "server/web/web_exchange.h"

namespace curvecast::server {

class WebConnection;

/// Passes everything on to the connection, on the gateway's thread, as long as that waits for this exchange's answer.
class BeastExchange final : public WebExchange {
 public:
  BeastExchange(std::shared_ptr<boost::asio::io_context> io, std::weak_ptr<WebConnection> connection, std::uint64_t number,
                WebRequest request);
  ~BeastExchange() override;

  void read_body(Take take) override;
  void answer(WebAnswer answer) override;
  void on_gone(std::function<void()> gone) override;

 private:
  const std::shared_ptr<boost::asio::io_context> io_;
  const std::weak_ptr<WebConnection> connection_;
  const std::uint64_t number_;  // of the question on its connection
  std::atomic<bool> answered_ = false;
};

/// Whether the other end of a connection has closed it, or its half of it. Reads nothing.
bool has_gone(int socket);

}  // namespace curvecast::server
