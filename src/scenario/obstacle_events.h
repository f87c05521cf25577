// Which events let a fixture appear.
#pragma once

#include <cstdint>

#include "scenario/scenario.h"

namespace predictor {

// Bits: the entries of `events` that let fixture number i appear (obstacle_appears). 0: the fixture
// is always there. Otherwise it is there only while one of them acts.
std::uint16_t EventsOfFixture(const Scenario& scenario, std::size_t i);

}  // namespace predictor
