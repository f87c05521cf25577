// The key `perturbation` of a scenario.
#pragma once

#include "core/types.h"

namespace predictor {

// Small displacements of the real handles during RUN, from which the impedance of the operator's
// arm is identified (docs/how-to/identify-arm.md). Two handles move together, so that they keep
// their relative pose.
struct PerturbationSpec {
  bool consent = false;        // the person knows that the handles will move, and agrees
  double amplitude = 0.006;    // amplitude of a displacement [m]
  Vector3 normal = {0, 0, 1};  // normal of the plane in which the displacements lie, in W
  int directions = 8;          // evenly distributed in the plane
  double ramp = 0.12;          // duration of moving out, and of moving back [s]
  double hold = 0.2;           // time between moving out and back [s]
  double after = 3;            // simulated time from which displacements may begin [s]
  double pause = 0.6;          // shortest time from the end of one to the start of the next [s]
  double window = 0.6;         // added to `pause`, a random share of it [s]
  double speed = 0.03;         // speed of the virtual handles above which none begins [m/s]
  double force = 15;           // force of a hand beyond which a displacement is taken back [N]
  double margin = 2;           // least stability margin with which a run may begin
};

}  // namespace predictor
