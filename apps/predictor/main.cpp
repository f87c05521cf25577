#include <cstdio>
#include <exception>

#include "commands.h"
#include "core/error.h"

int main(int argc, char** argv) {
  using namespace predictor;
  CLI::App app(
      "PREDICTOR: one or two robot arms as a physical emulator of physical human-robot "
      "collaboration.\n"
      "Exit codes: 0 finished, 1 stopped by safety (check: unfit), 2 bad input or usage, 3 device "
      "or system failure.",
      "predictor");
  app.require_subcommand(1);
  app.set_version_flag("--version", PREDICTOR_VERSION);
  Command command;
  AddRun(&app, &command);
  AddSimulate(&app, &command);
  AddCheck(&app, &command);
  AddSchema(&app, &command);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kFinished : kBadInput;
  }
  try {
    return command();
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "predictor: %s\n", error.what());
    return kDeviceFailure;
  }
}
