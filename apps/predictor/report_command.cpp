#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/contact_run/contact_run.h"
#include "assessment/output.h"
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "evaluate.h"
#include "recorded_run.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "report/report.h"
#include "report/run_names.h"
#include "restored_scenario.h"

namespace predictor {
namespace {

constexpr std::size_t kMaxRecordings = 8;  // the number of available colours
// Largest total duration of the recordings for which the report keeps every tick [s]. This limit
// keeps the page below 20 MB.
constexpr double kDetail = 120;

// The data that the report shows about one recording.
struct ReportedRun {
  RunData data;
  ContactRun contact;
};

RunInfo Describe(const std::string& file, const RestoredScenario& restored,
                 RecordingReader* reader) {
  const RecordingHeader& header = reader->header();
  RunInfo info;
  info.name = std::filesystem::path(file).filename().string();
  info.scenario = RecordedScenario(header, file, ".");
  info.scenario_yaml = header.scenario_yaml;
  info.program_version = header.program_version;
  info.labels = header.labels;
  info.prismatic = restored.PrismaticJoints();
  info.loop = header.loop;
  if (header.start_unix_ns > 0)
    info.date = LocalTime("%Y-%m-%d %H:%M:%S", header.start_unix_ns / 1'000'000'000);
  info.problem = reader->problem();
  for (const RecordingEvent& event : reader->events())
    // The report derives the other events from the ticks.
    if (event.kind == "marker" || event.kind == "event")
      info.events.push_back({event.tick, event.text});
  if (reader->more_events() > 0)
    info.problem +=
        (info.problem.empty() ? "" : " ") + std::to_string(reader->more_events()) +
        " of the recording's events are omitted, because the recording has more events than the "
        "program can read.";
  return info;
}

// Returns a collector for a scenario with contact, or null for a scenario without contact.
std::unique_ptr<ContactCollector> MakeContactCollector(const RestoredScenario& restored,
                                                       ContactRun* run) {
  if (!HasContact(run->scenario)) return nullptr;
  try {
    run->scenario = restored.Get();
    return std::make_unique<ContactCollector>(run->scenario);
  } catch (const InputError& error) {
    run->problem = std::string("Nothing is known about contact: ") + error.what();
    return nullptr;
  }
}

ReportedRun Read(const std::string& file, double detail, bool quiet) {
  RecordingReader reader(file);
  const RestoredScenario restored(reader.header());
  RunInfo info = Describe(file, restored, &reader);
  ReportedRun run;
  run.contact.scenario = info.scenario;
  const auto contacts = MakeContactCollector(restored, &run.contact);
  const auto lead = info.loop ? std::optional(info.loop->lead) : std::nullopt;
  RunCollector collector(std::move(info), {.detail = detail});
  ReadTicks(&reader, "Reading", quiet, [&](const TickRecord& record) {
    collector.Add(record);
    if (contacts) contacts->Add(record);
  });
  run.data = collector.Finish();
  if (run.data.records == 0)
    throw InputError(file, "The recording has no ticks, so there is nothing to report.");
  if (contacts) {
    run.contact.facts = contacts->facts();
    PredictContacts(lead, &run.contact);
  }
  return run;
}

// Returns names of several runs, made from the values that differ between the runs.
void NameRuns(const std::vector<std::string>& files, std::vector<RunData>* runs) {
  if (runs->size() < 2) return;
  std::vector<NamedRun> named;
  for (std::size_t k = 0; k < runs->size(); ++k) {
    const auto& labels = (*runs)[k].info.labels;
    const auto condition = labels.find("condition");
    named.push_back({files[k], condition == labels.end() ? "" : condition->second});
  }
  const std::vector<std::string> names = ShortNames(named);
  for (std::size_t k = 0; k < runs->size(); ++k) {
    (*runs)[k].info.name = names[k];
    (*runs)[k].info.file = files[k];
  }
}

}  // namespace

int ReportCommand(const ReportOptions& options) {
  if (options.recordings.size() > kMaxRecordings)
    throw InputError("At most " + std::to_string(kMaxRecordings) +
                     " recordings can be compared in one page.");
  std::string output = options.output;
  if (output.empty())
    output = options.recordings.size() == 1
                 ? std::filesystem::path(options.recordings[0]).replace_extension(".html").string()
                 : "comparison.html";
  options.CheckWritable();
  options.RefuseToReplace(output);
  std::vector<RunData> runs;
  std::vector<ContactRun> contacts;
  for (const std::string& file : options.recordings) {
    ReportedRun run =
        Read(file, kDetail / static_cast<double>(options.recordings.size()), options.quiet);
    runs.push_back(std::move(run.data));
    contacts.push_back(std::move(run.contact));
  }
  NameRuns(options.recordings, &runs);
  std::vector<assessment::PersonOfRun> persons;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    persons.push_back(PersonIn(options.recordings[k], runs[k].summary.duration(), options));
    if (runs.size() > 1) persons.back().name = runs[k].info.name;
  }
  const ReportDocument report = MakeReport(runs, PREDICTOR_VERSION, [&](ReportPage* page) {
    if (contacts.size() == 1) AddContactChapter(contacts.front(), page);
    assessment::AddPersonChapter(persons, page);
  });
  WriteWholeFile(output, report.html);
  const nlohmann::json result = {{"page", output}, {"recordings", options.recordings}};
  options.Write("Wrote " + output + ". Open it in a browser.\n", result.dump(2) + "\n");
  return kFinished;
}

}  // namespace predictor
