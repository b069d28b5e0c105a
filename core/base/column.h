// A column of values: a value type like std::vector, but its entries start out uninitialised (so that the threads that fill it
// are the first to touch its pages), and it can look into a mapped file instead of owning memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace curvecast {

/// Uninitialised memory, aligned to a cache line at least; null for no bytes. Much of it comes in large pages where the system
/// has any: columns are touched from end to end, and small pages would cost more than filling them.
std::shared_ptr<const void> allocate_pages(std::size_t bytes);

template <typename T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;  // NOLINT(readability-identifier-naming): as containers have it

  Column() = default;
  Column(std::initializer_list<T> values) : Column(std::span<const T>(values.begin(), values.size())) {}
  explicit Column(std::span<const T> values) {
    resize(values.size());
    std::copy(values.begin(), values.end(), data_);
  }
  Column(const Column& other) : Column(std::span<const T>(other)) {}
  Column(Column&& other) noexcept { swap(other); }
  Column& operator=(Column other) noexcept {
    swap(other);
    return *this;
  }

  /// Returns a column that reads `values` where they lie, in something that `keeper` keeps alive. Only for const use: writing to
  /// it, even by mistake, ends the process where the pages are read-only. A copy owns its memory.
  // NOLINTNEXTLINE(performance-unnecessary-value-param): it is moved from
  static Column view(std::span<const T> values, std::shared_ptr<const void> keeper) {
    Column column;
    column.data_ = const_cast<T*>(values.data());
    column.size_ = values.size();
    column.memory_ = std::move(keeper);
    return column;
  }

  /// n uninitialised entries; what it held before is lost.
  void resize(std::size_t n) {
    memory_ = allocate_pages(n * sizeof(T));
    data_ = static_cast<T*>(const_cast<void*>(memory_.get()));
    size_ = n;
  }
  /// n times the value, which may be one of its own entries.
  void assign(std::size_t n, const T& value) {
    const T filler = value;
    resize(n);
    std::fill_n(data_, n, filler);
  }
  void swap(Column& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    memory_.swap(other.memory_);
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  const T& front() const { return data_[0]; }
  const T& back() const { return data_[size_ - 1]; }

  friend bool operator==(const Column& a, const Column& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end()); }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::shared_ptr<const void> memory_;  // owns the entries, or keeps alive what does
};

}  // namespace curvecast
