#include <benchmark/benchmark.h>

#include <memory>

#include "bare_engine.h"
#include "rig/rig.h"
#include "samples.h"
#include "sections.h"
#include "simulation/world.h"

namespace predictor::bench {
namespace {

// Keeps the median CPU time of each benchmark's repetitions. CPU time is used because other
// processes may share the core.
class Medians final : public benchmark::ConsoleReporter {
 public:
  Medians() : ConsoleReporter(OO_None) {}
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type == Run::RT_Aggregate && run.aggregate_name == "median")
        us_[run.run_name.function_name] = run.GetAdjustedCPUTime();
    }
  }
  std::map<std::string, double> us_;
};

// Iterates over the ticks of a recording and starts again at its end.
class Cursor {
 public:
  explicit Cursor(const Recording& recording) : recording_(recording) {}
  // Returns the next tick. Sets `wrapped` to true if the returned tick is again the first tick of
  // the recording.
  std::size_t Next(bool* wrapped) {
    *wrapped = k_ + 2 >= recording_.ticks.size();
    k_ = *wrapped ? 1 : k_ + 1;
    return k_;
  }

 private:
  const Recording& recording_;
  std::size_t k_ = 0;
};

template <typename Function>
void Register(const char* name, Function function) {
  benchmark::RegisterBenchmark(name, function)->Unit(benchmark::kMicrosecond);
}

// The inputs of all ticks, which are built before the measurement.
struct Inputs {
  std::vector<WorldInput> world;
  std::vector<DeviceCommand> command;
  std::vector<std::array<ArmSample, kHands>> sample;
  explicit Inputs(const Recording& r) {
    for (std::size_t k = 0; k < r.ticks.size(); ++k) {
      world.push_back(WorldInputAt(r, k));
      command.push_back(CommandAt(r, k));
      sample.push_back({ArmSampleAt(r, k, 0), ArmSampleAt(r, k, 1)});
    }
  }
};

void RegisterEngine(const Recording& recording) {
  auto bare = std::make_shared<Bare>(recording.scenario);
  Register("mj_step", [bare](benchmark::State& state) {
    for (auto _ : state) bare->Step();
  });
  auto contact = std::make_shared<Bare>(ContactScene());
  Register(kContactStep, [contact](benchmark::State& state) {
    for (auto _ : state) contact->Step();
    if (contact->data->ncon != 20) state.SkipWithError("not 20 contacts");
  });
  auto first = std::make_shared<Still>(recording.scenario);
  Register("mj_step1 and the cobot's dynamics", [first](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(first->scene.Update(&first->scene.engine()));
  });
  auto controlled = std::make_shared<Still>(recording.scenario);
  Register("the cobot's controller", [controlled](benchmark::State& state) {
    ControlledScene& scene = controlled->scene;
    for (auto _ : state) benchmark::DoNotOptimize(scene.ApplyController(0, &scene.engine()));
  });
}

void RegisterWorld(const Recording& recording, const std::shared_ptr<Inputs>& inputs) {
  auto world = std::make_shared<World>(recording.scenario);
  auto cursor = std::make_shared<Cursor>(recording);
  const double dt = recording.dt;
  Register("World::Step", [=](benchmark::State& state) {
    for (auto _ : state) {
      bool wrapped = false;
      const std::size_t k = cursor->Next(&wrapped);
      if (wrapped) world->Reset();
      if (!world->Step(inputs->world[k], dt).ok()) state.SkipWithError("the world diverged");
    }
  });
}

void RegisterSensing(const Recording& recording, const std::shared_ptr<Inputs>& inputs) {
  auto side = std::make_shared<ArmSide>(recording.scenario, 0, recording.dt);
  auto cursor = std::make_shared<Cursor>(recording);
  Register("one arm's kinematics and hand wrench", [=](benchmark::State& state) {
    for (auto _ : state) {
      bool wrapped = false;
      benchmark::DoNotOptimize(side->Update(inputs->sample[cursor->Next(&wrapped)][0]));
    }
  });
}

void RegisterRender(const Recording& recording) {
  auto input = std::make_shared<RenderInput>(recording);
  auto renderer =
      std::make_shared<Renderer>(recording.scenario, input->models(), recording.lead, recording.dt);
  auto result = std::make_shared<RenderResult>();
  input->Load(recording, recording.ticks.size() / 5);
  Register("Renderer::Render", [=](benchmark::State& state) {
    for (auto _ : state)
      benchmark::DoNotOptimize(
          renderer->Render(input->arms(), input->target, input->last, result.get()));
  });
  const std::array<std::shared_ptr<const RobotModel>, kHands> models = input->models();
  auto data = std::make_shared<RobotData>(*models[0]);
  const JointVector q = *input->arms()[0].q;
  Register("one arm's kinematics", [=](benchmark::State& state) {
    for (auto _ : state) data->UpdateKinematics(*models[0], q, q);
  });
}

void RegisterRig(const Recording& recording, const std::shared_ptr<Inputs>& inputs) {
  auto rig = std::make_shared<Rig>(recording.scenario, recording.start,
                                   MakeVirtualOperator(recording.scenario, HandInertia::kInWrench));
  auto cursor = std::make_shared<Cursor>(recording);
  const double dt = recording.dt;
  Register("Rig::Step", [=](benchmark::State& state) {
    for (auto _ : state) {
      bool wrapped = false;
      rig->Step(inputs->command[cursor->Next(&wrapped)], dt);
    }
  });
  const std::shared_ptr<Operator> person =
      MakeVirtualOperator(recording.scenario, HandInertia::kInWrench);
  auto person_cursor = std::make_shared<Cursor>(recording);
  auto output = std::make_shared<OperatorOutput>();
  Register("operator alone", [=](benchmark::State& state) {
    for (auto _ : state) {
      bool wrapped = false;
      const std::size_t k = person_cursor->Next(&wrapped);
      OperatorInput in;
      in.dt = dt;
      in.run_time = inputs->command[k].run_time;
      in.running = true;
      in.present = {true, true};
      in.handle = inputs->world[k].handle;
      person->Step(in, output.get());
    }
  });
}

// Measures the complete tick from the middle of a run. When the operator's script has ended, the
// measurement starts again from the middle of the run.
void RegisterTick(const Recording& recording) {
  auto emulator = std::make_shared<std::unique_ptr<Emulator>>();
  const Scenario scenario = recording.scenario;
  const auto into_the_motion = [emulator, scenario] {
    *emulator = std::make_unique<Emulator>(scenario);
    while ((*emulator)->run_time() < 2 && (*emulator)->state() != RunState::kHeld) {
      (*emulator)->Tick();
      if ((*emulator)->state() == RunState::kIdle) (*emulator)->Request(RunEvent::kAlignRequested);
      if ((*emulator)->state() == RunState::kArmed) (*emulator)->Request(RunEvent::kStartRequested);
    }
  };
  into_the_motion();
  Register("Emulator::Tick", [=](benchmark::State& state) {
    for (auto _ : state) {
      (*emulator)->Tick();
      if ((*emulator)->state() != RunState::kRun ||
          (*emulator)->run_time() > scenario.duration - 1) {
        state.PauseTiming();
        into_the_motion();
        state.ResumeTiming();
      }
    }
  });
}

}  // namespace

std::map<std::string, double> TimeParts(const Recording& recording, int* argc, char** argv) {
  auto inputs = std::make_shared<Inputs>(recording);
  RegisterTick(recording);
  RegisterEngine(recording);
  RegisterWorld(recording, inputs);
  RegisterSensing(recording, inputs);
  RegisterRender(recording);
  RegisterRig(recording, inputs);
  // All repetitions run in random order, so that a disturbance affects all repetitions equally. The
  // caller's options follow these default options and therefore override the default options.
  std::vector<char*> arguments = {argv[0]};
  std::array<std::string, 3> defaults = {"--benchmark_repetitions=11", "--benchmark_min_time=0.03",
                                         "--benchmark_enable_random_interleaving=true"};
  for (std::string& argument : defaults) arguments.push_back(argument.data());
  arguments.insert(arguments.end(), argv + 1, argv + *argc);
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  benchmark::Shutdown();
  return medians.us_;
}

}  // namespace predictor::bench
