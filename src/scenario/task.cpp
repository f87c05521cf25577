#include "scenario/task.h"

#include <functional>

#include "scenario/scenario_io.h"

namespace predictor {

std::vector<std::string> TaskDifferences(const Scenario& a, const Scenario& b) {
  struct Part {
    const char* name;
    std::function<void(const Scenario& from, Scenario* to)> copy;
  };
  const std::vector<Part> parts = {
      {"the object", [](const Scenario& from, Scenario* to) { to->object = from.object; }},
      {"the handles",
       [](const Scenario& from, Scenario* to) {
         to->left_handle = from.left_handle;
         to->right_handle = from.right_handle;
       }},
      {"the surroundings",
       [](const Scenario& from, Scenario* to) { to->environment = from.environment; }},
      {"the guidance", [](const Scenario& from, Scenario* to) { to->guidance = from.guidance; }},
      {"the script",
       [](const Scenario& from, Scenario* to) { to->operator_.script = from.operator_.script; }}};
  std::vector<std::string> different;
  for (const Part& part : parts) {
    Scenario of_a, of_b;
    part.copy(a, &of_a);
    part.copy(b, &of_b);
    if (SaveScenario(of_a) != SaveScenario(of_b)) different.emplace_back(part.name);
  }
  return different;
}

}  // namespace predictor
