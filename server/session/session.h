// A session: a mesh's curve, ready to be sampled.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/pipeline/pipeline.h"
#include "core/storage/section_file.h"
#include "server/session/curve_revisions.h"
#include "server/session/mesh_files.h"
#include "server/session/ranked_candidates.h"
#include "server/session/refinement.h"
#include "server/session/session_surface.h"

namespace curvecast::server {

/// Immutable but for its curve, which may become finer, and its ranked candidates. Can be used for as long as it is held, also
/// after it has been closed. Copies share what changes.
struct Session {
  std::string id;
  std::string mesh_id;
  std::string mesh_name;
  std::string owner;                              // who had it made first; empty: nobody in particular
  std::map<std::string, std::string> companions;  // names in the mesh, and the mesh_ids of these files
  PreprocessOptions options;
  Preprocessed preprocessed;  // its curve has gone to `revisions`, its mesh to `surface`
  std::shared_ptr<CurveRevisions> revisions = std::make_shared<CurveRevisions>();
  std::shared_ptr<RankedCandidates> candidates = std::make_shared<RankedCandidates>();  // made when they are first asked for
  std::shared_ptr<Refinement> refinement = std::make_shared<Refinement>();
  std::shared_ptr<SessionSurface> surface = std::make_shared<SessionSurface>();
  std::vector<std::shared_ptr<const SectionFile>> files = {};  // in which revisions of its curve lie
  bool is_preview = false;                                     // a coarse stand-in, until the session is ready
  std::uint64_t peak_bytes = 0;                                // the process's peak memory when the session became ready

  /// The newest revision of the curve. Each answer takes it once, so that all of it is of one revision.
  std::shared_ptr<const SurfaceCurve> curve() const { return revisions->newest(); }
  /// The surface in the form that refinement wants. Errors as of SessionSurface::base().
  absl::StatusOr<std::shared_ptr<const CurveBase>> curve_base() const;
  /// The surface below the leaves of a revision. Errors as of curve_base().
  absl::StatusOr<std::shared_ptr<const LeafSurface>> leaf_surface(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                  const ExecutionContext& context = {}) const;
  /// The ranked candidates that there are by now, on the first revision of the curve; at least those of the lowest ranks. Errors
  /// as of curve_base() and RankGrower::make().
  absl::StatusOr<RankedCurve> ranks(const ExecutionContext& context) const;
  /// OK, or DataLoss where some of the files is gone in which curve and surface lie, or damaged: to be asked before what came of
  /// them is used. Takes microseconds.
  absl::Status status() const;
  /// Bytes of the curve's revisions, the ranked candidates, and the surface where it is in memory.
  std::uint64_t memory_bytes() const;
};

enum class SessionState { kQueued, kPreprocessing, kReady };

struct SessionInfo {
  std::string id;
  std::string mesh_id;
  PreprocessOptions options;
  SessionState state = SessionState::kQueued;
  std::shared_ptr<const Session> session;  // set when ready
  bool pinned = false;                     // is never evicted
  double time_to_live = 0;                 // above 0: it is closed when it has not been used for so many seconds
};

/// The id of a session, 32 hexadecimal digits: the first 16 of its mesh's id, so that whoever has either knows where both are,
/// and 16 of a hash of the files and those who may find them, the names of the companions, all options and kAlgorithmVersion.
std::string session_id(const MeshFiles& files, const PreprocessOptions& options);

/// The process's peak memory so far, bytes.
std::uint64_t peak_memory_bytes();

}  // namespace curvecast::server
