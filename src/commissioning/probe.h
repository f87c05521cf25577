// Who of a machine's arms and sensors answers, and how well: rates, ages, wrench, payload; whether
// each is what the machine file says. Nothing moves.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/arm.h"
#include "devices/wire/network.h"
#include "scenario/machine.h"

namespace predictor {

// How arms and sensors are connected to (devices/connect.h; in tests something else). Each throws
// DeviceError. No sensor: null, the arm has its own.
struct Connector {
  std::function<std::unique_ptr<Arm>(const MachineArm&, Network*)> arm;
  std::function<std::unique_ptr<WrenchSensor>(const MachineArm&, Network*)> sensor;
};

// How fresh samples came.
struct SampleTimes {
  int samples = 0;                   // that were seen
  double rate = 0;                   // by the samples' numbers [Hz]
  double lost = 0;                   // part of the numbers that was never seen
  double p50 = 0, p99 = 0, max = 0;  // of the time between fresh ones [s]
  double age_p50 = 0, age_max = 0;   // of the newest one when it was looked at [s]
};

// One device: an arm, or a sensor of its own.
struct Probed {
  std::string place;                    // "left arm", "right sensor"
  std::string name;                     // of its facts; empty if it does not answer
  std::string trouble;                  // what is wrong; empty if nothing
  std::vector<std::string> mismatches;  // in what it is not what the machine file says it is
  std::vector<std::string> remarks;     // what a person should look at: payload, settings
  SampleTimes times;
  JointVector q;  // of an arm, at the end [rad]
  bool has_wrench = false;
  SampleTimes wrench_times;     // of an arm's own wrench
  Wrench F_S = Wrench::Zero();  // mean about S [N], [N·m]
  Wrench deviation = Wrench::Zero();
  bool answers() const { return !name.empty() && trouble.empty(); }
};

struct ProbeOptions {
  double duration = 2;    // for which each is watched [s]
  double patience = 0.5;  // a device that gives no fresh sample for longer is in trouble [s]
  double poll = 0.00025;  // how often it is looked at [s]
};

// One device after the other, so that each is told apart; an error of one is its own.
std::vector<Probed> ProbeMachine(const Machine& machine, const Connector& connector,
                                 Network* network, const ProbeOptions& options = {});

bool AllAnswer(const std::vector<Probed>& probed);
// Those that answer are what the machine file says.
bool AllMatch(const std::vector<Probed>& probed);

std::string ProbeText(const std::vector<Probed>& probed);

}  // namespace predictor
