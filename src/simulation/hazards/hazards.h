// Lists the hazards, one per line. Recordings contain the numbers of the hazards, so a new hazard
// must be added at the end of the list.
#pragma once

#include "simulation/hazards/hazard.h"

// clang-format off
#define PREDICTOR_HAZARDS(add) \
  add(kBrakesClose)            \
  add(kControlDelay)           \
  add(kControlFreeze)          \
  add(kDampingStep)            \
  add(kPowerLoss)              \
  add(kSensorBias)             \
  add(kSensorDrift)            \
  add(kSetPointJump)           \
  add(kStiffnessStep)          \
  add(kTakeover)               \
  add(kWrongFriction)          \
  add(kWrongPayload)           \
  add(kObjectBreaksLoose)      \
  add(kObjectSlips)            \
  add(kObstacleAppears)        \
  add(kReleaseObject)          \
  add(kGraspObject)            \
  add(kPickUp)                 \
  add(kLetGo)
// clang-format on

namespace predictor::hazards {

#define PREDICTOR_DECLARE(kind) extern const HazardKind kind;
PREDICTOR_HAZARDS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE

}  // namespace predictor::hazards
