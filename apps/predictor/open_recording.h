// The recording that the program is writing at present, for those who must end the program at once.
#pragma once

#include <functional>
#include <string>

namespace predictor {

// While this object exists, the recording is open. There is at most one.
class OpenRecording {
 public:
  // `close` ends the recording. Another thread calls it, while the control loop is stuck. It is
  // empty if only the control loop can end the recording.
  OpenRecording(const std::string& file, std::function<void()> close);
  ~OpenRecording();
  OpenRecording(const OpenRecording&) = delete;
  OpenRecording& operator=(const OpenRecording&) = delete;

  // Returns how to restore the recording, as a sentence, or "" if none is open. A signal handler
  // may call this.
  static const char* Remedy() noexcept;
  // Ends the recording. Returns false if none is open or nothing can end it.
  static bool Close();
};

}  // namespace predictor
