// What a server is started with.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/base/log.h"
#include "server/base/web_file.h"

namespace curvecast::server {

struct ServerOptions {
  std::string listen = {};  // "host:port"; port 0 = any free one; empty = this process only
  int threads = 0;          // for preprocessing and views; 0 = one per core that the machine, or its container, has
  std::uint64_t max_upload_bytes = std::uint64_t{8} << 30;  // of one mesh file
  std::uint64_t max_mesh_bytes = std::uint64_t{16} << 30;   // of all mesh files held; the least recently used go first
  std::uint64_t max_sessions = 64;                          // held at once
  std::size_t max_sessions_in_making_of_client = 4;         // at once, of one caller; those in the cache are loaded, not made
  /// Of all of them; the least recently used go first, to the cache. No more than half of the memory.
  std::uint64_t max_session_bytes = std::uint64_t{8} << 30;
  std::string tokens = {};  // file of those who may call, see Tokens; empty = everybody
  /// Networks ("10.0.0.0/8") and addresses of proxies, whose header x-forwarded-for, or of the PROXY protocol, says for whom they
  /// call.
  std::vector<std::string> trusted_proxies = {};
  /// Each holder of a token, or of a certificate's name, finds the meshes and sessions that are his, and no others; those that
  /// the server makes for itself are for all. Wants `tokens` or `tls_client_ca`.
  bool isolate = false;
  std::string mesh_folder = {};  // of which clients may import meshes; empty = none
  /// Of the gRPC port, and no more than half of the descriptors that the process may have. For one more the oldest one gives way
  /// that has made no call.
  std::size_t max_connections = 10'000;
  std::size_t max_streams = 1000;           // of views, at once
  std::size_t max_streams_of_client = 250;  // of one caller
  /// After which a stream ends with UNAVAILABLE, so that its client connects anew, perhaps to another server; a tenth more or
  /// less. 0: never.
  std::chrono::seconds max_stream_age{0};
  std::size_t max_uploads = 64;  // at once
  std::size_t max_uploads_of_client = 8;
  /// Views and acknowledgements a second that are taken from a stream. A client that waits for each frame sends one of each in a
  /// few milliseconds.
  double max_view_rate = 2000;
  /// Of all answers that wait until clients read them; no more than an eighth of the memory.
  std::uint64_t max_queued_bytes = std::uint64_t{1} << 30;
  /// How long a message may take to leave while more than half of that waits; then its call ends.
  std::chrono::milliseconds max_stall = std::chrono::seconds(30);
  /// Limit of refinement, which follows views that ask for more than a session was made for: curve vertices of one session. Also
  /// kept within half of the machine's free memory. 0: no refinement.
  std::uint64_t max_curve_vertices = 20'000'000;
  /// Of this process: beyond, large blocks of memory lie in a file in the cache's folder or, where there is none, the folder for
  /// temporary files, slower but never killed. Jobs that would take more than there is of both wait, or are refused. 0: 70 % of
  /// what the machine or its container has.
  std::uint64_t memory_bytes = 0;
  std::string cache = {};  // folder where sessions survive a restart; made if missing; empty = none
  /// Behind the cache, which it wants: where servers share meshes and sessions, as of open_store(): "file:///DIR" or
  /// "s3://BUCKET/PREFIX". An upload is acknowledged when it is there. Empty = none.
  std::string store = {};
  /// A session whose making ended the process is not made again for so long, by any server of the cache's folder; four times as
  /// long after each further time, up to an hour.
  std::chrono::seconds crash_pause{60};
  std::uint64_t cache_bytes = std::uint64_t{10} << 30;  // of all files there; the least recently used sessions go first
  bool log = true;                                      // one line per state change and error, to standard error
  bool verbose = false;                                 // with log: one line per request too
  LogFormat log_format = LogFormat::kText;
  std::vector<std::string> notes = {};  // lines for the beginning of the log
  /// "host:port" of the HTTP port: the viewer, its WebSocket (web_socket.proto), /healthz, /readyz, /metrics; port 0 = any free
  /// one; empty = none.
  std::string http = {};
  /// "host:port" of the admin port: /healthz, /readyz and /metrics, for all who reach it and never encrypted; empty = none, and
  /// /metrics is on the HTTP port.
  std::string admin = {};
  bool http_may_move = false;                 // to any free port where that one is in use
  std::span<const WebFile> pages = {};        // the viewer's, and whatever else the HTTP port shall serve
  std::vector<std::string> web_origins = {};  // of pages from elsewhere that may connect: "https://example.org"; "*": all
  bool ready = true;                          // else not before set_ready()
  /// PEM files with which connections over TCP are encrypted, of both ports: the server's certificate with those that vouch for
  /// it, and its key. Without: no encryption.
  std::string tls_cert = {}, tls_key = {};
  std::string tls_client_ca =
      {};  // PEM: only clients for whose certificates these vouch may call, and by these they are known; empty: all
};

}  // namespace curvecast::server
