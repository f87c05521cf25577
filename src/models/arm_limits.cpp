#include "models/arm_limits.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace predictor {
namespace {

constexpr double kShareOfVendorLimit = 0.8;

void CheckCount(const char* key, std::size_t size, bool one_is_enough, const RobotModel& model) {
  if (size == static_cast<std::size_t>(model.dof()) || (one_is_enough && size == 1)) return;
  throw InputError::At(key, std::string(key) + " has " + std::to_string(size) +
                                " values; the arm has " + std::to_string(model.dof()) +
                                " joints. Give " + (one_is_enough ? "one value for all, or " : "") +
                                "one value per joint.");
}

}  // namespace

ArmLimits LimitsOf(const ArmSpec& spec, const RobotModel& model) {
  if (!spec.velocity_limit.empty())
    CheckCount("velocity_limit", spec.velocity_limit.size(), false, model);
  CheckCount("acceleration_limit", spec.acceleration_limit.size(), true, model);
  ArmLimits l;
  l.lower = model.position_lower();
  l.upper = model.position_upper();
  l.velocity = kShareOfVendorLimit * model.velocity_limit();
  l.acceleration.resize(model.dof());
  for (int j = 0; j < model.dof(); ++j) {
    if (!spec.velocity_limit.empty())
      l.velocity[j] = std::min(l.velocity[j], spec.velocity_limit[static_cast<std::size_t>(j)]);
    l.acceleration[j] = OneOrEach(spec.acceleration_limit, j);
  }
  return l;
}

}  // namespace predictor
