// Contains the numbers printed in the paper, and none of our results.
#pragma once

#include <array>

#include "analysis/reproduce/reproduce.h"

namespace predictor {

// The tracking errors of a scenario, section 4.1.1: [mm] and [°].
struct PaperTracking {
  std::array<PrintedValue, 2> translation, rotation;  // left and right handle
  PrintedValue distance, angle;                       // relative pose of the handles
};
inline constexpr PaperTracking kPaperBox9 = {
    {{{4.1, 3.8}, {3.9, 3.8}}}, {{{0.8, 0.6}, {1.1, 0.6}}}, {1.9, 1.8}, {0.6, 0.3}};
inline constexpr PaperTracking kPaperBox18 = {
    {{{4.4, 1.9}, {4.1, 1.9}}}, {{{0.8, 0.4}, {0.7, 0.4}}}, {1.0, 0.9}, {0.2, 0.2}};

// The delay of the QP, section 4.2.2 [ms].
inline constexpr PrintedValue kPaperDelay = {10, 1, 0};

// The times of the snapshots in Figs 5 and 6 [s].
inline constexpr std::array<double, 3> kPaperMoments9 = {5, 18, 28};
inline constexpr std::array<double, 3> kPaperMoments18 = {5, 22, 29};

}  // namespace predictor
