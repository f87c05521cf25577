// The evaluator alongside a run or a replay.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/shared_run.h"
#include "evaluator/evaluator_process.h"

namespace predictor {

class LiveEvaluation {
 public:
  // Starts the evaluator if the user wants an evaluation and the scenario describes the person
  // sufficiently. If the evaluator cannot start, the run continues. why_not() returns the reason
  // and, if the reason is an error, `show` receives it. `board` is borrowed. So is `mailbox`, which
  // contains the measured heads, or is null in a replay.
  LiveEvaluation(bool wanted, const Scenario& scenario, const Shared<RunBoard>& board,
                 const Shared<RunMailbox>* mailbox,
                 const std::function<void(const std::string&)>& show);

  // Returns null if the person is not judged.
  const Shared<EvaluationBoard>* states() const { return process_ ? &*states_ : nullptr; }
  const EvaluationBoard* board() const { return process_ ? &**states_ : nullptr; }
  const std::string& why_not() const { return why_not_; }

 private:
  std::string why_not_;
  std::optional<const Shared<EvaluationBoard>> states_;
  std::optional<evaluator::EvaluatorProcess> process_;
};

}  // namespace predictor
