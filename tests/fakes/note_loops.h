// Marks the velocity loops of a machine as measured, as `predictor calibrate loop` does.
#pragma once

#include "scenario/machine.h"

namespace predictor {

inline void NoteLoops(Machine* machine) {
  for (std::optional<MachineArm>* arm : {&machine->left, &machine->right}) {
    if (!*arm) continue;
    if (!(*arm)->commissioned) (*arm)->commissioned.emplace();
    (*arm)->commissioned->loop = "2026-01-02T03-04-05";
    (*arm)->commissioned->loop_of = HashOfLoop(**arm);
  }
}

}  // namespace predictor
