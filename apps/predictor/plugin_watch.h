// Ends the program if a controller's library does not return.
#pragma once

namespace predictor {

// A thread watches the calls into libraries from the time at which the first one is loaded. If a
// function does not return, the thread prints a message, ends the recording and exits with
// kDeviceFailure. The watchdog process has stopped real arms long before.
void WatchPlugins();

// The loop runs in real time from now on: the functions in it then have less time.
void ExpectPromptPlugins() noexcept;

}  // namespace predictor
