// An arm's velocity loop out of what its joints were told and where they went.
//
// The model is that of rig/velocity_loop.h: v'' + 2 ζ ω v' + ω² v = ω² u(t − delay). Positions are
// fitted, because nobody knows how a controller filters the velocities that it reports.
#pragma once

#include <span>
#include <string>

#include "commissioning/loop_record.h"
#include "core/least_squares.h"
#include "scenario/scenario.h"

namespace predictor {

struct LoopFit {
  Estimate bandwidth;  // [Hz]
  Estimate damping_ratio;
  Estimate delay;       // from a command to its effect, as samples show it [s]
  Estimate gain;        // of velocity: 1 in an arm that does as it is told
  double noise = 0;     // of a sample, at rest or by its quantum [rad]
  double residual = 0;  // rms [rad]
  double misfit = 0;    // of the motion, what the model leaves, in the worst quarter second
  Gaps gaps;            // of all records
  VelocityLoopSpec spec() const;
  // Of a slow motion: delay + 2ζ/ω [s].
  double lag() const;
};

// One loop for all records. Throws InputError: too much of the measurement is missing, too little
// motion to tell, or motion that no such loop explains (a hand on the handle, a limit of speed or
// acceleration, or what is missing).
LoopFit FitLoop(std::span<const LoopRecord> records);

std::string LoopText(const LoopFit& fit, const VelocityLoopSpec& before);

}  // namespace predictor
