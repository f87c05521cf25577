// The thresholds that a reset does not restore.
#include <cstdio>
#include <vector>

#include "core/text.h"
#include "scenario/operating_rules.h"
#include "viewer/scene_description.h"

namespace predictor::viewer {
namespace {

std::string Format(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

std::string KeptThresholds(const Scenario& scenario, const TickRecord& record) {
  std::vector<std::string> kept;
  const auto compare = [&](Parameter parameter, const char* value, const char* of) {
    const double now = record.parameters[static_cast<std::size_t>(parameter)];
    const double start = RangeOf(scenario, parameter).start;
    if (now < start) kept.push_back(Format(value, now) + " instead of " + Format(of, start));
  };
  compare(Parameter::kForceThreshold, "%.3g", "%.3g N");
  compare(Parameter::kTorqueThreshold, "%.3g", "%.3g N·m");
  if (kept.empty()) return "";
  return "The reset keeps the tighter thresholds: " + Join(kept, ", ") + ".";
}

}  // namespace predictor::viewer
