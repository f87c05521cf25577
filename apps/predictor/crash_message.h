// Prints a message if the program crashes.
#pragma once

namespace predictor {

// From now on, a crash (an invalid access to memory, a division by zero, an abort) prints a message
// first. The message names the controller's library if this library crashed, and explains how to
// restore an open recording. The crash then has its usual effect: the exit status names the signal,
// and a core dump shows where it occurred. Sanitizers have their own messages, so this has no
// effect with them.
void PrintMessageOnCrash();

}  // namespace predictor
