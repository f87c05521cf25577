// How fast a limit may be approached.
#pragma once

namespace predictor {

// Largest speed [1/s] at which a distance [·] may shrink so that it never falls below zero when
// deceleration is at most `acceleration`: proportional near zero (velocity damper, slope
// `gain` [1/s]), a parabola beyond, joined smoothly; zero where the distance is negative.
double ApproachSpeed(double distance, double gain, double acceleration) noexcept;

}  // namespace predictor
