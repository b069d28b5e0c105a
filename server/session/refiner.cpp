#include "server/session/refiner.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <optional>
#include <utility>

#include "core/base/stopwatch.h"
#include "server/base/guarded.h"

namespace curvecast::server {
namespace {

// Demands of others that are met together; the oldest gives way. Each costs a pass over the curve.
constexpr std::size_t kMaxDemands = 8;
// Sessions whose turn has not come. More are refused: they are asked for again with the next view.
constexpr std::size_t kMaxPending = 1024;

/// Memory that the machine could give without swapping, bytes; 0 where it does not say.
std::uint64_t available_memory() {
  std::ifstream file("/proc/meminfo");
  std::string name, unit;
  std::uint64_t kib = 0;
  while (file >> name >> kib >> unit) {
    if (name == "MemAvailable:") return kib * 1024;
  }
  return 0;
}

bool is_uniform(const std::vector<DensityTerm>& density) {
  return std::all_of(density.begin(), density.end(),
                     [](const DensityTerm& term) { return std::holds_alternative<UniformTerm>(term); });
}

}  // namespace

struct Refinement {
  struct Source {
    std::uint64_t id;
    CurveDemand demand;
  };
  /// What a refinement needs of a surface and the next one needs again.
  struct Surface {
    explicit Surface(std::shared_ptr<const FlattenedMesh> mesh) : flattened(std::move(mesh)) {
      const LoadedMesh& loaded = flattened->loaded;
      if (has_colour(loaded.attributes)) colour.emplace(loaded.mesh, loaded.attributes);
      base.emplace(SurfaceData{loaded.mesh, flattened->geometry, loaded.attributes, colour ? &*colour : nullptr},
                   flattened->charts);
    }
    Surface(const Surface&) = delete;

    std::shared_ptr<const FlattenedMesh> flattened;
    std::optional<SurfaceColour> colour;
    std::optional<CurveBase> base;
  };

  std::unique_ptr<Surface> surface;  // of the thread that refines
  std::atomic<bool> cancel = false;
  // What follows is guarded by the refiner's lock.
  std::shared_ptr<const Session> held;  // a copy, so that the session may be evicted, while something runs or waits
  std::vector<Source> waiting;          // oldest first
  bool at_limit = false;                // no finer curve will be made
};

Refiner::Refiner(std::uint64_t max_vertices, OnDone on_done, std::shared_ptr<spdlog::logger> log)
    : max_vertices_(max_vertices),
      on_done_(std::move(on_done)),
      log_(std::move(log)),
      queue_({.max_waiting = kMaxPending, .low_priority = true}) {}

Refiner::~Refiner() { stop(); }

bool Refiner::request(const std::shared_ptr<const Session>& session, const SurfaceCurve& curve, std::uint64_t source,
                      CurveDemand demand) {
  const std::lock_guard lock(mutex_);
  if (stopped_ || max_vertices_ == 0) return false;
  // It missed a finer revision, and will see then whether that is enough.
  if (session->curve()->revision > curve.revision) return true;
  std::shared_ptr<Refinement>& task = session->live->refinement;
  if (task == nullptr) task = std::make_shared<Refinement>();
  if (task->at_limit) return false;
  if (task->held == nullptr) {
    if (!queue_.submit([this, task] { run(task); }).ok()) return false;
    task->held = std::make_shared<const Session>(*session);
    session->live->set_refining(true);
  }
  std::erase_if(task->waiting, [source](const Refinement::Source& other) { return other.id == source; });
  if (task->waiting.size() == kMaxDemands) task->waiting.erase(task->waiting.begin());
  task->waiting.push_back({source, std::move(demand)});
  return true;
}

void Refiner::forget(const Session& session) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Refinement>& task = session.live->refinement;
  if (task == nullptr) task = std::make_shared<Refinement>();
  task->at_limit = true;
  task->cancel = true;
}

void Refiner::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    if (running_ != nullptr) running_->cancel = true;
  }
  queue_.stop();
}

void Refiner::run(const std::shared_ptr<Refinement>& task) {
  bool is_last = false;
  while (!is_last) {
    std::vector<CurveDemand> demands;
    std::shared_ptr<const Session> session;
    {
      const std::lock_guard lock(mutex_);
      running_ = task;
      if (stopped_) task->cancel = true;
      session = task->held;
      for (Refinement::Source& source : std::exchange(task->waiting, {})) demands.push_back(std::move(source.demand));
    }
    Stopwatch watch;
    const absl::StatusOr<RefinedCurve> refined = guarded([&] { return refine_once(*task, *session, demands); });
    const bool is_finer = refined.ok() && refined->curve != nullptr;
    if (is_finer) {
      session->live->publish(refined->curve);
      log_->info("session {} refined in {:.3f} s: revision {}, {} curve vertices, {} MiB", session->id, watch.lap(),
                 refined->curve->revision, refined->curve->size(), refined->curve->byte_size() >> 20);
    } else if (!refined.ok() && !task->cancel) {
      log_->error("session {} was not refined: {}", session->id, refined.status().ToString());
    }
    {
      const std::lock_guard lock(mutex_);
      running_ = nullptr;
      if (!refined.ok() || refined->divisor > 1) task->at_limit = true;
      is_last = task->waiting.empty() || task->at_limit;
      if (is_last) {
        task->waiting.clear();
        task->held = nullptr;
        session->live->set_refining(false);
      }
    }
    on_done_(*session, is_finer);
  }
}

absl::StatusOr<RefinedCurve> Refiner::refine_once(Refinement& task, const Session& session,
                                                  const std::vector<CurveDemand>& demands) const {
  if (task.cancel) return absl::CancelledError("cancelled");
  if (task.surface == nullptr) {
    std::shared_ptr<const FlattenedMesh> flattened = session.preprocessed.flattened;
    if (flattened == nullptr) {
      if (!session.load_flattened) return absl::UnavailableError("its surface is not at hand");
      auto loaded = session.load_flattened();
      if (!loaded.ok()) return loaded.status();
      flattened = *std::move(loaded);
    }
    task.surface = std::make_unique<Refinement::Surface>(std::move(flattened));
  }
  const std::shared_ptr<const SurfaceCurve> curve = session.curve();
  RefineOptions options{.omega = session.options.omega, .max_vertices = affordable_vertices(*curve)};
  for (const CurveDemand& demand : demands) {
    if (is_uniform(session.options.density) && is_uniform(demand.density.terms)) {
      options.max_points = std::max(options.max_points, demand.points);
    }
  }
  // One thread, this one: any other of the pool would run at the priority of views.
  return refine(*task.surface->base, *curve, demands, options, {.cancel = &task.cancel, .threads = 1});
}

std::uint64_t Refiner::affordable_vertices(const SurfaceCurve& curve) const {
  const std::uint64_t available = available_memory();
  if (available == 0 || curve.size() == 0) return max_vertices_;
  const std::uint64_t bytes = curve.byte_size() / curve.size() + 1;
  return std::min(max_vertices_, available / 2 / bytes);
}

}  // namespace curvecast::server
