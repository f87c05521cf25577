#include "evaluator/evaluator_process.h"

#include <poll.h>
#include <sys/resource.h>

#include <algorithm>
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
  // `heads` may be null.
  Evaluator(const Scenario& scenario, const RunBoard& board, const HeadRing* heads,
            EvaluationBoard* out)
      : person_(scenario, {}), records_(&board.records), reader_(board.records), out_(out) {
    if (heads) heads_.emplace(*heads);
  }

  // A tick whose head may still arrive stays in the ring, so later calls evaluate it.
  void Look() {
    while (!failed_) {
      TickRecord record;
      if (!next_ && reader_.Next(&record)) next_ = record;
      if (!next_) return;
      TakeHeads();
      if (heads_ && person_.head().IsAwaited(next_->wall_ns, NewestTick())) return;
      if (Add(*next_)) out_->states.Publish(person_.state());
      next_.reset();
    }
  }

 private:
  void TakeHeads() {
    HeadRecord head;
    for (std::size_t k = 0; heads_ && k < kHeadRing && heads_->Next(&head); ++k)
      person_.head().Take(head, NewestTick());
  }

  // Returns the monotonic clock at the newest tick [ns], which is at least that of the next tick.
  std::uint64_t NewestTick() const {
    TickRecord newest;
    const std::uint64_t written = records_->written();
    if (written == 0 || !records_->Get(written - 1, &newest)) newest = *next_;
    return std::max(newest.wall_ns, next_->wall_ns);
  }

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
  const RecordRing* records_;
  RingReader<TickRecord, kRecordRing> reader_;
  std::optional<RingReader<HeadRecord, kHeadRing>> heads_;
  std::optional<TickRecord> next_;  // the tick to be evaluated next
  EvaluationBoard* out_;
  bool failed_ = false;
};

Json StartLine(const Scenario& scenario, bool heads) {
  Json line = RunLine(scenario, Vector3::Zero());
  line["heads"] = heads;
  return line;
}

void Serve(const Json& start) {
  setpriority(PRIO_PROCESS, 0, kPriority);
  Prepare({});  // starts the sandbox before the scenario is parsed
  AttachedRun run(start);
  Shared<EvaluationBoard> states(kMailboxDescriptor, true);
  std::optional<const Shared<RunMailbox>> mailbox;
  if (start["heads"]) mailbox.emplace(kReadDescriptor, false);
  Evaluator evaluator(run.scenario, *run.board, mailbox ? &(**mailbox).heads : nullptr, &*states);
  GiveUpRights(start, "The evaluator");
  SendLine(kControlDescriptor, {{"ready", "judges"}}, false);
  while (WaitAWhile()) evaluator.Look();
}

}  // namespace

EvaluatorProcess::EvaluatorProcess(const Scenario& scenario, const Shared<RunBoard>& board,
                                   const Shared<EvaluationBoard>& states,
                                   const Shared<RunMailbox>* mailbox, Notify show)
    : process_({.name = "The evaluator",
                .subcommand = kEvaluatorSubcommand,
                .start = StartLine(scenario, mailbox != nullptr),
                .board = board.descriptor(),
                .mailbox = states.descriptor(),
                .notify = std::move(show),
                .hear = [](const Json&) {},
                .reads = mailbox ? mailbox->read_only_descriptor() : -1}) {}

int EvaluatorMain() { return ChildMain("evaluator", Serve); }

}  // namespace predictor::evaluator
