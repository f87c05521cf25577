#include <cstdio>

#include "commands.h"
#include "emulator/emulator.h"

namespace predictor {

void AddCheck(CLI::App* app, Command* command) {
  CLI::App* check = app->add_subcommand("check", "What can be known before anything moves: reach, margins, models");
  auto options = std::make_shared<ScenarioOptions>();
  options->AddTo(check);
  check->callback([command, options] { *command = [options] {
    const Scenario s = options->Load();
    Emulator e(s);
    std::printf("frequency %.2f Hz\n", e.setup().choice.margin.frequency); std::printf("lead %.1f ms margin %.2f\n", 1e3 * e.setup().lead, e.setup().choice.margin.gain);
    return kFinished; }; });
}

}  // namespace predictor
