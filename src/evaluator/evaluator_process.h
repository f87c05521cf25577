// The evaluator is a process that runs alongside the run and judges the person during the run.
#pragma once

#include <functional>
#include <string>

#include "core/shared_run.h"
#include "process/supervised_process.h"
#include "scenario/scenario.h"

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
  // `mailbox`. The evaluator reads the measured heads in `mailbox`, which is null if no head of
  // this person can be measured, for instance in a replay. Throws InputError if the body or the
  // stance is missing or impossible. Throws std::runtime_error if no process can be started.
  EvaluatorProcess(const Scenario& scenario, const Shared<RunBoard>& board,
                   const Shared<EvaluationBoard>& states, const Shared<RunMailbox>* mailbox,
                   Notify show);
  int pid() const { return process_.pid(); }  // 0 while no process is running

 private:
  SupervisedProcess process_;
};

}  // namespace predictor::evaluator
