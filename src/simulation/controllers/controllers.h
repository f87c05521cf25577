// Lists the controllers of the virtual cobot, one per line and sorted by name.
#pragma once

#include "simulation/controller.h"

// clang-format off
#define PREDICTOR_CONTROLLERS(add) \
  add(kAdmittance)                 \
  add(kCartesianImpedance)         \
  add(kGravityCompensation)        \
  add(kHybridForcePosition)        \
  add(kJointImpedance)             \
  add(kLoadSharing)                \
  add(kMinimumJerkIntention)       \
  add(kPlugin)                     \
  add(kProcess)                    \
  add(kVariableImpedance)          \
  add(kVirtualFixtures)
// clang-format on

namespace predictor::controllers {

#define PREDICTOR_DECLARE(kind) extern const ControllerKind kind;
PREDICTOR_CONTROLLERS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE

}  // namespace predictor::controllers
