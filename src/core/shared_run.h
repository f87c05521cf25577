// What a run shares with the processes beside it, in pieces of shared memory: one that all read,
// and one for each that may say something.
#pragma once

#include <cstdint>
#include <memory>

#include "core/record.h"
#include "core/ring.h"
#include "core/run_input.h"

namespace predictor {

inline constexpr std::size_t kRecordRing = 8192;  // about eight seconds
using RecordRing = RingStorage<TickRecord, kRecordRing>;

// Written by the run, read by everyone: the other side maps it for reading only.
struct RunBoard {
  static constexpr std::uint64_t kMagic = 0x3352'4f54'4349'4450;  // of this layout
  std::uint64_t magic = kMagic;
  std::uint64_t bytes = sizeof(RunBoard);
  std::atomic<std::uint32_t> recording{0};  // 1: what is published is being recorded
  RecordRing records;
};

// Written by the viewer's process, read by the run, which believes nothing in it unchecked.
struct RunMailbox {
  InputQueue inputs;
  // Counts requests to stop. Apart from the queue, so that a stop never waits behind anything.
  std::atomic<std::uint32_t> stops{0};
  std::atomic<std::uint32_t> stop_client{0};  // who asked last; 0: none of the viewer's clients
  // Of the viewer's clients.
  std::atomic<std::uint32_t> clients{0};
  std::atomic<std::uint32_t> immersive{0};           // headsets in an immersive session
  std::atomic<std::uint64_t> immersive_frame_ns{0};  // monotonic clock of their last sign of life
};

// Written by the ROS-TCP server's process, read by the run: whoever is there may stop, and nothing
// else.
struct StopMailbox {
  std::atomic<std::uint32_t> stops{0};  // counts requests
};

// A piece of shared memory that holds one T and has no name: it is passed on by its descriptor.
template <class T>
class Shared {
 public:
  // Makes one. Throws std::runtime_error.
  Shared();
  // Maps that of another process; `writable`: else for reading. Throws std::runtime_error if the
  // descriptor is none or the memory too small for a T.
  Shared(int descriptor, bool writable);
  ~Shared();
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  T* operator->() { return memory_; }
  T& operator*() { return *memory_; }
  const T& operator*() const { return *memory_; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_ = -1;
  T* memory_ = nullptr;
};
extern template class Shared<RunBoard>;
extern template class Shared<RunMailbox>;
extern template class Shared<StopMailbox>;

}  // namespace predictor
