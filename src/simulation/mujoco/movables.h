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

// Adds the bodies of the movable objects to the engine's world. Call this function after all other
// bodies have been added, so that the coordinates of the movable objects are the last ones. Throws
// InputError.
void AddMovables(mjSpec* spec, const EnvironmentSpec& environment, const MovableModels& models);

// Makes the movable objects collide with the floor, the table, the fixtures and one another. They
// also collide with the named shapes of the object and the cobot, if the scenario lets them touch
// these. Throws InputError.
void AddMovableContacts(mjSpec* spec, const EnvironmentSpec& environment,
                        const MovableModels& models, const std::vector<std::string>& object,
                        const std::vector<std::string>& cobot);

// Call this function after the engine has rejected the whole model. Throws InputError if the engine
// rejects the mesh of a movable object alone.
void CheckMeshes(const MovableModels& models);

// Finds the `count` movable objects in the compiled model.
void FindMovables(std::size_t count, Scene* scene);

// Determines whether the movable objects touch other bodies or nothing at all.
void SetMovablesTouch(const Scene& scene, bool touch) noexcept;
bool MovablesTouch(const Scene& scene) noexcept;

// See Engine::SetHeldMovable and Engine::GapTo.
void LetPass(const Scene& scene, int movable) noexcept;
double GapBetween(const Scene& scene, mjData* data, int movable, double most) noexcept;

// Returns the motion of all movable objects. The twist follows from the state alone.
Movables MotionOfMovables(const Scene& scene, const mjData& data) noexcept;

// Ends the fall of movable objects that fell below the scene. Otherwise, their speed would increase
// without limit.
void EndFalls(const Scene& scene, mjData* data) noexcept;

}  // namespace predictor
