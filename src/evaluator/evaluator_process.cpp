#include "evaluator/evaluator_process.h"

#include <poll.h>
#include <sys/resource.h>

#include <optional>
#include <utility>

#include "assessment/live_person.h"
#include "core/error.h"
#include "process/attached_run.h"
#include "process/child.h"

namespace predictor::evaluator {
namespace {

constexpr int kPause = 5;      // pause between two checks of the ring [ms]
constexpr int kPriority = 10;  // niceness: lower priority than the run and the viewer

// Returns false if the run has ended. The end of the run closes the channel.
bool WaitAWhile() {
  pollfd run{kControlDescriptor, POLLIN, 0};
  return poll(&run, 1, kPause) == 0 || (run.revents & (POLLHUP | POLLERR | POLLIN)) == 0;
}

class Evaluator {
 public:
  Evaluator(const Scenario& scenario, const RunBoard& board, EvaluationBoard* out)
      : person_(scenario, {}), reader_(board.records), out_(out) {}

  void Look() {
    for (TickRecord record; !failed_ && reader_.Next(&record);)
      if (Add(record)) out_->states.Publish(person_.state());
  }

 private:
  // A contradiction in the input would persist, so the evaluator reports it once and stops judging.
  bool Add(const TickRecord& record) {
    try {
      return person_.Add(record);
    } catch (const InputError& error) {
      failed_ = true;
      SendLine(kControlDescriptor,
               {{"say", std::string("The person is no longer evaluated: ") + error.what()}}, false);
      return false;
    }
  }

  assessment::LivePerson person_;
  RingReader<TickRecord, kRecordRing> reader_;
  EvaluationBoard* out_;
  bool failed_ = false;
};

void Serve(const Json& start) {
  setpriority(PRIO_PROCESS, 0, kPriority);
  Prepare({});  // starts the sandbox before the scenario is parsed
  AttachedRun run(start);
  Shared<EvaluationBoard> states(kMailboxDescriptor, true);
  Evaluator evaluator(run.scenario, *run.board, &*states);
  GiveUpRights(start, "The evaluator");
  SendLine(kControlDescriptor, {{"ready", "judges"}}, false);
  while (WaitAWhile()) evaluator.Look();
}

}  // namespace

EvaluatorProcess::EvaluatorProcess(const Scenario& scenario, const Shared<RunBoard>& board,
                                   const Shared<EvaluationBoard>& states, Notify show)
    : process_({"The evaluator", kEvaluatorSubcommand, RunLine(scenario, Vector3::Zero()),
                board.descriptor(), states.descriptor(), std::move(show), [](const Json&) {}}) {}

int EvaluatorMain() { return ChildMain("evaluator", Serve); }

}  // namespace predictor::evaluator
