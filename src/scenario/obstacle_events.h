// Finds the events in which a fixture appears.
#pragma once

#include <cstdint>

#include "scenario/scenario.h"

namespace predictor {

// Returns, as bits, the entries of `events` in which fixture number i appears (obstacle_appears).
// If no such entry exists, the fixture is always present. If such entries exist, the fixture is
// present only while one of them is active.
std::uint16_t EventsOfFixture(const Scenario& scenario, std::size_t i);

}  // namespace predictor
