// The fixed surroundings of the cobot and the object.
#pragma once

#include <string>
#include <vector>

#include "scenario/scenario.h"
#include "simulation/mujoco/library.h"

namespace predictor {

// Adds floor, table and fixtures to the engine's world.
void AddSurroundings(mjSpec* spec, const EnvironmentSpec& environment);

// Returns whether a fixture can touch the cobot.
bool TouchesCobot(const EnvironmentSpec& environment);

// Makes fixture number i collide with the named shapes of a body.
void AddContacts(mjSpec* spec, const EnvironmentSpec& environment, std::size_t i,
                 const std::vector<std::string>& shapes);

// Returns the name of the shape of fixture number i.
std::string FixtureName(std::size_t i);

}  // namespace predictor
