// A run once more, from what its records say was put into it.
#pragma once

#include <string>

#include "core/record.h"
#include "devices/device.h"
#include "emulator/emulator.h"

namespace predictor {

// In the place of real arms: what they and their sensors gave in a tick, out of its record.
class RecordedDevice final : public Device {
 public:
  // The tick that comes next; borrowed until it is over.
  void Expect(const TickRecord* record) noexcept { record_ = record; }

  Status Read(DeviceSample* sample) noexcept override;
  // What the arms answered; where they were sent is compared by whoever has both records.
  Status Write(const DeviceCommand& command) noexcept override;
  std::string Describe() const override { return "arms and sensors as they were recorded"; }

 private:
  const TickRecord* record_ = nullptr;
};

// Gives the emulator what the tick of `record` was given, and ticks. `emulator`: of the same
// scenario, after the tick before it (or with its state loaded). `device`: its own, of a run on
// real arms; else null.
void Repeat(const TickRecord& record, Emulator* emulator,
            RecordedDevice* device = nullptr) noexcept;

// Whether two records of the same tick agree bit for bit, wall-clock times apart.
bool SameTick(const TickRecord& a, const TickRecord& b) noexcept;

}  // namespace predictor
