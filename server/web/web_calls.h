// The calls that share a WebSocket.
#pragma once

#include <memory>

#include "server/engine/engine.h"
#include "server/web/web_socket.h"

namespace grpc {
class Channel;
}

namespace curvecast::server {

/// Returns the function that begins a conversation on each socket that is opened, see web_socket.proto, and closes sockets of
/// callers that are not known. `channel` leads to this process, and sends Engine::own_key. `engine` must outlive all
/// conversations.
WebConversationMaker web_calls(Engine& engine, std::shared_ptr<grpc::Channel> channel);

}  // namespace curvecast::server
