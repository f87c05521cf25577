// Checks that the bodies which a scenario lets collide have collision shapes.
#pragma once

#include <cstddef>

#include "scenario/scenario.h"

namespace predictor {

enum class Toucher { kObject, kCobot };  // the words of `touches`

// Throws InputError if the scenario lets a fixture or a movable object touch the carried object or
// the cobot, but this body has no collision shape, so that nothing would ever touch. `shapes` is
// the number of its collision shapes.
void RequireShapes(const Scenario& scenario, Toucher toucher, std::size_t shapes);

// Throws InputError if cobot.touches lets bodies collide that have no collision shapes. `cobot` and
// `object` state whether the cobot and the carried object have some.
void RequireShapesOfCobotTouches(const Scenario& scenario, bool cobot, bool object);

// Throws InputError if a word of cobot.touches has no effect. `cobot` and `object` state whether
// some link can touch another link and the carried object.
void RequirePairsOfCobotTouches(const Scenario& scenario, bool cobot, bool object);

}  // namespace predictor
