// What surrounds the cobot and the object, and never moves.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"
#include "simulation/mujoco/library.h"

namespace predictor {

// Adds floor, table and fixtures to the engine's world.
void AddSurroundings(mjSpec* spec, const EnvironmentSpec& environment);

// Whether a fixture touches the cobot.
bool TouchesCobot(const EnvironmentSpec& environment);

// Lets fixture number i and shapes of a body, by their names, collide.
void AddContacts(mjSpec* spec, const EnvironmentSpec& environment, std::size_t i,
                 const std::vector<std::string>& shapes);

// Name of the shape of fixture number i.
std::string FixtureName(std::size_t i);

}  // namespace predictor
