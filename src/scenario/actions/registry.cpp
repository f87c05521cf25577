#include "scenario/actions/registry.h"

namespace predictor {

std::span<const ActionKind* const> Actions() {
#define PREDICTOR_ENTRY(kind) &actions::kind,
  static constexpr const ActionKind* kAll[] = {PREDICTOR_ACTIONS(PREDICTOR_ENTRY)};
#undef PREDICTOR_ENTRY
  return kAll;
}

}  // namespace predictor
