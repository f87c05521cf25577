#include "evaluator/evaluator_process.h"

#include <poll.h>
#include <sys/resource.h>

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

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
  // `heads` and `samples` may be null.
  Evaluator(const Scenario& scenario, const RunBoard& board, const HeadRing* heads,
            const StreamRing* samples, std::span<const tracks::StreamDescription> streams,
            EvaluationBoard* out)
      : person_(scenario, {}, streams),
        records_(&board.records),
        reader_(board.records),
        out_(out) {
    if (heads) heads_.emplace(*heads);
    if (samples) samples_.emplace(*samples);
  }

  // A tick whose head or sample may still arrive stays in the ring, so later calls evaluate it.
  void Look() {
    while (!failed_) {
      TickRecord record;
      if (!next_ && reader_.Next(&record)) next_ = record;
      if (!next_) return;
      TakeHeads();
      TakeSamples();
      if (IsAwaited(next_->wall_ns, NewestTick())) return;
      if (Add(*next_)) out_->states.Publish(person_.state());
      next_.reset();
    }
  }

 private:
  bool IsAwaited(std::uint64_t tick_ns, std::uint64_t newest_ns) {
    return (heads_ && person_.head().IsAwaited(tick_ns, newest_ns)) ||
           (samples_ && person_.streams().IsAwaited(tick_ns, newest_ns));
  }

  void TakeSamples() {
    StreamSample sample;
    for (std::size_t k = 0; samples_ && k < kStreamRing && samples_->Next(&sample); ++k)
      person_.streams().Take(sample, NewestTick());
    for (const std::string& problem : person_.streams().TakeProblems())
      SendLine(kControlDescriptor, {{"say", "A measurement is not used: " + problem}}, false);
  }

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
  std::optional<RingReader<StreamSample, kStreamRing>> samples_;
  std::optional<TickRecord> next_;  // the tick to be evaluated next
  EvaluationBoard* out_;
  bool failed_ = false;
};

Json StartLine(const Scenario& scenario, bool heads, bool samples,
               const std::vector<tracks::StreamDescription>& streams) {
  Json line = RunLine(scenario, Vector3::Zero());
  line["heads"] = heads;
  line["samples"] = samples;
  line["streams"] = Json::array();
  for (const tracks::StreamDescription& stream : streams) line["streams"].push_back(TextOf(stream));
  return line;
}

void Serve(const Json& start) {
  setpriority(PRIO_PROCESS, 0, kPriority);
  Prepare({});  // starts the sandbox before the scenario is parsed
  AttachedRun run(start);
  Shared<EvaluationBoard> states(kMailboxDescriptor, true);
  std::optional<const Shared<RunMailbox>> mailbox;
  if (start["heads"]) mailbox.emplace(kReadDescriptor, false);
  std::optional<const Shared<StreamBoard>> samples;
  if (start["samples"]) samples.emplace(kStreamDescriptor, false);
  std::vector<tracks::StreamDescription> streams;
  for (const Json& text : start["streams"]) streams.push_back(tracks::ParseStream(text));
  Evaluator evaluator(run.scenario, *run.board, mailbox ? &(**mailbox).heads : nullptr,
                      samples ? &(**samples).samples : nullptr, streams, &*states);
  GiveUpRights(start, "The evaluator");
  SendLine(kControlDescriptor, {{"ready", "judges"}}, false);
  while (WaitAWhile()) evaluator.Look();
}

}  // namespace

EvaluatorProcess::EvaluatorProcess(const Scenario& scenario, const Shared<RunBoard>& board,
                                   const Shared<EvaluationBoard>& states,
                                   const Shared<RunMailbox>* mailbox,
                                   const Shared<StreamBoard>* streams,
                                   const std::vector<tracks::StreamDescription>& described,
                                   Notify show)
    : process_({.name = "The evaluator",
                .subcommand = kEvaluatorSubcommand,
                .start = StartLine(scenario, mailbox != nullptr, streams != nullptr, described),
                .board = board.descriptor(),
                .mailbox = states.descriptor(),
                .notify = std::move(show),
                .hear = [](const Json&) {},
                .reads = mailbox ? mailbox->read_only_descriptor() : -1,
                .streams = streams ? streams->read_only_descriptor() : -1}) {}

int EvaluatorMain() { return ChildMain("evaluator", Serve); }

}  // namespace predictor::evaluator
