#include "evaluation/metrics/registry.h"

namespace predictor {

std::span<const MetricKind* const> Metrics() {
#define PREDICTOR_ENTRY(kind) &metrics::kind,
  static constexpr const MetricKind* kAll[] = {PREDICTOR_METRICS(PREDICTOR_ENTRY)};
#undef PREDICTOR_ENTRY
  return kAll;
}

}  // namespace predictor
