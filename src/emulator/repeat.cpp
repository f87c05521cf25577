#include "emulator/repeat.h"

#include <array>
#include <bit>
#include <cstddef>

namespace predictor {

void Repeat(const TickRecord& record, Emulator* emulator) noexcept {
  for (std::size_t i = 0; i < record.input_count && i < record.inputs.size(); ++i)
    emulator->Submit(record.inputs[i]);
  for (int event = 0; event < kRunEvents; ++event)
    if ((record.requests >> event & 1U) != 0) emulator->Request(static_cast<RunEvent>(event));
  if ((record.requests & kEndRequest) != 0) emulator->RequestEnd();
  emulator->Tick(record.wall_ns, static_cast<int>(record.missed));
}

bool SameTick(const TickRecord& a, const TickRecord& b) noexcept {
  TickRecord timeless = a;
  timeless.wall_ns = b.wall_ns;
  timeless.stage_us = b.stage_us;
  using Bytes = std::array<std::byte, sizeof(TickRecord)>;
  return std::bit_cast<Bytes>(timeless) == std::bit_cast<Bytes>(b);
}

}  // namespace predictor
