// Finds the events in which a fixture appears.
#pragma once

#include <cstdint>

#include "scenario/scenario.h"

namespace predictor {

// Returns the entries of `events` in which fixture number i appears (obstacle_appears), as bits. If
// there are none, the fixture is always present. Otherwise the fixture is present only while one of
// them is active.
std::uint16_t EventsOfFixture(const Scenario& scenario, std::size_t i);

}  // namespace predictor
