#include "devices/real_device.h"

#include <algorithm>
#include <utility>

namespace predictor {
namespace {

constexpr double kSilent = 0.05;  // a device that has been silent for longer is named [s]

// Adds a fault of the arm or the sensor of a hand. The first fault is reported. A fault that
// forbids holding takes precedence, because this fault determines how the stop ends.
void Add(const Status& status, std::size_t hand, Status* all) noexcept {
  const bool severer = status.power_off && !all->power_off;
  if (status.ok() || !(all->ok() || severer)) return;
  *all = status;
  all->hand = static_cast<std::int8_t>(hand);
}

// Estimates the current joint positions from a sample with the age `age`, assuming that the joints
// have moved as commanded.
void Extrapolate(const ArmReading& reading, const JointVector& sent, ArmSample* sample) noexcept {
  sample->q = reading.q;
  sample->v = reading.v;
  if (sent.size() != reading.q.size()) return;
  const double ahead = std::clamp(reading.age, 0.0, RealDevice::kMaxExtrapolation);
  sample->q += ahead * sent;
}

}  // namespace

RealDevice::RealDevice(std::unique_ptr<Network> network, std::array<RealSide, kHands> sides,
                       std::optional<EnablingSource> enabling)
    : network_(std::move(network)), sides_(std::move(sides)), enabling_(enabling) {
  for (const RealSide& side : sides_)
    if (side.arm && !side.sensor && !side.arm->facts().own_wrench)
      throw DeviceError(
          side.arm->facts().name +
          " does not measure a wrench at its handle. Add a force/torque sensor to this arm.");
  if (enabling_ && arm_facts(enabling_->hand) == nullptr)
    throw DeviceError(
        std::string("The enabling device is wired to the ") +
        kHandNames[static_cast<std::size_t>(enabling_->hand)] +
        " arm, but this scenario has no handle there. Wire the enabling device to the other arm. "
        "Otherwise, remove enabling from the machine file and hold a key at the console.");
}

RealDevice::~RealDevice() = default;

Status RealDevice::Read(DeviceSample* sample) noexcept {
  Status all;
  for (std::size_t i = 0; i < kHands; ++i) {
    ArmSample& out = sample->arms[i];
    RealSide& side = sides_[i];
    out.present = side.arm != nullptr;
    if (!out.present) continue;
    ArmReading& reading = readings_[i];
    Add(side.arm->Read(&reading), i, &all);
    if (side.sensor) {
      Add(side.sensor->Read(&wrenches_[i]), i, &all);
    } else {
      wrenches_[i] = reading.wrench;
    }
    Extrapolate(reading, sent_[i], &out);
    out.F_S_raw = wrenches_[i].F_S;
    out.arm_sequence = reading.sequence;
    out.sensor_sequence = wrenches_[i].sequence;
    out.arm_age = reading.age;
    out.sensor_age = wrenches_[i].age;
    ages_[i].arm = reading.age;
    ages_[i].sensor = wrenches_[i].age;
    out.sensor_saturated = wrenches_[i].saturated;
    out.fault = reading.fault;
    out.in_motion = reading.in_motion;
    out.waits = reading.waits;
    out.no_power_off = reading.no_power_off;
    out.keeps_power = reading.keeps_power;
    out.arm_link = reading.link;
    out.sensor_link = wrenches_[i].link;
  }
  return all;
}

Status RealDevice::Write(const DeviceCommand& command) noexcept {
  Status all;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!sides_[i].arm) continue;
    sides_[i].arm->PowerOff(command.state == RunState::kUnpowered);
    sent_[i] = command.v[i];
    Add(sides_[i].arm->Write(command.v[i], MayMove(command.state)), i, &all);
  }
  return all;
}

Enabling EnablingOf(const ArmReading& reading, int digital_input) noexcept {
  if (!(reading.age <= kInputAge)) return Enabling::kSilent;
  return (reading.inputs >> digital_input & 1U) != 0 ? Enabling::kPressed : Enabling::kReleased;
}

Enabling RealDevice::enabling() const noexcept {
  if (!enabling_) return Enabling::kNone;
  return EnablingOf(readings_[static_cast<std::size_t>(enabling_->hand)], enabling_->digital_input);
}

const DeviceFacts* RealDevice::arm_facts(int hand) const {
  const RealSide& side = sides_[static_cast<std::size_t>(hand)];
  return side.arm ? &side.arm->facts() : nullptr;
}

std::string RealDevice::Describe() const {
  std::string text;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!sides_[i].arm) continue;
    if (!text.empty()) text += "; ";
    text += std::string(kHandNames[i]) + " " + sides_[i].arm->facts().name;
    if (sides_[i].sensor) text += " with " + sides_[i].sensor->facts().name;
  }
  return text;
}

// Names the silent device of a hand: the arm or the sensor.
std::string RealDevice::Silence(std::size_t hand) const {
  const RealSide& side = sides_[hand];
  constexpr const char* kSee =
      " no longer sends new data. Check its power, its cable and its network.";
  if (ages_[hand].arm > kSilent) return "the arm, " + side.arm->facts().name + "," + kSee;
  if (ages_[hand].sensor <= kSilent) return "";
  if (side.sensor) return "the sensor, " + side.sensor->facts().name + "," + kSee;
  return "the arm, " + side.arm->facts().name +
         ", no longer sends a wrench. A Franka sends no wrench near a singular pose.";
}

std::string RealDevice::Trouble() const {
  std::string text;
  for (std::size_t i = 0; i < kHands; ++i) {
    if (!sides_[i].arm) continue;
    std::string arm = sides_[i].arm->Trouble();
    std::string sensor = sides_[i].sensor ? sides_[i].sensor->Trouble() : "";
    if (arm.empty() && sensor.empty()) arm = Silence(i);
    for (const std::string& trouble : {arm, sensor})
      if (!trouble.empty())
        text += (text.empty() ? "" : " ") + std::string(kHandNames[i]) + ": " + trouble;
  }
  return text;
}

}  // namespace predictor
