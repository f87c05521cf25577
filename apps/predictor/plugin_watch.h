// Ends the program if a controller's library does not return.
#pragma once

namespace predictor {

// A thread watches the calls into libraries from the time at which the first one is loaded. If a
// function does not return, the thread prints a message, ends the recording and exits with
// kDeviceFailure. By then, the watchdog process has already stopped real arms.
void WatchPlugins();

// From now on, the loop runs in real time, so the library's functions in the loop must return
// sooner.
void ExpectPromptPlugins() noexcept;

}  // namespace predictor
