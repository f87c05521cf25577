#include "recorded_run.h"

#include <cmath>
#include <ctime>
#include <future>
#include <system_error>

#include "core/error.h"
#include "core/format.h"
#include "core/text.h"
#include "progress.h"
#include "recording/provenance.h"
#include "recording/scene.h"
#include "report.h"
#include "scenario/participant.h"
#include "screen.h"
#include "simulation/engine_version.h"

namespace predictor {
namespace {

constexpr double kSnapshotTime = 10;  // time between saved states [s]

RecorderOptions Options(const EvaluationBoard* person = nullptr, const HeadRing* heads = nullptr,
                        const PersonStreams* streams = nullptr) {
  RecorderOptions options;
  if (streams) {
    options.samples = &(*streams->board).samples;
    options.streams = streams->Texts();
  }
  options.person = person;
  options.heads = heads;
  options.snapshot_bytes = kStateBytes;
  options.notify = [](const std::string& text) { TheScreen().Print(text); };
  return options;
}

std::vector<JsonChannel> ChannelsOf(const Emulator& emulator, const EvaluationBoard* person,
                                    const PersonStreams* streams) {
  auto channels = RecordedScene(emulator.scenario(), emulator.setup().object_start);
  channels.push_back(HeadChannel());
  if (person) channels.push_back(PersonChannel());
  if (streams) {
    channels.push_back(StreamsChannel());
    channels.push_back(SamplesChannel());
  }
  return channels;
}

}  // namespace

std::map<std::string, std::string> RecordOptions::Labels() const {
  std::map<std::string, std::string> result;
  if (!participant.empty()) result = LabelsOf(LoadParticipant(participant));
  for (const std::string& label : labels) {
    const std::size_t equals = label.find('=');
    if (equals == 0 || equals == std::string::npos)
      throw InputError("--label: " + Quote(label) + " is not a label. Write key=value.");
    const std::string key = label.substr(0, equals);
    if (IsParticipantLabel(key))
      throw InputError("--label: " + Quote(key) +
                       " belongs to the data of the participant, which the program checks first. "
                       "Write these data into a file, and give the file with --participant.");
    result[key] = label.substr(equals + 1);
  }
  return result;
}

RecordingHeader HeaderOf(const Emulator& emulator, const RecordOptions& options) {
  RecordingHeader header = DescribeRun(emulator.scenario(), PREDICTOR_VERSION, options.Labels());
  header.engine = EngineVersion(emulator.scenario().simulation.engine);
  header.machine_yaml = options.machine;
  header.loop = PredictedLoopOf(emulator);
  AddControllerTape(emulator.setup().controller_tape, &header);
  return header;
}

std::string NewRecordingName(const Scenario& scenario) {
  std::error_code error;
  std::filesystem::create_directories("runs", error);
  if (error)
    throw InputError("runs", "The folder for recordings could not be created: " + error.message() +
                                 ". Run the program in a writable folder, give a file with "
                                 "--record, or use --no-record.");
  const std::string stem = "runs/" + scenario.file.stem().string() + "_" +
                           LocalTime("%Y-%m-%d_%H-%M-%S", std::time(nullptr));
  std::string name = stem + ".mcap";
  for (int k = 2; std::filesystem::exists(name); ++k)
    name = stem + "_" + std::to_string(k) + ".mcap";
  return name;
}

void ReadTicks(RecordingReader* reader, const std::string& title, bool quiet,
               const std::function<void(const TickRecord&)>& add) {
  constexpr std::size_t kBatch = 1024;
  const auto read = [reader] {
    std::vector<TickRecord> batch(kBatch);
    std::size_t count = 0;
    while (count < kBatch && reader->Next(&batch[count])) ++count;
    batch.resize(count);
    return batch;
  };
  Progress progress(title, static_cast<double>(reader->count()), quiet);
  std::size_t done = 0;
  auto next = std::async(std::launch::async, read);
  for (auto batch = next.get(); !batch.empty(); batch = next.get()) {
    next = std::async(std::launch::async, read);
    for (const TickRecord& record : batch) add(record);
    done += batch.size();
    progress.Update(static_cast<double>(done));
  }
}

VirtualRecording::VirtualRecording(Emulator* emulator, const RecordOptions& options)
    : emulator_(emulator),
      file_(options.file),
      writer_(file_, HeaderOf(*emulator, options),
              RecordedScene(emulator->scenario(), emulator->setup().object_start), nullptr,
              Options()),
      snapshot_ticks_(static_cast<std::uint64_t>(std::lround(kSnapshotTime / emulator->dt()))),
      state_(kStateBytes),
      open_(std::in_place, file_, nullptr) {}

void VirtualRecording::Add(const TickRecord& record) {
  writer_.Add(record);
  if (record.tick % snapshot_ticks_ != 0) return;
  const std::size_t size = emulator_->SaveState(state_);
  writer_.AddSnapshot(record.tick, std::span(state_).first(size));
}

void VirtualRecording::Close() {
  writer_.Close();
  open_.reset();
}

std::string VirtualRecording::Summary() const {
  return Formatted("Recorded %s: %llu ticks, %.1f MB.", file_.c_str(),
                   static_cast<unsigned long long>(writer_.ticks()),
                   1e-6 * static_cast<double>(writer_.bytes()));
}

RunRecording::RunRecording(const Emulator& emulator, const RecordOptions& options, RunBoard* board,
                           const EvaluationBoard* person, const HeadRing& heads,
                           const PersonStreams* streams)
    : board_(board),
      file_(options.file.empty() ? NewRecordingName(emulator.scenario()) : options.file),
      recorder_(file_, HeaderOf(emulator, options), board->records,
                Options(person, &heads, streams), ChannelsOf(emulator, person, streams)),
      open_(std::in_place, file_, [this] { Close(false, false); }) {
  Look();
}

void RunRecording::Look() {
  board_->recording.store(recorder_.status().recording ? 1 : 0, std::memory_order_relaxed);
}

bool RunRecording::Close(bool quiet, bool has_report) {
  recorder_.Close();
  open_.reset();
  const RecorderStatus status = recorder_.status();
  board_->recording.store(0, std::memory_order_relaxed);
  const bool whole = status.ended_why.empty() && status.lost == 0;
  if (quiet && whole) return true;
  Screen& screen = TheScreen();
  screen.Print(Formatted("Recorded %s: %llu ticks, %.1f MB%s", file_.c_str(),
                         static_cast<unsigned long long>(status.ticks),
                         1e-6 * static_cast<double>(status.bytes),
                         whole ? "." : ", NOT the whole run:"));
  if (status.lost > 0)
    screen.Print(Formatted("%llu ticks could not be written in time. The recording marks the gaps.",
                           static_cast<unsigned long long>(status.lost)));
  if (!status.ended_why.empty()) screen.Print(status.ended_why);
  if (!quiet && whole && !has_report)
    screen.Print("To make a report, run: predictor report " + file_);
  return status.ended_why.empty();
}

}  // namespace predictor
