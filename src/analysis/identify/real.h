// A cobot that differs from its nominal model, for testing the identification.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/random.h"
#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

// The differences between the simulated real cobot and its model.
struct RealCobot {
  std::vector<double> viscous, coulomb;  // true friction of its joints [N·m·s/rad], [N·m]
  double mass_error = 0.03;   // error of each link's mass in either direction, as a share of the
                              // mass
  double com_error = 0.005;   // error of each link's centre of mass, in a random direction [m]
  double torque_noise = 0.2;  // standard deviation of the measured torque [N·m]
  std::uint64_t seed = 1;     // seed of all random draws
};

// Draws random friction: viscous friction from 0.6 to 2.4 N·m·s/rad, and Coulomb friction from 0.3
// to 1.2 N·m.
RealCobot DrawRealCobot(int joints, std::uint64_t seed);

// Returns the scenario with the real cobot, in `mode: direct`. Writes the URDF of the real cobot
// and a copy of the load's URDF into `folder`, which must exist. Throws InputError.
Scenario MakeReal(const Scenario& nominal, const RealCobot& real,
                  const std::filesystem::path& folder);

// The noise of the measured torque, which is drawn for each tick.
class TorqueNoise {
 public:
  explicit TorqueNoise(const RealCobot& real)
      : deviation_(real.torque_noise), stream_(real.seed, "identify.torque") {}
  void Add(TickRecord* record) {
    for (std::size_t j = 0; j < record->cobot_dof; ++j)
      record->cobot_torque[j] += deviation_ * stream_.Normal();
  }

 private:
  double deviation_;  // [N·m]
  RandomStream stream_;
};

}  // namespace predictor
