#include "simulation/controller_trial.h"

#include <time.h>

#include <algorithm>
#include <chrono>

#include "simulation/allocation_count.h"
#include "simulation/controlled_scene.h"
#include "simulation/taped_controller.h"

namespace predictor {
namespace {

// Returns the processor time of this thread, which excludes that of other programs [s].
double CpuTime() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace

struct ControllerTrial::Impl {
  explicit Impl(const Scenario& scenario) : scene(scenario, EventSequence(scenario)) {
    if (TapedController* taped = scene.taped()) taped->SetUp(false);
    SetState(scene.posture(), JointVector::Zero(scene.posture().size()));
    scene.ResetController();
  }

  void SetState(const JointVector& q, const JointVector& v) {
    Engine& engine = scene.engine();
    const Engine::Layout& at = engine.layout();
    Engine::Values positions = engine.positions(), velocities = engine.velocities();
    for (int j = 0; j < q.size(); ++j) {
      positions[at.q[static_cast<std::size_t>(j)]] = q[j];
      velocities[at.v[static_cast<std::size_t>(j)]] = v[j];
    }
    scene.Update(&engine);
  }

  ControlledScene scene;
  TrialFigures figures;
  std::vector<double> times;  // [s]
};

ControllerTrial::ControllerTrial(const Scenario& scenario)
    : impl_(std::make_unique<Impl>(scenario)) {}
ControllerTrial::~ControllerTrial() = default;

int ControllerTrial::dof() const { return impl_->scene.robot().dof(); }

void ControllerTrial::Step(double time, const JointVector& q, const JointVector& v) {
  Impl& impl = *impl_;
  TrialFigures& figures = impl.figures;
  impl.SetState(q, v);
  using Clock = std::chrono::steady_clock;
  const std::int64_t calls = AllocationCalls();
  const double cpu = CpuTime();
  const Clock::time_point start = Clock::now();
  const bool usable = impl.scene.ApplyController(time, &impl.scene.engine());
  impl.scene.Advance(time, impl.scene.timing().period_time());
  impl.scene.Energy(time);
  const std::chrono::duration<double> wall = Clock::now() - start;
  figures.longest_cpu = std::max(figures.longest_cpu, CpuTime() - cpu);
  if (AllocationCalls() != calls && figures.allocating++ == 0) figures.first_allocation = time;
  if (!usable && impl.scene.failure().quantity != Quantity::kAllocations) ++figures.not_finite;
  ++figures.steps;
  impl.times.push_back(wall.count());
}

TrialFigures ControllerTrial::Figures() const {
  TrialFigures figures = impl_->figures;
  std::vector<double> times = impl_->times;
  std::ranges::sort(times);
  if (times.empty()) return figures;
  figures.median = times[times.size() / 2];
  figures.p99 = times[times.size() * 99 / 100];
  return figures;
}

}  // namespace predictor
