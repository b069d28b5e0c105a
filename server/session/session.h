// A session: a mesh's curve, ready to be sampled.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/pipeline/pipeline.h"
#include "server/session/live_curve.h"
#include "server/session/live_ranks.h"
#include "server/session/mesh_files.h"
#include "server/session/refinement.h"

namespace curvecast::server {

/// Grows whenever preprocessing gives other bytes than before for the same files and options: sessions of other versions are
/// others.
inline constexpr int kAlgorithmVersion = 2;

/// Ready and immutable but for its curve, which may become finer, and its ranked candidates; whoever holds it may go on using it
/// after it has been closed.
struct Session {
  std::string id;
  std::string mesh_id;
  std::string mesh_name;
  std::map<std::string, std::string> companions;  // names in the mesh, and the mesh_ids of these files
  PreprocessOptions options;
  Preprocessed preprocessed;  // its curve has gone to `live`; without `flattened` when it comes from the cache
  std::shared_ptr<LiveCurve> live = std::make_shared<LiveCurve>();
  std::shared_ptr<LiveRanks> ranks = std::make_shared<LiveRanks>();  // made when they are first asked for
  std::shared_ptr<Refinement> refinement = std::make_shared<Refinement>();
  /// Where preprocessed.flattened is null: brings what the curve lies on, when it is to be refined. May be empty, or fail.
  std::function<absl::StatusOr<std::shared_ptr<const FlattenedMesh>>()> load_flattened;
  std::uint64_t peak_bytes = 0;  // the process's peak memory when the session became ready

  /// The newest revision. One answer takes it once.
  std::shared_ptr<const SurfaceCurve> curve() const { return live->newest(); }
  /// Of its curve and its ranked candidates.
  std::uint64_t memory_bytes() const { return curve()->byte_size() + ranks->byte_size(); }
};

enum class SessionState { kQueued, kPreprocessing, kReady };

struct SessionInfo {
  std::string id;
  std::string mesh_id;
  PreprocessOptions options;
  SessionState state = SessionState::kQueued;
  std::shared_ptr<const Session> session;  // set when ready
  bool pinned = false;                     // is never evicted
  double time_to_live = 0;                 // above 0: is closed when nobody has used it for so many seconds
};

/// The same for the same files, under the same names, all options and the same version of the algorithm: 32 hexadecimal digits.
std::string session_id(const MeshFiles& files, const PreprocessOptions& options);

/// The process's peak memory so far, bytes.
std::uint64_t peak_memory_bytes();

}  // namespace curvecast::server
