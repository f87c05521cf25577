// Repeats a run from the inputs in its records.
#pragma once

#include <string>

#include "core/record.h"
#include "devices/device.h"
#include "emulator/emulator.h"

namespace predictor {

// Replaces the real arms in a replay. This device returns the samples of arms and sensors from the
// record of a tick.
class RecordedDevice final : public Device {
 public:
  // Sets the record of the next tick. The record must remain valid until this tick ends.
  void Expect(const TickRecord* record) noexcept { record_ = record; }

  Status Read(DeviceSample* sample) noexcept override;
  // Returns the recorded answer of the arms. The function does not check the command.
  Status Write(const DeviceCommand& command) noexcept override;
  std::string Describe() const override { return "arms and sensors as they were recorded"; }

 private:
  const TickRecord* record_ = nullptr;
};

// Submits the inputs and requests of `record` to the emulator and executes the tick. `emulator`
// must have the same scenario and must be in the state after the previous tick. `device` is the
// emulator's device for a run on real arms, and otherwise null.
void Repeat(const TickRecord& record, Emulator* emulator,
            RecordedDevice* device = nullptr) noexcept;

// Returns whether two records of the same tick agree bit for bit, except for wall-clock times.
bool SameTick(const TickRecord& a, const TickRecord& b) noexcept;

}  // namespace predictor
