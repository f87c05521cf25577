#include "core/run_input.h"

namespace predictor {

const char* Name(Parameter parameter) {
  static constexpr std::array<const char*, kParameters> kNames = {
      "stiffness_translation", "stiffness_rotation", "damping_ratio", "force", "torque"};
  return kNames[static_cast<std::size_t>(parameter)];
}

}  // namespace predictor
