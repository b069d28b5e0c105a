#include "core/base/mapped_file.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/mutex.h"

namespace curvecast {

/// A mapping, as the handler sees it: whole pages from `begin` on. `begin` is 0 while there is none, and is written last.
struct MappedFile::Place {
  std::atomic<std::uintptr_t> begin = 0, end = 0;
  std::atomic<bool> is_lost = false;
};

/// All places. Never freed, and only ever added to: the handler may look at any moment, without a lock.
struct MappedPlaces {
  using Place = MappedFile::Place;

  std::array<Place, 256> places;
  std::atomic<MappedPlaces*> next = nullptr;
};

namespace {

using Place = MappedPlaces::Place;

static_assert(std::atomic<std::uintptr_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

constinit MappedPlaces all_places;
std::uintptr_t page_size;         // written once, before the handler is there
struct sigaction handler_before;  // as well

/// For the handler: only what may be called there.
bool replace_by_zeros(std::uintptr_t address) {
  for (MappedPlaces* some = &all_places; some != nullptr; some = some->next.load(std::memory_order_acquire)) {
    for (Place& place : some->places) {
      const std::uintptr_t begin = place.begin.load(std::memory_order_acquire);
      const std::uintptr_t end = place.end.load(std::memory_order_acquire);
      if (begin == 0 || address < begin || address >= end) continue;
      if (place.begin.load(std::memory_order_acquire) != begin) continue;  // it has become another's meanwhile
      place.is_lost.store(true, std::memory_order_release);
      // To the end, not page by page: there may be millions, and a process may have only so many mappings.
      const std::uintptr_t page = address - address % page_size;
      return ::mmap(reinterpret_cast<void*>(page), end - page, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED | MAP_NORESERVE,
                    -1, 0) != MAP_FAILED;
    }
  }
  return false;
}

/// What would have happened without us.
void pass_on(int signal, siginfo_t* info, void* context) {
  const bool is_sent = info->si_code <= 0;  // by a program, not by the system
  if ((handler_before.sa_flags & SA_SIGINFO) != 0) return handler_before.sa_sigaction(signal, info, context);
  if (handler_before.sa_handler == SIG_IGN && is_sent) return;
  if (handler_before.sa_handler != SIG_IGN && handler_before.sa_handler != SIG_DFL) return handler_before.sa_handler(signal);
  struct sigaction standard = {};
  standard.sa_handler = SIG_DFL;
  ::sigaction(signal, &standard, nullptr);
  if (is_sent) ::raise(signal);  // else the same instruction fails once more
}

void on_bus_error(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  if (info->si_code <= 0 || !replace_by_zeros(reinterpret_cast<std::uintptr_t>(info->si_addr))) pass_on(signal, info, context);
  errno = error;
}

void install_handler() {
  page_size = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  ::sigaction(SIGBUS, nullptr, &handler_before);
  struct sigaction ours = {};
  ours.sa_sigaction = on_bus_error;
  ours.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  ::sigemptyset(&ours.sa_mask);
  ::sigaction(SIGBUS, &ours, nullptr);
}

/// Places that no mapping has.
class FreePlaces {
 public:
  Place* take() {
    const MutexLock lock(mutex_);
    if (free_.empty()) {
      MappedPlaces* const more = is_begun_ ? new MappedPlaces : &all_places;
      for (Place& place : more->places) free_.push_back(&place);
      if (is_begun_) last_->next.store(more, std::memory_order_release);
      is_begun_ = true;
      last_ = more;
    }
    Place* const place = free_.back();
    free_.pop_back();
    return place;
  }
  void give_back(Place* place) {
    const MutexLock lock(mutex_);
    free_.push_back(place);
  }

 private:
  Mutex mutex_;
  std::vector<Place*> free_ ABSL_GUARDED_BY(mutex_);
  MappedPlaces* last_ ABSL_GUARDED_BY(mutex_) = nullptr;
  bool is_begun_ ABSL_GUARDED_BY(mutex_) = false;
};

/// Outlives every mapping, those of other static objects too.
FreePlaces& free_places() {
  static FreePlaces* const places = new FreePlaces;
  return *places;
}

}  // namespace

absl::StatusOr<MappedFile> MappedFile::map(int descriptor, std::size_t size) {
  static std::once_flag once;
  std::call_once(once, install_handler);
  Place* const place = free_places().take();
  void* const data = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
  if (data == MAP_FAILED) {
    const int error = errno;
    free_places().give_back(place);
    return absl::ErrnoToStatus(error, "cannot map");
  }
  const auto begin = reinterpret_cast<std::uintptr_t>(data);
  place->is_lost.store(false, std::memory_order_relaxed);
  place->end.store(begin + (size + page_size - 1) / page_size * page_size, std::memory_order_release);
  place->begin.store(begin, std::memory_order_release);
  MappedFile file;
  file.data_ = static_cast<const std::byte*>(data);
  file.size_ = size;
  file.place_ = place;
  return file;
}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  std::swap(place_, other.place_);
  return *this;
}

MappedFile::~MappedFile() {
  if (place_ == nullptr) return;
  place_->begin.store(0, std::memory_order_release);  // first: the addresses may be another mapping's at once
  ::munmap(const_cast<std::byte*>(data_), size_);
  free_places().give_back(place_);
}

bool MappedFile::is_lost() const { return place_ != nullptr && place_->is_lost.load(std::memory_order_acquire); }

void MappedFile::release_pages() const {
  if (place_ != nullptr) ::madvise(const_cast<std::byte*>(data_), size_, MADV_DONTNEED);
}

}  // namespace curvecast
