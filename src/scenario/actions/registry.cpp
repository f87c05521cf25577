#include "scenario/actions/registry.h"

namespace predictor {

ParameterKinds Actions() noexcept {
#define PREDICTOR_ENTRY(kind) &actions::kind,
  static constexpr const ParameterKind* kAll[] = {PREDICTOR_ACTIONS(PREDICTOR_ENTRY)};
#undef PREDICTOR_ENTRY
  return kAll;
}

}  // namespace predictor
