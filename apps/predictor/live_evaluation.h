// The evaluator alongside a run or a replay.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/shared_run.h"
#include "evaluator/evaluator_process.h"
#include "lab_streams/stream_process.h"

namespace predictor {

// The streams of other systems that measure the person during a run.
struct PersonStreams {
  // Throws InputError if a stream cannot be received, or if two streams measure the same.
  PersonStreams(const lab_streams::StreamOptions& options,
                const std::function<void(const std::string&)>& show);

  // The descriptions of the streams, for the recording.
  std::vector<std::string> Texts() const;

  Shared<StreamBoard> board;
  lab_streams::StreamProcess process;
};

class LiveEvaluation {
 public:
  // Starts the evaluator if the user wants an evaluation and the scenario describes the person
  // sufficiently. If the evaluator cannot start, the run continues. why_not() returns the reason
  // and, if the reason is an error, `show` receives it. `board` is borrowed. So is `mailbox`, which
  // contains the measured heads, or is null in a replay, and `streams`, which measure the person,
  // or is null.
  LiveEvaluation(bool wanted, const Scenario& scenario, const Shared<RunBoard>& board,
                 const Shared<RunMailbox>* mailbox, const PersonStreams* streams,
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
