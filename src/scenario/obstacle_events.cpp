#include "scenario/obstacle_events.h"

#include <string>

namespace predictor {

std::uint16_t EventsOfFixture(const Scenario& scenario, std::size_t i) {
  const std::string& name = scenario.environment.fixtures[i].name;
  unsigned bits = 0;
  for (std::size_t e = 0; e < scenario.events.size(); ++e) {
    const EventSpec& event = scenario.events[e];
    const YamlNode* fixture = event.parameters.Find("fixture");
    if (event.event == "obstacle_appears" && fixture && fixture->text == name) bits |= 1U << e;
  }
  return static_cast<std::uint16_t>(bits);
}

}  // namespace predictor
