// Buffer: a list of fixed capacity in memory that was given to it once. The planner runs beside the realtime threads, in a module that
// may not allocate.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <type_traits>

namespace kerf::motion::path {

/// Where the planner's memory comes from, at load time. nullptr: there is none.
class Memory {
 public:
  [[nodiscard]] virtual void* allocate(std::size_t bytes, std::size_t align) noexcept = 0;

  /// Room for a list that is read beside others. Each begins in another cache line of its page: large blocks come from the system
  /// at the same place in a page, so element i of all of them would share one set of the first cache (eight lines), and a
  /// load would wait for stores to others that only look alike (4 KB aliasing). That made time laws take 1.7 times as long.
  [[nodiscard]] void* allocate_apart(std::size_t bytes, std::size_t align) noexcept {
    const std::size_t ahead = lists_++ * kStep % kPage;
    auto* raw = static_cast<std::byte*>(allocate(bytes + ahead, align));
    return raw == nullptr ? nullptr : raw + ahead;
  }

 protected:
  ~Memory() = default;

 private:
  /// An odd number of cache lines, so that all of a page's have their turn.
  static constexpr std::size_t kPage = 4096, kStep = std::size_t{17} * 64;
  std::size_t lists_{0};
};

/// Elements are plain data. What does not fit is dropped and shows in full(): callers keep below the capacity.
template <class T>
class Buffer {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  Buffer() = default;
  /// False: no memory.
  [[nodiscard]] bool create(Memory& memory, std::size_t capacity) noexcept {
    void* raw = memory.allocate_apart(capacity * sizeof(T), alignof(T));
    static_assert(alignof(T) <= 64);
    if (raw == nullptr) return false;
    data_ = static_cast<T*>(raw);
    for (std::size_t i = 0; i < capacity; ++i) new (data_ + i) T();
    capacity_ = capacity;
    return true;
  }

  [[nodiscard]] T* begin() noexcept { return data_; }
  [[nodiscard]] T* end() noexcept { return data_ + size_; }
  [[nodiscard]] const T* begin() const noexcept { return data_; }
  [[nodiscard]] const T* end() const noexcept { return data_ + size_; }
  [[nodiscard]] T& operator[](std::size_t i) noexcept { return data_[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const noexcept { return data_[i]; }
  [[nodiscard]] T& back() noexcept { return data_[size_ - 1]; }
  [[nodiscard]] const T& back() const noexcept { return data_[size_ - 1]; }
  [[nodiscard]] const T& front() const noexcept { return data_[0]; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::size_t room() const noexcept { return capacity_ - size_; }
  [[nodiscard]] bool empty() const noexcept { return size_ == 0; }
  [[nodiscard]] bool full() const noexcept { return size_ == capacity_; }

  void clear() noexcept { size_ = 0; }
  bool push_back(const T& item) noexcept {
    if (size_ == capacity_) return false;
    data_[size_++] = item;
    return true;
  }
  /// n more, which the caller has filled at end(); no more than there is room for.
  void grow(std::size_t n) noexcept { size_ += n; }
  /// At most the capacity.
  void assign(std::size_t n, const T& item) noexcept {
    size_ = std::min(n, capacity_);
    std::fill(begin(), end(), item);
  }
  void truncate(std::size_t n) noexcept { size_ = std::min(n, size_); }
  void insert(T* at, const T& item) noexcept {
    if (size_ == capacity_) return;
    std::copy_backward(at, end(), end() + 1);
    *at = item;
    ++size_;
  }
  /// Drops the first n.
  void drop_front(std::size_t n) noexcept {
    std::copy(begin() + n, end(), begin());
    size_ -= n;
  }

 private:
  T* data_{nullptr};
  std::size_t size_{0}, capacity_{0};
};

}  // namespace kerf::motion::path
