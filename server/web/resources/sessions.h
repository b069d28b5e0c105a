// Sessions as resources.
#pragma once

#include <memory>
#include <string>

#include "server/web/resources/resource.h"

namespace curvecast::server {

/// POST: makes a session, as CreateSession; the body is a CreateSessionRequest. Answers when it is ready.
void create_session(const std::shared_ptr<WebResource>& resource);
/// GET: a page of them, as ListSessions.
void list_sessions(const std::shared_ptr<WebResource>& resource);
/// GET: one, as GetSession.
void get_session(const std::shared_ptr<WebResource>& resource, const std::string& id);
/// DELETE: as CloseSession.
void close_session(const std::shared_ptr<WebResource>& resource, const std::string& id);

}  // namespace curvecast::server
