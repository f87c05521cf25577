// A force/torque sensor that streams RDT datagrams: ATI Net F/T and Axia, OnRobot HEX, OptoForce.
// Never run on hardware by us; proven over the protocol against a fake.
#pragma once

#include <memory>

#include "devices/arm.h"
#include "devices/wire/network.h"

namespace predictor {

enum class NetFtMake { kAti, kOnRobot };

struct NetFtOptions {
  NetFtMake make = NetFtMake::kAti;
  Address address;                 // port 49152 as a rule
  double counts_per_force = 1e6;   // of the sensor's configuration (netftapi2.xml: cfgcpf) [1/N]
  double counts_per_torque = 1e6;  // cfgcpt [1/(N·m)]
  double rate = 1000;              // that the sensor is set to send at [Hz]
  double delay = 0;                // between measuring and sending, as known [s]
};

// Asks the sensor to stream and waits for its first record. Its own bias is left as it is: taring
// is ours, and recorded. Throws DeviceError: silence, records of another size, or a status that
// tells of an error.
//
// The reading is what the sensor gives: force and torque on its tool side, so what the handle
// exerts on the sensor, in its own axes. One client at a time gets the stream. `network` outlives
// it.
std::unique_ptr<WrenchSensor> ConnectNetFt(const NetFtOptions& options, Network* network);

}  // namespace predictor
