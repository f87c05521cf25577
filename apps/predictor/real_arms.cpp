#include "real_arms.h"

#include <cstdio>

#include "core/real_time.h"
#include "devices/wire/network.h"

namespace predictor {
namespace {

// All that the machine names is this computer's: fakes.
bool OnThisComputer(const Machine& machine) {
  for (const std::optional<MachineArm>* arm : {&machine.left, &machine.right}) {
    if (!*arm) continue;
    for (const std::string& host : {(*arm)->connection.host, (*arm)->sensor.host})
      if (!host.empty() && !host.starts_with("127.") && host != "localhost") return false;
  }
  return true;
}

}  // namespace

void RequireRealTime(const Machine& machine) {
  const RealTimeScheduling now;
  if (now.prior()) return;
  if (!OnThisComputer(machine))
    throw DeviceError("Real arms are not moved here: " + now.got() + ". Then start again.");
  std::fprintf(stderr, "Warning: %s. Real arms would be refused.\n", now.got().c_str());
}

}  // namespace predictor
