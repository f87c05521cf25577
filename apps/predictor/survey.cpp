// predictor survey: the questionnaire after a run, its report, and the removal of answers.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "core/format.h"
#include "core/text.h"
#include "evaluation/questionnaire_files.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"
#include "process/sandbox.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "report/survey_page.h"
#include "screen.h"
#include "survey/survey_app.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kRuns = "runs";  // folder in which `run` records

std::vector<fs::path> PlacesOf(const SurveyOptions& options) {
  if (options.places.empty()) return {kRuns};
  return {options.places.begin(), options.places.end()};
}

// The folder for the answer, and the run that the answer is about.
struct Destination {
  fs::path folder;
  std::string recording;  // file name; empty if the user named a folder
};

Destination DestinationOf(const SurveyOptions& options) {
  if (options.places.size() != 1)
    throw InputError(
        "Give the recording of the run that the questionnaire is about, or a folder for the "
        "answer.");
  const fs::path place = options.places[0];
  if (!fs::exists(place)) throw InputError(place.string(), "The recording does not exist.");
  Destination to{place, ""};
  if (!fs::is_directory(place)) {
    to.folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
    to.recording = place.filename().string();
  }
  // The folder is checked first, so that no answer is lost at the end.
  if (access(to.folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(to.folder.string(),
                     "The answer cannot be stored here: the folder is not writable.");
  return to;
}

// Returns the condition in the recording, or no value if the file is not a recording of this
// version.
std::optional<Condition> RecordedCondition(const Destination& to) {
  if (to.recording.empty()) return {};
  const fs::path file = to.folder / to.recording;
  try {
    const RecordingReader reader(file);
    const Scenario scenario = RecordedScenario(reader.header(), file.string(), to.folder);
    return scenario.mode == Mode::kDirect ? Condition::kReal : Condition::kEmulated;
  } catch (const InputError&) {
    return {};
  }
}

std::optional<Condition> ConditionOf(const SurveyOptions& options, const Destination& to) {
  if (options.condition.empty()) return RecordedCondition(to);
  const auto condition = ConditionNamed(options.condition);
  if (!condition) throw InputError("--condition must be real or emulated.");
  return condition;
}

std::atomic<int> signal_pipe{-1};

void WriteNewline(int) {
  const char newline = '\n';
  [[maybe_unused]] const ssize_t written = write(signal_pipe, &newline, 1);
}

// Makes Ctrl-C end the server in the same way as the end of a survey does.
void StopAtSignal(viewer::Server* server) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0)
    throw std::runtime_error("A pipe could not be created.");
  signal_pipe = ends[1];
  const auto stop = [server] { server->Stop(); };
  server->Watch(
      ends[0], 64, [stop](const std::string&) { stop(); }, stop);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, WriteNewline);
  std::signal(SIGPIPE, SIG_IGN);
}

// After this call, the process parses the browsers' input with restricted rights and may only write
// into the folder of the answers and into files that are open already.
void GiveUpRights(const fs::path& folder) {
  if (kSanitized) return;
  Preparation may;
  may.write = {folder};
  if (const std::string missing = EnterPreparation(may); !missing.empty())
    TheScreen().Print("Warning: the server is not fully sandboxed, because this system lacks " +
                      missing + ".");
}

Json JsonOf(const StatementSummary& s) {
  return {{"answers", s.answers},     {"counts", s.counts}, {"mean", s.mean},
          {"deviation", s.deviation}, {"median", s.median}, {"agreeing_ratio", s.agreeing}};
}

Json JsonOf(const ShiftSummary& s) {
  return {{"count", s.count},           {"p", s.test.p},
          {"p_holm", s.adjusted},       {"shift", s.shift.estimate},
          {"shift_low", s.shift.lower}, {"shift_high", s.shift.upper}};
}

// Keys are the names of the statements: S1, S2 and so on.
template <typename Items>
Json ByStatement(const Items& items) {
  Json result = Json::object();
  for (std::size_t i = 0; i < kStatements; ++i)
    if (items[i].count > 0) result[Statements()[i].name] = JsonOf(items[i]);
  return result;
}

std::string JsonOf(const SurveyReport& report) {
  Json conditions = Json::object();
  for (std::size_t k = 0; k < kConditions; ++k) {
    const ConditionSummary& c = report.conditions[k];
    Json statements = Json::object();
    for (std::size_t i = 0; i < kStatements; ++i)
      statements[Statements()[i].name] = JsonOf(c.statements[i]);
    conditions[Name(static_cast<Condition>(k))] = {{"people", c.people},
                                                   {"age_mean_years", c.age_mean},
                                                   {"age_deviation_years", c.age_deviation},
                                                   {"statements", statements},
                                                   {"from_neutral", ByStatement(c.from_neutral)}};
  }
  const Json result = {{"people", report.people},
                       {"paired_people", report.paired_people},
                       {"conditions", conditions},
                       {"emulated_minus_real", ByStatement(report.paired)}};
  return result.dump(2) + "\n";
}

}  // namespace

int SurveyAskCommand(const SurveyOptions& options) {
  options.CheckWritable();
  const Destination to = DestinationOf(options);
  survey::SurveySetup setup;
  setup.hosts = {"localhost", "127.0.0.1", "::1"};
  setup.condition = ConditionOf(options, to);
  setup.clock = viewer::MonotonicNow;
  setup.store = [&to](SurveyAnswer answer) {
    answer.recording = to.recording;
    StoreSurveyAnswer(to.folder, answer);
  };
  survey::SurveyApp app(std::move(setup));
  viewer::ServerOptions serving;
  serving.port = options.port;
  viewer::Server server(serving, &app);
  StopAtSignal(&server);
  std::ofstream json;
  if (!options.json.empty() && options.json != "-") json.open(options.json);
  GiveUpRights(to.folder);
  bool running = true;  // the end of the server also ends connections
  app.OnOver([&] {
    if (running) server.Stop();
  });
  TheScreen().Print(
      Formatted("Questionnaire: http://localhost:%u/#code=%s (works in one browser only)",
                static_cast<unsigned>(server.port()), app.code().c_str()));
  server.Run();
  running = false;
  // The pseudonym is not printed, because only the person should know the pseudonym and only the
  // file should contain it.
  const bool stored = app.end() == survey::SurveyEnd::kStored;
  if (stored)
    TheScreen().Print("The answer was stored in " + to.folder.string() + ".");
  else
    TheScreen().Print("No answer was given.");
  const Json result = {{"stored", stored}, {"folder", to.folder.string()}};
  const std::string text = result.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (!json.is_open())
    options.WriteJson(text);
  else if (!(json << text).flush())
    throw InputError("--json: " + Quote(options.json) +
                     " could not be written. Give a path on a disk with free space.");
  return kFinished;
}

int SurveyReportCommand(const SurveyOptions& options) {
  options.CheckWritable();
  options.RefuseToReplace(options.output);
  const SurveyReport report = SummariseSurvey(ReadSurveyAnswers(PlacesOf(options)));
  WriteWholeFile(options.output, SurveyPage(report));
  options.Write(SurveyTable(report) + "Wrote " + options.output + ".\n", JsonOf(report));
  return kFinished;
}

int SurveyRemoveCommand(const SurveyOptions& options) {
  options.CheckWritable();
  const auto removed = RemoveSurveyAnswers(PlacesOf(options), options.pseudonym);
  if (removed.empty())
    throw InputError("There is no answer by " + options.pseudonym + " in " +
                     PlacesOf(options)[0].string() +
                     (options.places.size() > 1 ? " or the other folders." : "."));
  // The result contains no names of files, because these names contain the pseudonym.
  options.Write(
      Formatted("Removed %zu %s by %s. Copies in other places were not removed.\n", removed.size(),
                removed.size() == 1 ? "answer" : "answers", options.pseudonym.c_str()),
      Json{{"removed_answers", removed.size()}}.dump(2) + "\n");
  return kFinished;
}

int SurveyPaperCommand() {
  WriteOut(PaperTableText());
  return kFinished;
}

}  // namespace predictor
