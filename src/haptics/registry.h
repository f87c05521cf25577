// The list of the tasks and limits of rendering. To add a task or a limit, see
// docs/developer/add-a-limit.md.
#pragma once

#include <memory>
#include <span>
#include <type_traits>

#include "haptics/limit.h"
#include "haptics/task.h"
#include "scenario/own_parameters.h"

// Terms are summed in the order of the tasks; the bounds of an earlier limit have priority over
// those of a later one.
// clang-format off
#define PREDICTOR_TASKS(add) \
  add(kTracking)             \
  add(kRelativePose)         \
  add(kManipulability)       \
  add(kDamping)

#define PREDICTOR_LIMITS(add) \
  add(kJoint)                 \
  add(kLinkDistance)
// clang-format on

namespace predictor {

// A kind of task or limit. `Made` is the type of its objects. The parameters of a kind form the
// group rendering.NAME of a scenario.
template <class Made>
struct RenderingKind : ParameterKind {
  std::unique_ptr<Made> (*make)(const RenderSetup&, const OwnParameters&);  // throws InputError
};
using TaskKind = RenderingKind<Task>;
using LimitKind = RenderingKind<Limit>;

// The kind of a task or limit M. The constructor of M takes the setup and, if M has parameters, the
// parameters P.
template <class Made, class M, class P>
constexpr RenderingKind<Made> RenderingKindOf(const char* name, const char* doc) {
  return {{name, doc, NewParameters<P>},
          [](const RenderSetup& setup, const OwnParameters& own) -> std::unique_ptr<Made> {
            if constexpr (std::is_same_v<P, NoParameters>) {
              return std::make_unique<M>(setup);
            } else {
              return std::make_unique<M>(setup, ValueOf<P>(own));
            }
          }};
}
template <class M, class P = NoParameters>
constexpr TaskKind TaskKindOf(const char* name, const char* doc) {
  return RenderingKindOf<Task, M, P>(name, doc);
}
template <class M, class P = NoParameters>
constexpr LimitKind LimitKindOf(const char* name, const char* doc) {
  return RenderingKindOf<Limit, M, P>(name, doc);
}

namespace tasks {
#define PREDICTOR_DECLARE(kind) extern const TaskKind kind;
PREDICTOR_TASKS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE
}  // namespace tasks
namespace limits {
#define PREDICTOR_DECLARE(kind) extern const LimitKind kind;
PREDICTOR_LIMITS(PREDICTOR_DECLARE)
#undef PREDICTOR_DECLARE
}  // namespace limits

std::span<const TaskKind* const> RegisteredTasks();
// Returns the limits in the order of their rows in the QP and of RenderResult::slack_by_limit.
std::span<const LimitKind* const> RegisteredLimits();

}  // namespace predictor
