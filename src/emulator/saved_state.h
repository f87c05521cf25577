// The saved state of an emulator, which contains everything on which a later tick depends.
#pragma once

#include <cstdint>

#include "core/archive.h"

namespace predictor {

class Device;
class Pipeline;
class Supervisor;
struct TickData;

struct SavedState {
  Pipeline& pipeline;
  Supervisor& supervisor;
  TickData& data;
  Device* device;  // may be null; null in direct mode
  std::uint64_t& tick;
};

// Saves or loads the parts of the state in the order in which they are stored. Does not use the
// heap or throw.
void ArchiveState(StateArchive& a, const SavedState& state) noexcept;

}  // namespace predictor
