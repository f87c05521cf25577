// Measures the duration of a tick in a scene with many contacts.
#include "emulator/emulator.h"
#include "emulator/run_loop.h"
#include "samples.h"
#include "sections.h"
#include "simulation/world.h"

namespace predictor::bench {
namespace {

constexpr double kLifted = 0.06;  // lift of the box by the posts, for a force of 30 N [m]
constexpr double kRadius = 0.02;  // of a post [m]
constexpr double kDuration = 10;  // of a run [s]

}  // namespace

Scenario ContactScene() {
  Scenario s = LoadNamed("box_9kg");
  const Pose X_WO = World(s).state().object.X_W;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 4; ++j) {
      FixtureSpec post;
      post.shape = FixtureShape::kSphere;
      post.size = {kRadius, 0, 0};
      post.xyz = X_WO * Vector3(0.06 * (j - 1.5), 0.07 * (i - 2), -0.1);
      post.xyz.z() += kLifted - kRadius;
      s.environment.fixtures.push_back(post);
    }
  s.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.5"})};
  s.duration = kDuration;
  return s;
}

void TimeContact(double contact_step, double mj_step, int runs) {
  const Scenario s = ContactScene();
  std::vector<double> p50, p99;
  for (int run = 0; run < runs; ++run) {
    Emulator emulator(s);
    std::vector<double> us;
    Simulate(&emulator, s.duration, [&](const TickRecord& tick) {
      if (tick.state == RunState::kRun)
        us.push_back(static_cast<double>(tick.stage_us[static_cast<std::size_t>(Stage::kTick)]));
    });
    p50.push_back(Median(us));
    p99.push_back(Quantile(us, 0.99));
  }
  const double tick = Median(p50), limit = 2 * contact_step + 4 * mj_step;
  Heading("Tick with 20 contact pairs (medians over the runs)");
  std::printf("bare mj_step of the scene %6.2f us, of box_9kg %.2f us\n", contact_step, mj_step);
  std::printf("tick, median %6.2f us   required %.2f: %s   p99 %.2f us\n", tick, limit,
              tick <= limit ? "met" : "MISSED", Median(p99));
}

}  // namespace predictor::bench
