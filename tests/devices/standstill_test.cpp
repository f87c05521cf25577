// After the program dies, the arms must come to rest as documented. The documented values are
// defined in one place.
#include "devices/standstill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "core/format.h"
#include "core/random.h"
#include "devices/franka_rig.h"
#include "devices/ur/ur_script.h"
#include "devices/ur_bench.h"
#include "rig/velocity_loop.h"
#include "support/soak.h"

namespace predictor {
namespace {

TEST(Standstill, IsWhatTheScriptDoes) {
  for (const double cycle : {0.002, 0.008})
    EXPECT_LE(UrWatchdog(cycle), kUrStandstill.silence) << cycle;
  EXPECT_EQ(UrOptions().deceleration, kUrStandstill.deceleration);
}

TEST(Standstill, IsWhatTheDocumentsSay) {
  for (const auto& [name, make] :
       {std::pair{"connect-a-ur", ArmMake::kUr}, std::pair{"connect-a-franka", ArmMake::kFranka}}) {
    const Standstill& s = StandstillOf(make);
    std::ifstream in(std::string(PREDICTOR_SOURCE_DIR) + "/docs/robots/" + name + ".md");
    std::string text, line;
    while (std::getline(in, line)) text += line + " ";  // a line is a sentence
    const std::string says = Formatted(
        "%.0f ms + v / (%.0f rad/s²) + %.0f ms, where v is the speed of its fastest joint. "
        "This time is %.2f s at 0.8 rad/s and %.2f s at 2.5 rad/s",
        1e3 * s.silence, s.deceleration, 1e3 * s.settling, s.Within(0.8), s.Within(2.5));
    EXPECT_NE(text.find(says), std::string::npos) << name << ": " << says;
  }
}

// An arm whose joints follow the fake controller, with the velocity loop that the documented values
// assume.
class Following {
 public:
  Following(MemoryNetwork* network, Mechanics* mechanics)
      : network_(network), mechanics_(mechanics) {
    for (const double q : mechanics->sample.q) {
      loops_.emplace_back(VelocityLoopSpec{15, 0.9, 0}, 0, 0.001, 10, 1e3);
      loops_.back().Reset(q);
    }
    network->SetWorld([this] { Step(); });
  }
  Following(const Following&) = delete;

  double speed() const { return mechanics_->sample.v.cwiseAbs().maxCoeff(); }  // [rad/s]
  // Lets time pass without the program until the joints have rested for a long time.
  struct Outcome {
    double fastest = 0, rest_after = 0;  // [rad/s], [s]
  };
  Outcome Abandon() {
    constexpr double kRest = 2e-3;  // joint speed [rad/s]: 1 mm/s at half a metre
    Outcome outcome;
    for (int k = 1; k <= 2000; ++k) {
      network_->Pass(0.001);
      outcome.fastest = std::max(outcome.fastest, speed());
      if (speed() > kRest) outcome.rest_after = 0.001 * k;
    }
    return outcome;
  }

 private:
  void Step() {
    for (std::size_t j = 0; j < loops_.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      loops_[j].Step(mechanics_->command[i]);
      mechanics_->sample.q[i] = loops_[j].q();
      mechanics_->sample.v[i] = loops_[j].v();
    }
  }

  MemoryNetwork* network_;
  Mechanics* mechanics_;
  std::vector<VelocityLoop> loops_;
};

// The program stops sending commands at a random time after it has commanded this speed for the
// first time.
constexpr double kSpeeds[] = {0.2, 0.8, 2.5};  // the documented speeds and a slow one [rad/s]
constexpr int kLatest = 500;                   // [ms]

void Judge(const Standstill& advertised, const Following::Outcome& outcome, double asked,
           int moment) {
  EXPECT_LT(outcome.rest_after, advertised.Within(outcome.fastest)) << asked << ", " << moment;
  if (moment == kLatest) {
    EXPECT_GT(outcome.fastest, 0.98 * asked);
    std::printf("at %.2f rad/s: rest after %.0f ms, advertised %.0f\n", outcome.fastest,
                1e3 * outcome.rest_after, 1e3 * advertised.Within(outcome.fastest));
  }
}

TEST(Standstill, IsThatOfAUrWhateverItsSpeedSoak) {
  for (const double asked : kSpeeds) {
    RandomStream random(1, "death");
    for (long k = 0; k < Count(20, 500); ++k) {
      const int moment = k == 0 ? kLatest : static_cast<int>(random.Next() % kLatest);
      UrBench bench(k % 2 == 0 ? ESeries() : Cb3(static_cast<int>(random.Next() % 8)));
      Following arm(&bench.network, &bench.mechanics);
      bench.Connect().Ticks(50 + moment, asked);
      Judge(kUrStandstill, arm.Abandon(), asked, moment);
    }
  }
}

// Only the fifth and the seventh joint are allowed to move this fast.
TEST(Standstill, IsThatOfAFrankaWhateverItsSpeedSoak) {
  for (const double asked : kSpeeds) {
    RandomStream random(1, "death");
    for (long k = 0; k < Count(20, 500); ++k) {
      const int moment = k == 0 ? kLatest : static_cast<int>(random.Next() % kLatest);
      FrankaRig rig;
      Following arm(&rig.network, &rig.mechanics);
      rig.mechanics.sample.q[6] = rig.mechanics.sample.q[4] = -2;
      rig.Connect();
      rig.v[4] = rig.v[6] = asked;
      rig.Ticks(50 + moment);
      Judge(kFrankaStandstill, arm.Abandon(), asked, moment);
    }
  }
}

}  // namespace
}  // namespace predictor
