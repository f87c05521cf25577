#include "haptics/registry.h"

namespace predictor {

// One line each: name and factory function. Terms are summed in the order of the tasks; the bounds
// of an earlier limit have priority over those of a later one.
// clang-format off
#define PREDICTOR_TASKS(add)                \
  add("tracking", MakeTracking)             \
  add("relative_pose", MakeRelativePose)    \
  add("manipulability", MakeManipulability) \
  add("damping", MakeDamping)

#define PREDICTOR_LIMITS(add)            \
  add("joint", MakeJointLimit)           \
  add("link_distance", MakeLinkDistance)
// clang-format on

#define PREDICTOR_DECLARE_TASK(name, make) std::unique_ptr<Task> make(const RenderSetup&);
#define PREDICTOR_DECLARE_LIMIT(name, make) std::unique_ptr<Limit> make(const RenderSetup&);
#define PREDICTOR_ENTRY(name, make) {name, make},

PREDICTOR_TASKS(PREDICTOR_DECLARE_TASK)
PREDICTOR_LIMITS(PREDICTOR_DECLARE_LIMIT)

std::span<const RegisteredTask> RegisteredTasks() {
  static constexpr RegisteredTask kTasks[] = {PREDICTOR_TASKS(PREDICTOR_ENTRY)};
  return kTasks;
}

std::span<const RegisteredLimit> RegisteredLimits() {
  static constexpr RegisteredLimit kLimits[] = {PREDICTOR_LIMITS(PREDICTOR_ENTRY)};
  static_assert(std::size(kLimits) <= kMaxLimits, "RenderResult::slack_by_limit has no room");
  return kLimits;
}

}  // namespace predictor
