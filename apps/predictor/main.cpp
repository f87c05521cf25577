#include <csignal>
#include <cstdio>
#include <exception>
#include <string>

#include "command_line.h"
#include "core/error.h"
#include "crash_message.h"
#include "evaluator/evaluator_process.h"
#include "lab_streams/stream_process.h"
#include "plugin_watch.h"
#include "screen.h"
#include "watchdog/watchdog_process.h"

namespace predictor {
namespace {

constexpr const char* kFooter =
    "Examples:\n"
    "  predictor init first               write a scenario, first.yaml\n"
    "  predictor run first.yaml           run it, and open the address that it prints\n"
    "  predictor help survey report       help of one command\n"
    "\n"
    "Exit codes:\n"
    "  0  success\n"
    "  1  negative result: a safety stop without a reset, a scenario that fails its check, a\n"
    "     replay that differs, a joint that was not identified, or a device that differs from the\n"
    "     machine file\n"
    "  2  bad input or usage: a wrong option, or a file that is missing, invalid or damaged\n"
    "  3  a device, the system, the program or a controller's library failed\n"
    "\n"
    "Environment:\n"
    "  PREDICTOR_PACKAGE_PATH  folders, separated by colons, in which package:// paths of URDF\n"
    "                          files are searched\n"
    "  TERM=dumb               no progress bar\n"
    "\n"
    "No command replaces an existing file without --force.\n";

// Runs one of the helper processes that a run starts: the process for the viewer's page, the
// process for Unity, the watchdog, or the evaluator. Users do not start these processes. Returns a
// negative value if the command line does not name a helper process.
int RunHelperProcess(int argc, char** argv) {
  if (argc != 2) return -1;
  const std::string name = argv[1];
  if (name == viewer::kViewerSubcommand) return viewer::ViewerMain();
  if (name == ros_tcp::kRosTcpSubcommand) return ros_tcp::RosTcpMain();
  if (name == watchdog::kWatchdogSubcommand) return watchdog::WatchdogMain();
  if (name == evaluator::kEvaluatorSubcommand) return evaluator::EvaluatorMain();
  if (name == lab_streams::kStreamSubcommand) return lab_streams::StreamMain();
  return -1;
}

void AddCommands(CLI::App* app, Request* r) {
  app->formatter(std::make_shared<HelpFormatter>());
  app->require_subcommand(1);
  app->set_version_flag("-V,--version", VersionText);
  AddRunCommands(app, r);
  AddAnalysisCommands(app, r);
  AddRigCommands(app, r);
  AddToolCommands(app, r);
  app->footer(kFooter);  // at the end, because each new command inherits the footer
}

// Returns the exit code, or a negative value if the parsed command should be executed.
int Parse(CLI::App* app, int argc, char** argv) {
  if (argc == 1) {
    std::fputs(app->help().c_str(), stderr);
    return kBadInput;
  }
  try {
    app->parse(argc, argv);
    return -1;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app->exit(error) == 0 ? kFinished : kBadInput;
    TheScreen().Print(UsageError(*app, error));
    return kBadInput;
  }
}

}  // namespace
}  // namespace predictor

int main(int argc, char** argv) {
  using namespace predictor;
  // If a file exceeds the size limit, writing should fail as on a full disk instead of ending the
  // program.
  std::signal(SIGXFSZ, SIG_IGN);
  if (const int code = RunHelperProcess(argc, argv); code >= 0) return code;
  PrintMessageOnCrash();
  WatchPlugins();
  CLI::App app(
      "Emulate physical human-robot collaboration: one or two haptic arms let people feel a "
      "simulated cobot.",
      "predictor");
  Request request;
  AddCommands(&app, &request);
  if (const int code = Parse(&app, argc, argv); code >= 0) return code;
  try {
    return request.command();
  } catch (const InputError& error) {
    TheScreen().Print(std::string("predictor: error: ") + error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    TheScreen().Print(std::string("predictor: error: ") + error.what());
    return kDeviceFailure;
  }
}
