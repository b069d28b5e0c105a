// What answers with a file have in common.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "curvecast/v1/curvecast.pb.h"
#include "server/engine/engine.h"
#include "server/web/web_exchange.h"

namespace curvecast::server {

/// Only for who asked, and never without asking again: the curve may have become finer.
inline constexpr char kAskAgain[] = "private, no-cache";

/// A name for what this request gets of the session as it is now: the same request to the same revision of its curve gets the
/// same bytes from the same version of the server.
std::string etag_of(const v1::Session& session, const WebRequest& request);
/// The same of a mesh, which never changes: of its file's id.
std::string etag_of(const std::string& mesh_id, const WebRequest& request);
/// Whether the client has that already.
bool matches(const WebRequest& request, const std::string& tag);
WebAnswer not_modified(const std::string& tag, const std::string& cache_control = kAskAgain);
/// `tag`: empty where the same request may get something better later.
WebAnswer file_answer(std::string bytes, std::string type, const std::string& tag);
/// The value of Content-Disposition: a name from that of the mesh.
std::string file_name_field(const v1::MeshInfo& mesh, const std::string& ending);
/// Counts bytes of an answer as ones that wait for their client, as long as what is returned is kept.
std::shared_ptr<void> hold_queued(Engine& engine, const Caller& caller, std::size_t bytes);

}  // namespace curvecast::server
