// Memory that a run shares with the processes alongside it. All these processes read one piece of
// memory. Each process that may send something has its own piece.
#pragma once

#include <cstdint>
#include <memory>

#include "core/head_record.h"
#include "core/person_state.h"
#include "core/record.h"
#include "core/ring.h"
#include "core/run_input.h"
#include "core/stream_sample.h"

namespace predictor {

inline constexpr std::size_t kRecordRing = 8192;  // about eight seconds
using RecordRing = RingStorage<TickRecord, kRecordRing>;

// The run writes the board, and every process reads the board. The other processes map the board
// read-only.
struct RunBoard {
  static constexpr std::uint64_t kMagic = 0x3352'4f54'4349'4450;  // identifies this layout
  std::uint64_t magic = kMagic;
  std::uint64_t bytes = sizeof(RunBoard);
  std::atomic<std::uint32_t> recording{0};  // 1: the published records are being recorded
  RecordRing records;
};

inline constexpr std::size_t kHeadRing = 256;  // at least four seconds
using HeadRing = RingStorage<HeadRecord, kHeadRing>;

// The viewer's process writes the mailbox. The run validates everything that it reads from the
// mailbox.
struct RunMailbox {
  InputQueue inputs;
  // Counts stop requests. This counter is separate from the queue, so a stop never waits behind
  // other inputs.
  std::atomic<std::uint32_t> stops{0};
  // Client that sent the last stop request, or 0 if the request did not come from a client of the
  // viewer.
  std::atomic<std::uint32_t> stop_client{0};
  // Inputs of the viewer's clients.
  std::atomic<std::uint32_t> clients{0};
  std::atomic<std::uint32_t> immersive{0};           // headsets in an immersive session
  std::atomic<std::uint64_t> immersive_frame_ns{0};  // monotonic clock at the headsets' last report
  // Measured heads of the person. The tick does not read them. The recorder and the evaluator do,
  // and do not trust their content.
  HeadRing heads;
};

// The ROS-TCP server's process writes this mailbox, and the run reads it. The server's clients may
// only request a stop.
struct StopMailbox {
  std::atomic<std::uint32_t> stops{0};  // counts stop requests
};

// The watchdog's process writes this mailbox, and the run reads it.
struct WatchdogMailbox {
  std::atomic<std::uint32_t> beats{0};  // counts its signs of life, 1000 per second
};

inline constexpr std::size_t kPersonRing = 256;  // two and a half seconds

// The evaluator's process writes this board. The run's recorder and the viewer read this board and
// do not trust its content.
struct EvaluationBoard {
  RingStorage<PersonState, kPersonRing> states;
};

// The process that receives the streams of other systems writes this board. The run's recorder and
// the evaluator read it and do not trust its content.
struct StreamBoard {
  StreamRing samples;
};

// A piece of shared memory that contains one object of type T. The memory has no name. Processes
// pass its descriptor to one another.
template <class T>
class Shared {
 public:
  // Creates the memory. Throws std::runtime_error.
  Shared();
  // Maps the memory of another process. The mapping is read-only unless `writable` is true. Throws
  // std::runtime_error if the descriptor is invalid or if the memory is smaller than a T.
  Shared(int descriptor, bool writable);
  ~Shared();
  Shared(const Shared&) = delete;
  Shared& operator=(const Shared&) = delete;
  T* operator->() { return memory_; }
  T& operator*() { return *memory_; }
  const T& operator*() const { return *memory_; }
  int descriptor() const { return descriptor_; }
  // Returns a descriptor that cannot map the memory for writing. Throws std::runtime_error.
  int read_only_descriptor() const;

 private:
  int descriptor_ = -1;
  mutable int read_only_ = -1;  // opened when it is first requested
  T* memory_ = nullptr;
};
extern template class Shared<RunBoard>;
extern template class Shared<RunMailbox>;
extern template class Shared<StopMailbox>;
extern template class Shared<WatchdogMailbox>;
extern template class Shared<EvaluationBoard>;
extern template class Shared<StreamBoard>;

}  // namespace predictor
