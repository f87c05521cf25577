// Lists the metrics of a run, one per line, in the order of the summary.
#pragma once

#include "evaluation/metric.h"

// clang-format off
#define PREDICTOR_METRICS(add) \
  add(kDuration)               \
  add(kTracking)               \
  add(kGuidance)               \
  add(kWrench)                 \
  add(kOscillation)            \
  add(kLinkDistance)           \
  add(kObjectHeight)           \
  add(kEnergy)                 \
  add(kGrip)                   \
  add(kMovableObjects)         \
  add(kCobotLimits)            \
  add(kRendering)              \
  add(kControllerAnswers)      \
  add(kDeadlines)              \
  add(kTiming)
// clang-format on

namespace predictor::metrics {

#define PREDICTOR_DECLARE(kind) extern const MetricKind kind;
PREDICTOR_METRICS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE

}  // namespace predictor::metrics
