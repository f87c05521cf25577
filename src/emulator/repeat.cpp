#include "emulator/repeat.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace predictor {
namespace {

template <std::size_t N>
void Fill(const std::array<double, N>& from, std::uint8_t dof, JointVector* to) {
  *to = Eigen::Map<const Eigen::VectorXd>(from.data(), std::min<Eigen::Index>(dof, N));
}

}  // namespace

Status RecordedDevice::Read(DeviceSample* sample) noexcept {
  for (std::size_t i = 0; i < kHands; ++i) {
    const HandRecord& hand = record_->hands[i];
    ArmSample& arm = sample->arms[i];
    arm.present = hand.present != 0;
    if (!arm.present) continue;
    Fill(hand.q, hand.arm_dof, &arm.q);
    Fill(hand.v, hand.arm_dof, &arm.v);
    arm.F_S_raw = Eigen::Map<const Wrench>(hand.wrench_raw.data());
    arm.arm_sequence = hand.arm_sequence;
    arm.sensor_sequence = hand.sensor_sequence;
    arm.arm_age = hand.arm_age;
    arm.sensor_age = hand.sensor_age;
    arm.sensor_saturated = hand.sensor_saturated != 0;
    arm.fault = hand.arm_fault != 0;
    arm.in_motion = hand.arm_in_motion != 0;
    arm.waits = hand.arm_waits != 0;
  }
  return FromRecord(record_->read);
}

Status RecordedDevice::Write(const DeviceCommand&) noexcept { return FromRecord(record_->written); }

void Repeat(const TickRecord& record, Emulator* emulator, RecordedDevice* device) noexcept {
  if (device) device->Expect(&record);
  emulator->Play(record);
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
