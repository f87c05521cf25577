// Runs the emulator in a program of your own: one second of the paper's first experiment, in
// virtual time.
#include <cmath>
#include <cstdio>
#include <exception>

#include "emulator/emulator.h"
#include "scenario/paths.h"
#include "scenario/scenario_io.h"

int main(int argc, char** argv) {
  try {
    predictor::UseDataFolder(PREDICTOR_DATA_DIR);
    const char* name = argc > 1 ? argv[1] : "box_9kg";
    predictor::Emulator emulator(predictor::LoadScenario(predictor::FindShipped(name)));
    const long ticks = std::lround(1 / emulator.dt());
    for (long tick = 0; tick < ticks; ++tick) emulator.Tick();
    std::printf("%s: %ld ticks, %.3f s\n", name, ticks,
                static_cast<double>(emulator.record().tick) * emulator.dt());
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "embed: %s\n", error.what());
    return 1;
  }
}
