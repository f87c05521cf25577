// A cobot that is not quite as it is believed to be: what identification is tried on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/random.h"
#include "core/record.h"
#include "scenario/scenario.h"

namespace predictor {

// How the "real" cobot differs from its model.
struct RealCobot {
  std::vector<double> viscous, coulomb;  // its joints' true friction [N·m·s/rad], [N·m]
  double mass_error = 0.03;              // of each link's mass, up or down, over the mass
  double com_error = 0.005;              // of each link's centre of mass, in some direction [m]
  double torque_noise = 0.2;             // of the torque that is read, standard deviation [N·m]
  std::uint64_t seed = 1;                // of all that is drawn
};

// Friction that is drawn: viscous from 0.6 to 2.4 N·m·s/rad, Coulomb from 0.3 to 1.2 N·m.
RealCobot DrawRealCobot(int joints, std::uint64_t seed);

// The scenario with the real cobot, `mode: direct`. Its URDF, and a copy of the load's, are written
// into `folder`, which must exist. Throws InputError.
Scenario MakeReal(const Scenario& believed, const RealCobot& real,
                  const std::filesystem::path& folder);

// What reading the torque adds, tick by tick.
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
