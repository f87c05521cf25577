#include <cstdio>

#include "commands.h"
#include "scenario/scenario_io.h"

namespace predictor {

void AddSchema(CLI::App* app, Command* command) {
  CLI::App* schema =
      app->add_subcommand("schema", "Print the JSON Schema of scenarios, for editors");
  schema->callback([command] {
    *command = [] {
      std::fputs(ScenarioSchema().c_str(), stdout);
      return kFinished;
    };
  });
}

}  // namespace predictor
