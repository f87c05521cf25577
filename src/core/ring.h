// A ring buffer that overwrites its oldest items. It has one writer, which never waits, and any
// number of readers, which may be slow or dead.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>

namespace predictor {

// Each slot has a version (a sequence lock) that is odd while the slot is being written. A reader
// that the writer has overtaken skips to the oldest slot still available and counts the lost items.
// The storage contains no pointers, so it may be placed in shared memory. N must be a power of two.
template <class T, std::size_t N>
class RingStorage {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert((N & (N - 1)) == 0 && N > 1);
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;

 public:
  // Publishes an item without waiting. Only one thread may publish.
  void Publish(const T& value) noexcept {
    const std::uint64_t index = written_.load(std::memory_order_relaxed);
    Slot& slot = slots_[index & (N - 1)];
    // A reader that reads a word of the new item also detects that the slot is being written.
    slot.version.store(2 * index + 1, std::memory_order_relaxed);
    std::uint64_t words[kWords] = {};
    std::memcpy(words, &value, sizeof(T));
    for (std::size_t w = 0; w < kWords; ++w)
      slot.words[w].store(words[w], std::memory_order_release);
    slot.version.store(2 * index + 2, std::memory_order_release);
    written_.store(index + 1, std::memory_order_release);
  }

  std::uint64_t written() const noexcept { return written_.load(std::memory_order_acquire); }

  // Copies item `index`. Returns false if the item has not been written yet or has been
  // overwritten.
  bool Get(std::uint64_t index, T* value) const noexcept {
    const Slot& slot = slots_[index & (N - 1)];
    if (slot.version.load(std::memory_order_acquire) != 2 * index + 2) return false;
    std::uint64_t words[kWords];
    for (std::size_t w = 0; w < kWords; ++w)
      words[w] = slot.words[w].load(std::memory_order_acquire);
    if (slot.version.load(std::memory_order_relaxed) != 2 * index + 2) return false;
    std::memcpy(value, words, sizeof(T));
    return true;
  }

 private:
  struct Slot {
    std::atomic<std::uint64_t> version{0};
    std::atomic<std::uint64_t> words[kWords];
  };
  std::atomic<std::uint64_t> written_{0};
  Slot slots_[N];
};

// The position of one reader in a ring.
template <class T, std::size_t N>
class RingReader {
 public:
  explicit RingReader(const RingStorage<T, N>& ring) : ring_(&ring), next_(ring.written()) {}

  // Copies the next item. Returns false if there is no new item.
  bool Next(T* value) noexcept {
    for (;;) {
      const std::uint64_t written = ring_->written();
      if (next_ >= written) return false;
      if (written - next_ > N) {  // overtaken
        lost_ += written - N - next_;
        next_ = written - N;
      }
      if (ring_->Get(next_, value)) {
        ++next_;
        return true;
      }
      ++next_;  // overwritten while it was read
      ++lost_;
    }
  }

  std::uint64_t lost() const { return lost_; }

 private:
  const RingStorage<T, N>* ring_;
  std::uint64_t next_;
  std::uint64_t lost_ = 0;
};

}  // namespace predictor
