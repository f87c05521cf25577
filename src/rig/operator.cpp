#include "rig/operator.h"

namespace predictor {

std::unique_ptr<Operator> MakeOperator(const Scenario& scenario, HandInertia inertia) {
  return scenario.operator_.type == "browser" ? MakeBrowserOperator(scenario, inertia)
                                              : MakeVirtualOperator(scenario, inertia);
}

}  // namespace predictor
