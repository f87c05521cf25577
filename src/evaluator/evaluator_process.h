// The evaluator is a process that runs alongside the run and judges the person during the run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "scenario/scenario.h"
#include "tracks/stream_track.h"

namespace predictor::evaluator {

// The internal subcommand that runs this program as the evaluator. Only EvaluatorProcess uses it.
inline constexpr const char* kEvaluatorSubcommand = "evaluator-process";
int EvaluatorMain();

class EvaluatorProcess {
 public:
  // Shows a message to the user. A separate thread calls this callback.
  using Notify = std::function<void(const std::string& text)>;

  // Starts the evaluator and waits until it follows `board`. The evaluator writes its states to
  // `states` and is not permitted to do anything else. The evaluator runs at a lower priority than
  // the run's threads, and the run never waits for the evaluator. If the evaluator ends
  // unexpectedly, a message reports this, and the evaluator is restarted. Damage and fatigue then
  // start from zero again. The caller continues to own the descriptors of `board`, `states` and
  // `mailbox` and `streams`. The evaluator reads the measured heads in `mailbox`, which is null if
  // no head of this person can be measured, for instance in a replay, and the samples of `streams`,
  // which is null if no other system measures. `described` are these streams. Throws InputError if
  // the body or the stance is missing or impossible. Throws std::runtime_error if no process can be
  // started.
  EvaluatorProcess(const Scenario& scenario, const Shared<RunBoard>& board,
                   const Shared<EvaluationBoard>& states, const Shared<RunMailbox>* mailbox,
                   const Shared<StreamBoard>* streams,
                   const std::vector<tracks::StreamDescription>& described, Notify show);
  int pid() const { return process_.pid(); }  // 0 while no process is running

 private:
  SupervisedProcess process_;
};

}  // namespace predictor::evaluator
