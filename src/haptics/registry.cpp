#include "haptics/registry.h"

#include <iterator>

namespace predictor {
namespace {

#define PREDICTOR_TASK(kind) &tasks::kind,
#define PREDICTOR_LIMIT(kind) &limits::kind,
constexpr const TaskKind* kTasks[] = {PREDICTOR_TASKS(PREDICTOR_TASK)};
constexpr const LimitKind* kLimits[] = {PREDICTOR_LIMITS(PREDICTOR_LIMIT)};
constexpr const ParameterKind* kParts[] = {PREDICTOR_TASKS(PREDICTOR_TASK)
                                               PREDICTOR_LIMITS(PREDICTOR_LIMIT)};
#undef PREDICTOR_TASK
#undef PREDICTOR_LIMIT
static_assert(std::size(kLimits) <= kMaxLimits, "RenderResult::slack_by_limit has no room");

// The tasks and limits are registered when the program starts, so that their parameters are known
// when a scenario is read.
[[maybe_unused]] const bool kDeclared = (DeclareRenderingParts(kParts), true);

}  // namespace

std::span<const TaskKind* const> RegisteredTasks() { return kTasks; }
std::span<const LimitKind* const> RegisteredLimits() { return kLimits; }

}  // namespace predictor
