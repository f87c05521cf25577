// The process that receives streams of the Lab Streaming Layer alongside a run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "tracks/stream_track.h"

namespace predictor::lab_streams {

// The internal subcommand that runs this program as the receiver. Only StreamProcess uses it.
inline constexpr const char* kStreamSubcommand = "stream-process";
int StreamMain();

struct StreamOptions {
  // Names or types of streams, or files with a mapping (.yaml, see tracks::StreamMap).
  std::vector<std::string> streams;
  std::string library;  // file of liblsl; "": where the system looks for libraries
};

class StreamProcess {
 public:
  // Shows a message to the user. A separate thread calls this callback.
  using Notify = std::function<void(const std::string& text)>;

  // Starts the process and waits until it receives from all streams. The process writes the samples
  // to `board`, which the caller continues to own. It needs the network and threads, so unlike the
  // other processes alongside the run it is not in a sandbox, but it has no rights of root, and it
  // cannot write files. If it ends unexpectedly, a message reports this, and it is restarted.
  //
  // Throws InputError if a mapping is wrong or does not fit its stream, if there is no such stream,
  // or if the library cannot be loaded. Throws std::runtime_error if no process can be started.
  StreamProcess(const StreamOptions& options, const Shared<StreamBoard>& board, Notify show);

  // The streams, in the order of StreamSample::stream.
  const std::vector<tracks::StreamDescription>& streams() const { return streams_; }
  int pid() const { return process_->pid(); }  // 0 while no process is running

 private:
  std::vector<tracks::StreamDescription> streams_;
  std::unique_ptr<SupervisedProcess> process_;
};

}  // namespace predictor::lab_streams
