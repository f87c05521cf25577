// Real arms and sensors as one device: combined freely, of different makes and rates.
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

// One hand's arm and, unless the arm measures the wrench itself, its sensor.
struct RealSide {
  std::unique_ptr<Arm> arm;
  std::unique_ptr<WrenchSensor> sensor;
};

// Where an enabling device is wired to.
struct EnablingSource {
  int hand = 0;
  int digital_input = 0;
};

// A device that is wired to a digital input of the arm that this reading is of.
Enabling EnablingOf(const ArmReading& reading, int digital_input) noexcept;
// An input that was told of longer ago is silent [s].
inline constexpr double kInputAge = 0.025;

// A tick is shorter than the period of most devices. Between an arm's samples its joints are
// extrapolated by what it was told last, for as long as its sample is young; a wrench is held.
class RealDevice final : public Device {
 public:
  // For so long a sample is extrapolated [s]: past that its age speaks for itself.
  static constexpr double kMostExtrapolation = 0.010;

  // Absent sides are without an arm. `network`: through which they are reached. Throws DeviceError:
  // an arm without a wrench, or an enabling device at no arm.
  RealDevice(std::unique_ptr<Network> network, std::array<RealSide, kHands> sides,
             std::optional<EnablingSource> enabling = std::nullopt);
  ~RealDevice() override;

  // kDevice or kSensor, with the hand, of the first that has trouble; power_off if any asks for it.
  Status Read(DeviceSample* sample) noexcept override;
  Status Write(const DeviceCommand& command) noexcept override;
  Enabling enabling() const noexcept override;
  std::string Describe() const override;
  // Of the arm of a hand; null: there is none.
  const DeviceFacts* arm_facts(int hand) const;
  // What the arms and sensors say is wrong, and who of them is silent, in words; "" if nothing. Not
  // from the tick.
  std::string Trouble() const;

 private:
  // Ages as last read, for others than the tick [s].
  struct Ages {
    std::atomic<double> arm{0}, sensor{0};
  };
  std::string Silence(std::size_t hand) const;

  std::unique_ptr<Network> network_;  // outlives the sides
  std::array<RealSide, kHands> sides_;
  std::optional<EnablingSource> enabling_;
  std::array<ArmReading, kHands> readings_;
  std::array<WrenchReading, kHands> wrenches_;
  std::array<Ages, kHands> ages_;
  std::array<JointVector, kHands> sent_;  // last command [rad/s]
};

}  // namespace predictor
