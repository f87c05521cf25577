// The control program of ur_rtde (SDU Robotics, https://gitlab.com/sdurobotics/ur_rtde). The
// program needs more URScript than this fake supports. The fake therefore recognises the program by
// its name and its register offset, and implements the program's protocol natively. Integer
// register 0 contains a command, and output register 0 contains the answer (ready, done).
#pragma once

#include <memory>

#include "fakes/ur/ur_controller.h"

namespace predictor {

// Returns nullptr if the text is not ur_rtde's program.
std::unique_ptr<UrProgram> RecogniseUrRtde(const std::string& text, UrController* controller);

}  // namespace predictor
