// The movable objects of the surroundings (environment.objects): free rigid bodies.
#pragma once

#include <string>
#include <vector>

#include "models/object_model.h"
#include "scenario/scenario.h"
#include "simulation/mujoco/library.h"
#include "simulation/mujoco/scene.h"

namespace predictor {

using MovableModels = std::vector<ObjectModel>;

// Loads their models. Throws InputError.
MovableModels LoadMovables(const Scenario& scenario);

// Adds their bodies to the engine's world. Call it after all other bodies have been added, so that
// their coordinates are the last ones. Throws InputError.
void AddMovables(mjSpec* spec, const EnvironmentSpec& environment, const MovableModels& models);

// Makes them collide with floor, table, fixtures and one another, and with the named shapes of the
// object and the cobot as far as they touch them. Throws InputError.
void AddMovableContacts(mjSpec* spec, const EnvironmentSpec& environment,
                        const MovableModels& models, const std::vector<std::string>& object,
                        const std::vector<std::string>& cobot);

// Call this after the engine has rejected the whole model. Throws InputError if it rejects one of
// their meshes alone.
void CheckMeshes(const MovableModels& models);

// Finds `count` objects in the compiled model.
void FindMovables(std::size_t count, Scene* scene);

// Lets them touch other bodies, or nothing at all.
void SetMovablesTouch(const Scene& scene, bool touch) noexcept;
bool MovablesTouch(const Scene& scene) noexcept;

// Returns the motion of all of them. The twist follows from the state alone.
Movables MotionOfMovables(const Scene& scene, const mjData& data) noexcept;

// Ends the fall of those that fell below the scene. Otherwise, their speed would increase without
// limit.
void EndFalls(const Scene& scene, mjData* data) noexcept;

}  // namespace predictor
