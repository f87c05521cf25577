// Combines real arms and sensors of different makes and rates into one device.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "devices/arm.h"
#include "devices/device.h"
#include "devices/wire/network.h"

namespace predictor {

// The arm of one hand, and a sensor if the arm does not measure the wrench itself.
struct RealSide {
  std::unique_ptr<Arm> arm;
  std::unique_ptr<WrenchSensor> sensor;
};

// The input of an enabling device.
struct EnablingSource {
  int hand = 0;
  int digital_input = 0;
};

// Returns the state of an enabling device that is wired to a digital input of the arm. `reading` is
// the arm's reading.
Enabling EnablingOf(const ArmReading& reading, int digital_input) noexcept;
// An input counts as silent if its last report is older than this [s].
inline constexpr double kInputAge = 0.025;

// A tick is shorter than the period of most devices. Between two samples of an arm, this class
// extrapolates the joint positions with the last command, as long as the sample is fresh. A wrench,
// however, keeps its value between two samples.
class RealDevice final : public Device {
 public:
  // A sample is extrapolated for at most this time [s]. After this time, the age of the sample
  // stops the run.
  static constexpr double kMaxExtrapolation = 0.010;

  // For an absent side, there is no arm. `network` connects to the devices. Throws DeviceError if
  // an arm does not provide a wrench, or if an enabling device is wired to an absent arm.
  RealDevice(std::unique_ptr<Network> network, std::array<RealSide, kHands> sides,
             std::optional<EnablingSource> enabling = std::nullopt);
  ~RealDevice() override;

  // Returns the first fault (kDevice or kSensor) and the hand to which it belongs. `power_off` is
  // set if any fault requires that the power is switched off.
  Status Read(DeviceSample* sample) noexcept override;
  Status Write(const DeviceCommand& command) noexcept override;
  Enabling enabling() const noexcept override;
  std::string Describe() const override;
  // Returns the facts about a hand's arm, or null if the arm is absent.
  const DeviceFacts* arm_facts(int hand) const;
  // Describes the faults that arms and sensors report, and names a silent device. Returns ""
  // without faults. It must not be called in a tick.
  std::string Trouble() const;

 private:
  // Ages of the samples at the last Read [s], for callers outside the tick.
  struct Ages {
    std::atomic<double> arm{0}, sensor{0};
  };
  std::string Silence(std::size_t hand) const;

  std::unique_ptr<Network> network_;  // must outlive the sides
  std::array<RealSide, kHands> sides_;
  std::optional<EnablingSource> enabling_;
  std::array<ArmReading, kHands> readings_;
  std::array<WrenchReading, kHands> wrenches_;
  std::array<Ages, kHands> ages_;
  std::array<JointVector, kHands> sent_;  // last command [rad/s]
};

}  // namespace predictor
