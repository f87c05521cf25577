// The tasks and limits of rendering. To add one, see docs/developer/add-a-limit.md.
#pragma once

#include <memory>
#include <span>

#include "haptics/limit.h"
#include "haptics/task.h"

namespace predictor {

struct RegisteredTask {
  const char* name;
  std::unique_ptr<Task> (*make)(const RenderSetup&);  // throws InputError
};
struct RegisteredLimit {
  const char* name;
  std::unique_ptr<Limit> (*make)(const RenderSetup&);  // throws InputError
};

std::span<const RegisteredTask> RegisteredTasks();
// In the order of their rows in the QP and of RenderResult::slack_by_limit.
std::span<const RegisteredLimit> RegisteredLimits();

}  // namespace predictor
