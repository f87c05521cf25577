#include "analysis/check/event_advice.h"

#include <algorithm>
#include <limits>

#include "analysis/check/check.h"
#include "core/format.h"
#include "scenario/event_words.h"

namespace predictor {
namespace {

using Paths = std::vector<std::vector<IntendedSample>>;

// Returns the smallest distance of the object from the centre of the place while the event may
// begin [m].
double DistanceFromPlace(const TriggerSpec& trigger, const Pose& X_WO, const Paths& paths) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::vector<IntendedSample>& path : paths)
    for (const IntendedSample& sample : path)
      if (sample.time >= trigger.after)
        nearest = std::min(nearest, (sample.X_WO.p - X_WO.p - trigger.place->center).norm());
  return nearest;
}

}  // namespace

std::vector<std::string> EventWarnings(const Scenario& s, const Pose& X_WO) {
  std::vector<std::string> warnings = EventsAfterTheEnd(s);
  const bool has_place = std::ranges::any_of(
      s.events, [](const EventSpec& event) { return event.trigger.place.has_value(); });
  if (!has_place || s.operator_.type != "virtual") return warnings;
  const Paths paths = TaskPaths(s, X_WO, kPathStep);
  for (std::size_t i = 0; i < s.events.size(); ++i) {
    const TriggerSpec& trigger = s.events[i].trigger;
    if (!trigger.place || trigger.after >= s.duration) continue;
    const double nearest = DistanceFromPlace(trigger, X_WO, paths);
    if (nearest <= trigger.place->radius) continue;
    warnings.push_back(Formatted(
        "events.%zu (%s) may never begin: on the path of the operator's script, the object comes "
        "no nearer than %.3g m to trigger.place.center, but trigger.place.radius is %g m. Give the "
        "centre as an offset from the object's start, in m along the axes of W.",
        i, s.events[i].event.c_str(), nearest, trigger.place->radius));
  }
  return warnings;
}

}  // namespace predictor
