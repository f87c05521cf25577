// Checks which arms and sensors of a machine answer, and whether each device matches the machine
// file. Measures the rates and the ages of the samples, the wrench and the payload. Nothing moves.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/arm.h"
#include "devices/wire/network.h"
#include "scenario/machine.h"

namespace predictor::commissioning {

// The functions that connect to arms and sensors. The program uses the functions in
// devices/connect.h; tests use other functions. Each throws DeviceError. The sensor is null if the
// arm has a built-in sensor.
struct Connector {
  std::function<std::unique_ptr<Arm>(const MachineArm&, Network*)> arm;
  std::function<std::unique_ptr<WrenchSensor>(const MachineArm&, Network*)> sensor;
};

// Arrival of new samples.
struct SampleTimes {
  int samples = 0;                   // number of received samples
  double rate = 0;                   // rate according to the samples' numbers [Hz]
  double lost = 0;                   // share of the numbers that never arrived
  double p50 = 0, p99 = 0, max = 0;  // time between new samples [s]
  double age_p50 = 0, age_max = 0;   // age of the newest sample when it was polled [s]
};

// A device, which is an arm or a separate sensor.
struct Probed {
  std::string place;                    // "left arm", "right sensor"
  std::string name;                     // name from its facts; empty if the device does not answer
  std::string trouble;                  // the problem; empty without one
  std::vector<std::string> mismatches;  // differences from the machine file
  std::vector<std::string> remarks;     // facts that the user should check: payload, settings
  SampleTimes times;
  JointVector q;  // joints of an arm at the end [rad]
  bool has_wrench = false;
  Wrench F_S = Wrench::Zero();  // mean about S [N], [N·m]
  Wrench deviation = Wrench::Zero();
  bool answers() const { return !name.empty() && trouble.empty(); }
};

struct ProbeOptions {
  double duration = 2;    // time for which each device is observed [s]
  double patience = 0.5;  // a device without a new sample for longer has a problem [s]
  double poll = 0.00025;  // interval of polling [s]
};

// Probes one device after the other, so that each device can be identified. An error of one device
// does not affect the other devices.
std::vector<Probed> ProbeMachine(const Machine& machine, const Connector& connector,
                                 Network* network, const ProbeOptions& options = {});

bool AllAnswer(const std::vector<Probed>& probed);
// Returns whether all devices that answer match the machine file.
bool AllMatch(const std::vector<Probed>& probed);

std::string ProbeText(const std::vector<Probed>& probed);

}  // namespace predictor::commissioning
