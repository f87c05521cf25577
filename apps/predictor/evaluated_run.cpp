#include "evaluated_run.h"

#include <memory>
#include <span>
#include <utility>

#include "assessment/measured_head.h"
#include "core/error.h"
#include "core/format.h"
#include "models/object_model.h"
#include "models/robot.h"
#include "models/urdf.h"
#include "progress.h"
#include "recorded_run.h"
#include "recording/reader.h"
#include "restored_scenario.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"
#include "screen.h"

namespace predictor {
namespace {

// What the recorded models of the virtual scene contain.
struct RecordedScene {
  std::optional<assessment::SceneMasses> masses;  // empty: not known
  std::vector<OutlinePoint> outline;              // of the object; empty: not known
  std::shared_ptr<const RobotModel> cobot;        // null: not known
};

// Returns nothing known if the recorded models cannot be read, and prints the reason.
RecordedScene SceneOf(const RecordingHeader& header) {
  try {
    const RestoredScenario restored(header);
    const Scenario& scenario = restored.Get();
    const CobotSpec& cobot = scenario.cobot;
    const UrdfModel urdf = ReadUrdf(ResolveModelPath(cobot.model, scenario.folder()),
                                    cobot.remove_links, scenario.folder());
    const ObjectModel object = LoadObject(scenario.object, scenario.folder());
    return {assessment::SceneMasses{.cobot = urdf.MovingMass(), .object = object.mass},
            OutlineOf(object), RobotModel::Build(urdf, cobot.base.ToPose())};
  } catch (const InputError& error) {
    TheScreen().Print(std::string("The models of the virtual scene are not known: ") +
                      error.what());
    return {};
  }
}

void RefuseUnknown(const Scenario& scenario, const std::string& file) {
  if (const auto missing = assessment::MissingForPosture(scenario); !missing.empty())
    throw InputError(
        file, missing.front() +
                  " For this recording, give the missing value on the command line, for example "
                  "--set 'operator.body={height: 1.75, mass: 75, sex: male}' --set "
                  "'operator.stance={ground: [1, 0, -0.85], facing: 180 deg}'.");
}

// Returns no track if no head was measured during the run.
std::optional<tracks::BodyTrack> HeadOf(const RecordingReader& reader) {
  tracks::PartTrack head;
  for (const RecordedHead& recorded : reader.ReadHeads())
    assessment::AppendMeasured(recorded.head, recorded.time, &head);
  if (head.times.empty()) return {};
  tracks::BodyTrack track;
  track.source = "the headset";
  track.of_the_run = true;
  track.head = std::move(head);
  return track;
}

// Throws InputError if the stream cannot be used.
tracks::BodyTrack TrackOf(const RecordedStream& recorded) {
  if (recorded.description.empty())
    throw InputError("The recording has lost the description of this stream.");
  tracks::StreamTrack stream(tracks::ParseStream(recorded.description));
  if (recorded.channels != stream.channels())
    throw InputError(stream.name(),
                     "The samples have another number of channels than the description.");
  const std::span<const double> values = recorded.values;
  for (std::size_t i = 0; i < recorded.times.size(); ++i)
    stream.Take(recorded.times[i], values.subspan(i * recorded.channels, recorded.channels));
  stream.Convert();
  tracks::BodyTrack track = stream.track();
  track.of_the_run = true;
  if (!recorded.complete)
    track.warnings.push_back(
        Formatted("Only the samples of the first %.0f s are used, because the streams in the "
                  "recording have too many samples.",
                  recorded.times.back()));
  return track;
}

// The ticks can be evaluated without the streams, so a damaged stream only causes a message.
std::vector<RecordedStream> ReadStreamsOf(const RecordingReader& reader) {
  try {
    return reader.ReadStreams();
  } catch (const InputError& error) {
    TheScreen().Print(std::string("The streams in the recording are not used: ") + error.what());
    return {};
  }
}

// Returns the streams that other systems sent during the run. A stream that cannot be used is left
// out, and the reason is printed.
std::vector<tracks::BodyTrack> StreamsOf(const RecordingReader& reader) {
  std::vector<tracks::BodyTrack> tracks;
  for (const RecordedStream& recorded : ReadStreamsOf(reader)) {
    if (recorded.times.empty()) continue;
    try {
      tracks.push_back(TrackOf(recorded));
    } catch (const InputError& error) {
      TheScreen().Print(std::string("A stream in the recording is not used: ") + error.what());
    }
  }
  return tracks;
}

EvaluatedRun OpenTicks(const std::string& file, const PersonOptions& options) {
  RecordingReader reader(file);
  const RecordingHeader& header = reader.header();
  if (header.scenario_yaml.empty())
    throw InputError(file, "The recording has lost its scenario, so the person is not known.");
  EvaluatedRun run;
  run.scenario = ParseScenario(header.scenario_yaml, file, ".", options.set);
  RefuseUnknown(run.scenario, file);
  run.participant = ParticipantIn(header.labels);
  assessment::SampleCollector samples(run.scenario);
  RecordedScene scene = SceneOf(header);
  run.masses = scene.masses;
  run.safety.emplace(run.scenario, std::move(scene.outline), std::move(scene.cobot));
  ReadTicks(&reader, "Reading", options.quiet, [&](const TickRecord& record) {
    samples.Add(record);
    run.safety->Add(record);
  });
  ShowProblem(reader.problem());
  run.run = assessment::RunOf(samples);
  if (run.masses) run.object_mass = run.masses->object;
  run.start_unix = 1e-9 * static_cast<double>(header.start_unix_ns);
  if (auto head = HeadOf(reader)) run.tracks.push_back(std::move(*head));
  for (tracks::BodyTrack& stream : StreamsOf(reader)) run.tracks.push_back(std::move(stream));
  return run;
}

EvaluatedRun OpenImported(const std::string& file, const PersonOptions& options) {
  const tracks::PersonFile person = tracks::ReadPersonFile(file, options.set);
  EvaluatedRun run;
  run.scenario = assessment::ScenarioOf(person.header, person.track);
  RefuseUnknown(run.scenario, file);
  run.run = assessment::RunOf(person);
  run.object_mass = person.header.object_mass;
  run.notes = person.header.notes;
  run.participant = person.header.participant;
  if (person.track.head || person.track.elbows[0] || person.track.elbows[1] ||
      !person.track.signals.empty())
    run.tracks.push_back(person.track);
  return run;
}

}  // namespace

assessment::AssessOptions EvaluatedRun::Options() const {
  assessment::AssessOptions options;
  options.tracks = tracks;
  options.start_unix = start_unix;
  options.notes = notes;
  return options;
}

EvaluatedRun OpenRun(const std::string& file, const PersonOptions& options,
                     const std::vector<std::string>& tracks) {
  EvaluatedRun run =
      tracks::IsPersonFile(file) ? OpenImported(file, options) : OpenTicks(file, options);
  run.file = std::filesystem::path(file).filename().string();
  std::vector<tracks::BodyTrack> given;
  for (const std::string& track : tracks) given.push_back(tracks::LoadBodyTrack(track));
  run.tracks.insert(run.tracks.begin(), std::make_move_iterator(given.begin()),
                    std::make_move_iterator(given.end()));
  return run;
}

}  // namespace predictor
