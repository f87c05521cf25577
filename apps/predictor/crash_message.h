// Prints a message if the program crashes.
#pragma once

namespace predictor {

// After this call, a crash (an invalid access to memory, a division by zero, an abort) prints a
// message first. The message names the controller's library if this library crashed, and explains
// how to restore an open recording. The crash then has its usual effect: the exit status names the
// signal, and a core dump shows where it occurred. Sanitizers print their own messages, so this
// function has no effect in builds with a sanitizer.
void PrintMessageOnCrash();

}  // namespace predictor
