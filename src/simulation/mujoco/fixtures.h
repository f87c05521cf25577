// Adds the fixed surroundings of the cobot and the object to the scene.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenario/scenario.h"
#include "simulation/mujoco/library.h"

namespace predictor {

inline constexpr const char* kFloorName = "floor";  // of its shape

// Adds floor, table and fixtures to the engine's world.
void AddSurroundings(mjSpec* spec, const EnvironmentSpec& environment);

// Makes fixture number i collide with the named shapes of a body. The body may have its own
// friction.
void AddContacts(mjSpec* spec, const EnvironmentSpec& environment, std::size_t i,
                 const std::vector<std::string>& shapes,
                 const std::optional<double>& friction = std::nullopt);

// Makes two shapes collide with the default properties of a fixture.
void AddContact(mjSpec* spec, const std::string& shape, const std::string& other, double friction);

// Returns the friction of a contact between two bodies, which is the lower of the given values.
double FrictionBetween(const EnvironmentSpec& environment, const std::optional<double>& a,
                       const std::optional<double>& b);

// For each fixture that has a stiffness, sets the stiffness and damping of its contacts in the
// compiled model, and in `spec` for the model's text. The engine's own values are relative to a
// mass that is known only after the model is compiled. `fixture_of` contains the number of the
// fixture of each shape, or −1. Throws InputError if a fixture is too stiff for the simulation's
// step.
void SetStiffness(const EnvironmentSpec& environment, const std::vector<int>& fixture_of,
                  mjSpec* spec, mjModel* model);

// Returns the name of the shape of fixture number i.
std::string FixtureName(std::size_t i);

}  // namespace predictor
