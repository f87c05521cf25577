// The recording that the program is writing at present, for code that must end the program at once.
#pragma once

#include <functional>
#include <string>

namespace predictor {

// While this object exists, the recording is open. At most one recording is open at a time.
class OpenRecording {
 public:
  // `close` ends the recording. Another thread calls `close` while the control loop is stuck.
  // The function `close` is empty if only the control loop can end the recording.
  OpenRecording(const std::string& file, std::function<void()> close);
  ~OpenRecording();
  OpenRecording(const OpenRecording&) = delete;
  OpenRecording& operator=(const OpenRecording&) = delete;

  // Returns a sentence that explains how to restore the recording, or "" if no recording is open. A
  // signal handler may call this function.
  static const char* Remedy() noexcept;
  // Ends the recording. Returns false if no recording is open or if the recording cannot be ended.
  static bool Close();
};

}  // namespace predictor
