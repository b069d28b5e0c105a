// What `sample` does to one mesh and `batch` to each of many: the flags, the points, their file.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "client/cli/common.h"
#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "client/lib/client.h"
#include "client/lib/drc_file.h"

namespace curvecast::cli {

struct SamplingFlags {
  SampleFlags sample;
  SessionFlags session;
  std::uint64_t max_points = 0;  // N that the session is made for; 0: as many as are wanted, see session_points()
  std::vector<std::string> attributes;
  std::optional<int> position_bits;
  client::DrcOptions drc;  // all but position_bits
  bool splats = false;
  std::string glb = "quantised";
  bool first_answer = false;
};

/// Adds all of them but max_points; values are checked while parsing.
void add_sampling_flags(CLI::App* command, SamplingFlags* flags);

/// What a server is asked for.
struct SamplingRequests {
  v1::SessionOptions session;  // of which, where there is none, only the angle of creases counts
  v1::SampleRequest sample;    // all but cameras and viewport
  bool scatters = false;       // without a session
};

/// Returns the requests that the flags, which have been checked, stand for, for points that go to `output`, a file's name or only
/// its ending; empty: to no file. InvalidArgument: splats for a file that cannot hold them, or flags that exclude each other.
absl::StatusOr<SamplingRequests> make_sampling_requests(const SamplingFlags& flags, std::uint64_t seed,
                                                        const std::string& output);

/// Returns the points that a ready session gives: where its curve is too coarse for them those of a finer one, for which it
/// waits, `patience` at most, unless the flags want the first answer.
absl::StatusOr<client::DecodedSample> sample_session(client::Client& client, const v1::Session& session,
                                                     const SamplingFlags& flags, v1::SampleRequest request,
                                                     std::chrono::milliseconds patience, const std::stop_token& stop);

struct SampledMesh {
  OpenedMesh opened;  // its session has nothing but the mesh where points are scattered
  client::DecodedSample sample;
};

/// Uploads a mesh with what it refers to and takes points that are scattered on it. Precondition: requests.scatters.
absl::StatusOr<SampledMesh> scatter_on(client::Client& client, const std::string& mesh, const SamplingRequests& requests,
                                       const SamplingFlags& flags, const client::StageProgress& on_progress,
                                       const std::stop_token& stop);

/// Opens a mesh and samples it, or scatters points on it, and shows progress unless `quiet`; waits some minutes for a finer
/// curve.
absl::StatusOr<SampledMesh> open_and_sample(client::Client& client, const std::string& mesh, const SamplingRequests& requests,
                                            const SamplingFlags& flags, bool quiet, const std::stop_token& stop);

/// Writes the points as save_points() does, as the flags say.
absl::Status save_sample(const std::string& path, const client::Points& points, const SamplingFlags& flags);

}  // namespace curvecast::cli
