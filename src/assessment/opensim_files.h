// Writes an evaluated run as files for OpenSim: the scaled body, its motion, and the forces of the
// handles.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assessment/hand_samples.h"
#include "assessment/person_setup.h"
#include "person/body_loads.h"

namespace predictor::assessment {

struct NamedFile {
  std::string name, text;
};

// The nominal person of a run, over its longest part without interruption. Throws InputError if
// this part has fewer than ten samples.
//
// person.osim: model (OpenSimModelOf); motion.mot: coordinates [rad, m]; hand_loads.sto: forces
// [N], torques [N·m] and points [m] of the handles' action on the hands; hand_loads.xml: the bodies
// on which they act; inverse_dynamics.xml: set-up of OpenSim's tool; torques.sto: our joint
// torques, with the names that this tool uses. All times are times of the recording.
//
// The torques include the effect of the trunk's acceleration, which OpenSim computes from the
// coordinates. The evaluation neglects this acceleration (RunNominal).
std::vector<NamedFile> OpenSimFiles(const PersonSetup& setup,
                                    std::span<const PersonSample> samples);

}  // namespace predictor::assessment
