// Ends the fall of an object that nothing holds. Otherwise, the object could fall without end in a
// scene without contacts.
#pragma once

#include "core/messages.h"
#include "models/object_model.h"

namespace predictor {

// Returns the wrench about the centre of mass, in axes of W [N, N·m], that brings a falling object
// softly to rest when its centre of mass is below `height` [m]. Above this height, the wrench is
// zero.
Wrench LandingWrench(const ObjectModel& object, const FrameMotion& O, double height) noexcept;

// Returns the height for an object that breaks loose with its centre of mass at `height` [m]. This
// is the height of the floor, z = 0. If the object is already below the floor, it is one metre
// below the object.
inline double LandingHeight(double height) noexcept { return height > 0 ? 0 : height - 1; }

}  // namespace predictor
