// Identifies an arm's velocity loop from the commands to its joints and their motion.
//
// The model is the same as in rig/velocity_loop.h: v'' + 2 ζ ω v' + ω² v = ω² u(t − delay).
// Positions are fitted, because it is not known how a controller filters the velocities that it
// reports.
#pragma once

#include <span>
#include <string>

#include "commissioning/loop_record.h"
#include "core/least_squares.h"
#include "scenario/scenario.h"

namespace predictor::commissioning {

struct LoopFit {
  Estimate bandwidth;  // [Hz]
  Estimate damping_ratio;
  Estimate delay;       // delay from a command to its effect in the samples [s]
  Estimate gain;        // ratio of the arm's velocity to the command: 1 if the arm follows exactly
  double noise = 0;     // noise of a sample: noise at rest, or resolution [rad]
  double residual = 0;  // rms [rad]
  double misfit = 0;    // unexplained share of the motion in the worst quarter of a second
  Gaps gaps;            // gaps of all records
  VelocityLoopSpec spec() const;
  // Returns the lag of slow motion, delay + 2ζ/ω [s].
  double lag() const;
};

// Fits one loop to all records. Throws InputError if too much of the measurement is missing, if
// there is too little motion, or if no such loop explains the motion. Possible reasons for
// unexplained motion are a hand on the handle, a limit of speed or acceleration, and missing
// samples.
LoopFit FitLoop(std::span<const LoopRecord> records);

std::string LoopText(const LoopFit& fit, const VelocityLoopSpec& before);

}  // namespace predictor::commissioning
