// A force/torque sensor that streams RDT datagrams: ATI Net F/T and Axia, OnRobot HEX, OptoForce.
// Never run on hardware by us; proven over the protocol against a fake.
#pragma once

#include <memory>

#include "devices/arm.h"
#include "devices/wire/network.h"

namespace predictor {

enum class NetFtMake { kAti, kOnRobot };

// By which the rate may differ from what is said of it: more than clocks do.
inline constexpr double kRateError = 2e-3;

struct NetFtOptions {
  NetFtMake make = NetFtMake::kAti;
  Address address;                 // port 49152 as a rule
  double counts_per_force = 1e6;   // of the sensor's configuration (netftapi2.xml: cfgcpf) [1/N]
  double counts_per_torque = 1e6;  // cfgcpt [1/(N·m)]
  double rate = 1000;              // that it is set to send at; an OnRobot sensor is told so [Hz]
};

// Asks the sensor to stream and waits for its first record. Its own bias is left as it is: taring
// is ours, and recorded. Throws DeviceError: silence, records of another size, a status that tells
// of an error, or a rate that it cannot send at.
//
// A reading's age is told by the records' own numbers, at their rate, against the quickest record
// of late: so what waits in a queue is as old as it is, however slowly the queue grows, and a rate
// that is another one than `rate` by more than kRateError ages too: Trouble says so. What the
// sensor's own filter delays is not in it (SensorSpec.delay).
//
// The reading is what the sensor gives: force and torque on its tool side, so what the handle
// exerts on the sensor, in its own axes. One client at a time gets the stream. `network` outlives
// it.
std::unique_ptr<WrenchSensor> ConnectNetFt(const NetFtOptions& options, Network* network);

}  // namespace predictor
