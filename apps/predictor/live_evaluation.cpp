#include "live_evaluation.h"

#include <exception>

#include "assessment/live_streams.h"
#include "assessment/person_setup.h"
#include "core/text.h"

namespace predictor {

PersonStreams::PersonStreams(const lab_streams::StreamOptions& options,
                             const std::function<void(const std::string&)>& show)
    : process(options, board, show) {
  // The evaluator could only refuse them after the start of the run.
  const assessment::LiveStreams checked(process.streams());
}

std::vector<std::string> PersonStreams::Texts() const {
  std::vector<std::string> texts;
  for (const tracks::StreamDescription& stream : process.streams()) texts.push_back(TextOf(stream));
  return texts;
}

LiveEvaluation::LiveEvaluation(bool wanted, const Scenario& scenario, const Shared<RunBoard>& board,
                               const Shared<RunMailbox>* mailbox, const PersonStreams* streams,
                               const std::function<void(const std::string&)>& show) {
  if (!wanted) {
    why_not_ = "The evaluation of the person was switched off with --no-evaluation.";
    return;
  }
  if (const auto missing = assessment::MissingForPosture(scenario); !missing.empty()) {
    why_not_ = Join(missing, " ");
    return;
  }
  try {
    states_.emplace();
    process_.emplace(
        scenario, board, *states_, mailbox, streams ? &streams->board : nullptr,
        streams ? streams->process.streams() : std::vector<tracks::StreamDescription>{}, show);
  } catch (const std::exception& error) {
    why_not_ = std::string("The person is not evaluated: ") + error.what();
    show(why_not_);
  }
}

}  // namespace predictor
