// Landlock permanently restricts what a process may access in the file system and on the network.
#pragma once

#include "process/sandbox.h"

namespace predictor {

// Allows only what `may` lists; everything else that this kernel's Landlock can refuse is refused.
// Returns false if the kernel has no Landlock.
bool EnterLandlock(const Preparation& may);

}  // namespace predictor
