// The control program of ur_rtde (SDU Robotics, https://gitlab.com/sdurobotics/ur_rtde), of which
// URScript here knows too little: recognised by its name and its register offset, and played by its
// protocol. Integer register 0 holds a command, answered in output register 0: ready, done.
#pragma once

#include <memory>

#include "fakes/ur/ur_controller.h"

namespace predictor {

// nullptr: the text is another program.
std::unique_ptr<UrProgram> RecogniseUrRtde(const std::string& text, UrController* controller);

}  // namespace predictor
