// predictor survey: the questionnaire after a run, its report, and the way out of it.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "commands.h"
#include "core/error.h"
#include "evaluation/questionnaire_files.h"
#include "evaluation/questionnaire_report.h"
#include "evaluation/questionnaire_table.h"
#include "recording/provenance.h"
#include "recording/reader.h"
#include "survey/survey_app.h"
#include "viewer/server.h"
#include "viewer/viewer_app.h"

namespace predictor {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuns = "runs";  // where `run` records

std::vector<fs::path> PlacesOf(const SurveyOptions& options) {
  if (options.places.empty()) return {kRuns};
  return {options.places.begin(), options.places.end()};
}

// Where the answer goes, and which run it is about.
struct Destination {
  fs::path folder;
  std::string recording;  // file name; empty: a folder was named
};

Destination DestinationOf(const SurveyOptions& options) {
  if (options.places.size() != 1)
    throw InputError(
        "Name the recording of the run that the questionnaire is about, or a folder for the "
        "answer.");
  const fs::path place = options.places[0];
  if (!fs::exists(place)) throw InputError(place.string(), "There is no such recording.");
  Destination to{place, ""};
  if (!fs::is_directory(place)) {
    to.folder = place.has_parent_path() ? place.parent_path() : fs::path(".");
    to.recording = place.filename().string();
  }
  // Not after somebody has taken the trouble to answer.
  if (access(to.folder.c_str(), W_OK | X_OK) != 0)
    throw InputError(to.folder.string(), "The answer could not be stored here: no right to write.");
  return to;
}

// What the recording says; nothing if the file is no recording of this version.
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
  if (!condition) throw InputError("--condition is one of: real, emulated.");
  return condition;
}

std::atomic<int> signal_pipe{-1};

void OnSignal(int) {
  const char newline = '\n';
  [[maybe_unused]] const ssize_t written = write(signal_pipe, &newline, 1);
}

// Ctrl-C ends the server as it ends by itself.
void StopAtSignal(Server* server) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("There is no pipe.");
  signal_pipe = ends[1];
  const auto stop = [server] { server->Stop(); };
  server->Watch(
      ends[0], 64, [stop](const std::string&) { stop(); }, stop);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, OnSignal);
  std::signal(SIGPIPE, SIG_IGN);
}

int Ask(const SurveyOptions& options) {
  const Destination to = DestinationOf(options);
  SurveySetup setup;
  setup.hosts = {"localhost", "127.0.0.1", "::1"};
  setup.condition = ConditionOf(options, to);
  setup.clock = MonotonicNow;
  setup.store = [&to](SurveyAnswer answer) {
    answer.recording = to.recording;
    StoreSurveyAnswer(to.folder, answer);
  };
  SurveyApp app(std::move(setup));
  ServerOptions serving;
  serving.port = options.port;
  Server server(serving, &app);
  StopAtSignal(&server);
  bool running = true;  // the server's own end ends connections too
  app.OnOver([&] {
    if (running) server.Stop();
  });
  std::fprintf(stderr, "Questionnaire: http://localhost:%u/#code=%s (good for one browser)\n",
               static_cast<unsigned>(server.port()), app.code().c_str());
  server.Run();
  running = false;
  // The pseudonym is between the person and the file: it is not printed.
  if (app.end() == SurveyEnd::kStored)
    std::fprintf(stderr, "An answer was stored in %s.\n", to.folder.c_str());
  else
    std::fprintf(stderr, "No answer was given.\n");
  return kFinished;
}

int WriteReport(const SurveyOptions& options) {
  const SurveyReport report = SummariseSurvey(ReadSurveyAnswers(PlacesOf(options)));
  const fs::path file = options.output.empty() ? "survey.html" : options.output;
  std::ofstream out(file, std::ios::binary);
  out << SurveyPage(report);
  out.close();
  if (!out) throw InputError(file.string(), "The report cannot be written here.");
  WriteOut(SurveyTable(report));
  std::fprintf(stderr, "With the plot: %s\n", file.c_str());
  return kFinished;
}

int Remove(const SurveyOptions& options) {
  const auto removed = RemoveSurveyAnswers(PlacesOf(options), options.remove);
  if (removed.empty())
    throw InputError("There is no answer under " + options.remove + " in " +
                     PlacesOf(options)[0].string() +
                     (options.places.size() > 1 ? " and so on." : "."));
  std::fprintf(stderr, "%zu %s under %s removed. Copies elsewhere, if you made any, are not.\n",
               removed.size(), removed.size() == 1 ? "answer" : "answers", options.remove.c_str());
  return kFinished;
}

}  // namespace

int SurveyCommand(const SurveyOptions& options) {
  if (options.paper) {
    WriteOut(PaperTableText());
    return kFinished;
  }
  if (options.report) return WriteReport(options);
  if (!options.remove.empty()) return Remove(options);
  return Ask(options);
}

}  // namespace predictor
