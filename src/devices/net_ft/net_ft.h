// A force/torque sensor that streams RDT datagrams. The supported sensors are ATI Net F/T and Axia,
// OnRobot HEX, and OptoForce. The driver was tested with a fake sensor that uses the same protocol,
// and has never run on hardware.
#pragma once

#include <memory>

#include "devices/arm.h"
#include "devices/wire/network.h"

namespace predictor {

enum class NetFtMake { kAti, kOnRobot };

// The largest permitted relative deviation of the rate from its nominal value. Clocks deviate less.
inline constexpr double kRateError = 2e-3;

struct NetFtOptions {
  NetFtMake make = NetFtMake::kAti;
  Address address;                 // port 49152 by default
  double counts_per_force = 1e6;   // see the sensor's configuration (netftapi2.xml: cfgcpf) [1/N]
  double counts_per_torque = 1e6;  // cfgcpt [1/(N·m)]
  double rate = 1000;  // rate of the records; an OnRobot sensor is configured with it [Hz]
};

// Requests the stream and waits for the first record. The driver does not change the bias that is
// set in the sensor. Instead, this program tares the sensor and records its own bias. Throws
// DeviceError if the sensor is silent, if its records have the wrong size, if its status is an
// error, or if it does not support the rate.
//
// The age of a reading is computed from the sequence numbers and the rate of the records, relative
// to the recent record with the shortest delay. The age of a record therefore includes the time
// that the record spent in a queue, even if the queue grows slowly. If the sensor's rate deviates
// from `rate` by more than kRateError, the age grows too, and Trouble reports this deviation. The
// delay of the sensor's own filter is not included (SensorSpec.delay).
//
// The reading is the sensor's output. This is the force and torque that the handle exerts on the
// sensor's tool side, in the sensor's axes. The sensor streams to one client at a time. `network`
// must outlive the sensor.
std::unique_ptr<WrenchSensor> ConnectNetFt(const NetFtOptions& options, Network* network);

}  // namespace predictor
