// One set of tiles on its way from the session to the files.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/memory_budget.h"
#include "server/frame/tileset_cache.h"
#include "server/web/resources/point_file.h"
#include "server/web/resources/resource.h"
#include "server/web/resources/tileset_terms.h"

namespace curvecast::server {

/// Its calls are those of the client who asked first, and go on without him. Its steps follow each other; cancel() is
/// thread-safe.
class TilesetMaking : public std::enable_shared_from_this<TilesetMaking> {
 public:
  using Done =
      std::function<void(const TilesetMaking& self, const grpc::Status& status, const std::shared_ptr<const Tileset>& set)>;

  /// `first` is kept: a request is under way as long as this is.
  TilesetMaking(std::shared_ptr<WebResource> first, const std::shared_ptr<grpc::Channel>& channel, std::string session_id,
                TilesetTerms terms, std::string text, Done done);

  /// Calls `done` in the end, once.
  void start() { look(Step::kSample); }
  void cancel() { calls_.end(); }

 private:
  enum class Step { kAwait, kSample, kCheck };

  /// Asks how the session is, for the sake of a step.
  void look(Step step);
  void go_on(Step step, const v1::Session& session);
  /// Looks again in a while.
  void await();
  void sample(std::uint64_t revision);
  absl::Status take(const v1::ResampleResponse& response);
  void sampled();
  /// Has a worker make the tiles.
  void submit();
  absl::StatusOr<std::shared_ptr<const Tileset>> make_tiles();
  void fail(const absl::Status& status);
  void finish(const grpc::Status& status, const std::shared_ptr<const Tileset>& set);

  const std::shared_ptr<WebResource> first_;
  ApiCalls calls_;
  const std::string session_id_;
  const TilesetTerms terms_;
  const std::string text_;
  Done done_;
  const std::chrono::steady_clock::time_point deadline_;  // for the curve to be refined
  int rounds_ = 0;                                        // of samples
  std::uint64_t revision_ = 0;                            // of the curve, before the points were taken
  v1::ResampleRequest request_;
  std::optional<MemoryBudget::Job> memory_;
  GatheredPoints points_;
  v1::FrameStatistics statistics_;
};

}  // namespace curvecast::server
