// Where an object ends that nothing holds: contacts may be missing, but no fall is endless.
#pragma once

#include "core/messages.h"
#include "models/object_model.h"

namespace predictor {

// Wrench about the centre of mass, in axes of W [N, N·m], that brings a falling object softly to
// rest when its centre of mass is below `height` [m]; zero above it.
Wrench LandingWrench(const ObjectModel& object, const FrameMotion& O, double height) noexcept;

// The height for an object that breaks loose with its centre of mass at `height` [m]: the floor,
// z = 0, or one metre further down if it is already below the floor.
inline double LandingHeight(double height) noexcept { return height > 0 ? 0 : height - 1; }

}  // namespace predictor
