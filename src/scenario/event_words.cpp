#include "scenario/event_words.h"

#include <vector>

#include "core/format.h"
#include "core/text.h"

namespace predictor {

std::string TriggerWords(const TriggerSpec& trigger) {
  std::vector<std::string> conditions;
  if (trigger.place) {
    const Vector3& at = trigger.place->center;
    conditions.push_back(Formatted("the object is within %g m of (%g, %g, %g) m from its start",
                                   trigger.place->radius, at.x(), at.y(), at.z()));
  }
  if (trigger.force) conditions.push_back(Formatted("a hand's force exceeds %g N", *trigger.force));
  if (trigger.gripping) conditions.emplace_back("every hand grips");

  std::string text;
  const double last = trigger.after + trigger.window;
  if (trigger.window > 0)
    text = Formatted("at a random time between %g and %g s", trigger.after, last);
  else if (trigger.after > 0 || conditions.empty())
    text = Formatted("at %g s", trigger.after);
  if (conditions.empty()) return text;
  if (!text.empty()) text += " or later, ";
  return text + "when " + Join(conditions, " and ");
}

std::vector<std::string> EventsAfterTheEnd(const Scenario& scenario) {
  std::vector<std::string> sentences;
  if (scenario.duration == 0) return sentences;  // a person ends the run
  for (std::size_t i = 0; i < scenario.events.size(); ++i) {
    const EventSpec& event = scenario.events[i];
    if (event.trigger.after < scenario.duration) continue;
    sentences.push_back(Formatted(
        "events.%zu (%s) never begins: its trigger.after is %g s, but the run ends at %g s. Reduce "
        "it, or increase duration.",
        i, event.event.c_str(), event.trigger.after, scenario.duration));
  }
  return sentences;
}

}  // namespace predictor
