// Predicts what the device can render while the object touches a fixture.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "core/messages.h"
#include "haptics/stability.h"
#include "haptics/wall.h"
#include "scenario/scenario.h"

namespace predictor {

// The range of stiffnesses in which the prediction searches [N/m].
inline constexpr double kSoftestWall = 100, kStiffestWall = 1e6;

// The stiffest wall against which the loop does not oscillate.
struct WallLimit {
  double stiffness = 0;  // [N/m]; 0: the loop oscillates even without a wall
  double frequency = 0;  // of the oscillation against a stiffer one [Hz]
  bool reached = true;   // false: none up to kStiffestWall makes it oscillate
};

// Returns the limit for a hand and a lead [s] to 5 %. `wall` gives place, direction and damping of
// the wall, whose stiffness is varied from soft to stiff. Above the limit, still stiffer walls may
// be stable again.
WallLimit StiffestStableWall(const LinearModel& world, const Scenario& scenario,
                             const HandSpec& hand, double lead, const Wall& wall,
                             LoopModel model = LoopModel::kWithReserve);

// What the hands feel at one frequency.
struct FeltAt {
  double frequency = 0;  // [Hz]
  FeltImpedance felt;
};

// A wall that stands for one point of contact with fixtures of the same kind that lie on the same
// side of the object.
struct FixtureWall {
  std::vector<std::size_t> fixtures;  // their numbers
  Wall wall;
  bool yields = false;  // they have a stiffness
  // The fixtures' own damping if they yield, and otherwise none: the law of a contact that does not
  // yield applies only with its own stiffness.
  Wall Varying() const;
};

// What happens in contact with such fixtures.
struct ContactReport : FixtureWall {
  bool stable = true;  // touched at one point and, if they yield, at four
  WallLimit limit;     // with the wall Varying(), for the scenario's hand
  // Felt by the hands at rest, at kFeltFrequency and at all frequencies of FeltFrequencies(),
  // touching at one point.
  FeltImpedance at_rest, moving;
  std::vector<FeltAt> spectrum;
};
inline constexpr double kFeltFrequency = 5;  // [Hz]

// Returns frequencies from 0.1 to 40 Hz, 20 in each decade [Hz].
std::vector<double> FeltFrequencies();

// Returns the walls of all fixtures that touch the object. Each contact is at the object's origin,
// whose pose in W is X_WO, along the normal of the fixture's nearest side. Empty without hands.
std::vector<FixtureWall> WallsOf(const Scenario& scenario, const LinearModel& world,
                                 const Pose& X_WO);

// Returns the reports for WallsOf. The world is linearised about the start. `lead` is that of the
// run [s].
std::vector<ContactReport> CheckContacts(const Scenario& scenario, const LinearModel& world,
                                         const Pose& X_WO, double lead);

// Returns the damping that an impedance [N/m] contains at a frequency [Hz], in N·s/m.
double DampingOf(const std::complex<double>& impedance, double frequency);

// Returns the unit normal of a fixture's side that faces the point p_W, out of the fixture, in W.
Vector3 NormalToward(const FixtureSpec& fixture, const Vector3& p_W);

}  // namespace predictor
