// Lists the actions of the operator's script, one per line and sorted by name.
#pragma once

#include "scenario/actions/action.h"

// clang-format off
#define PREDICTOR_ACTIONS(add) \
  add(kCircle)                 \
  add(kGrip)                   \
  add(kHold)                   \
  add(kMove)                   \
  add(kPush)                   \
  add(kPutDown)                \
  add(kRelease)                \
  add(kRotate)
// clang-format on

namespace predictor::actions {

#define PREDICTOR_DECLARE(kind) extern const ActionKind kind;
PREDICTOR_ACTIONS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE

}  // namespace predictor::actions
