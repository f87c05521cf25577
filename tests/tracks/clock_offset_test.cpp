#include "tracks/clock_offset.h"

#include <cmath>
#include <functional>

#include "core/random.h"
#include "tracks/files.h"

namespace predictor::tracks {
namespace {

struct Recorded {
  std::vector<double> times;
  std::vector<Vector3> p;
  Path path() const { return {times, p}; }
};

using Motion = std::function<Vector3(double)>;

// Samples `motion` at `rate` [Hz] from `begin` to `end` [s]; these are times of the motion itself.
// The clock is ahead by `shift`, the frame is rotated and moved, and the samples have noise [m].
Recorded Record(const Motion& motion, double begin, double end, double rate, double shift,
                double noise, std::uint64_t seed) {
  RandomStream random(seed, "noise");
  const Pose X = PoseFromXyzRpy({3, -1, 0.5}, {0.3, -1.1, 2});
  Recorded recorded;
  for (double t = begin; t < end; t += 1 / rate) {
    recorded.times.push_back(t + shift);
    const Vector3 error(random.Normal(), random.Normal(), random.Normal());
    recorded.p.emplace_back(X * motion(t) + noise * error);
  }
  return recorded;
}

// Returns a motion that does not repeat: a sum of ten vibrations with random frequencies of 0.1 to
// 0.8 Hz.
Motion RandomMotion(std::uint64_t seed) {
  RandomStream random(seed, "motion");
  std::vector<std::array<double, 3>> waves;  // frequency, amplitude, phase
  for (int i = 0; i < 30; ++i)
    waves.push_back(
        {0.1 + 0.7 * random.Uniform(), 0.03 * random.Normal(), 6.28 * random.Uniform()});
  return [waves](double t) {
    Vector3 p = Vector3::Zero();
    for (std::size_t i = 0; i < waves.size(); ++i)
      p[static_cast<Eigen::Index>(i % 3)] +=
          waves[i][1] * std::sin(2 * M_PI * waves[i][0] * t + waves[i][2]);
    return p;
  };
}

// The stated 95 % interval must contain the true offset, for different frames, rates and noise.
TEST(ClockOffset, IsFoundWithinItsUncertainty) {
  int inside = 0, runs = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Motion motion = RandomMotion(seed);
    const double shift = -1234.567 + 0.0137 * static_cast<double>(seed);
    const Recorded handle = Record(motion, 0, 30, 100, 0, 1e-4, seed);
    const Recorded hand = Record(motion, 5, 33, 120, shift, 1e-3, seed + 100);
    const ClockOffset found = EstimateOffset(handle.path(), hand.path(), "hand.csv");
    EXPECT_NEAR(found.offset, -shift, 0.01);
    EXPECT_LT(found.uncertainty, 0.02);
    inside += std::abs(found.offset + shift) <= found.uncertainty ? 1 : 0;
    ++runs;
  }
  // the 0.1 % quantile of the binomial distribution is 33 (95 % of 40)
  EXPECT_GE(inside, 0.85 * runs);
}

TEST(ClockOffset, OfAPeriodicMotionIsAmbiguous) {
  const Motion swing = [](double t) {
    return Vector3(0.2 * std::sin(2 * t), 0, 0.1 * std::cos(2 * t));
  };
  const Recorded a = Record(swing, 0, 30, 100, 0, 0, 1), b = Record(swing, 0, 30, 100, 7, 0, 2);
  ExpectWords(ErrorOf([&] { EstimateOffset(a.path(), b.path(), "hand.csv"); }),
              {"hand.csv", "ambiguous", "offset: SECONDS"});
}

TEST(ClockOffset, OfAnotherMotionOrARestingHandIsRefused) {
  const Recorded a = Record(RandomMotion(1), 0, 30, 100, 0, 0, 1);
  const Recorded other = Record(RandomMotion(2), 0, 30, 100, 0, 0, 2);
  ExpectWords(ErrorOf([&] { EstimateOffset(a.path(), other.path(), "hand.csv"); }), {"correlate"});
  const Recorded rest = Record([](double) { return Vector3::Zero(); }, 0, 30, 100, 0, 1e-4, 3);
  ExpectWords(ErrorOf([&] { EstimateOffset(a.path(), rest.path(), "hand.csv"); }),
              {"hardly moves"});
  const Recorded instant = Record(RandomMotion(1), 0, 1, 100, 0, 0, 1);
  ExpectWords(ErrorOf([&] { EstimateOffset(a.path(), instant.path(), "hand.csv"); }),
              {"less than 3 s"});
}

TEST(ClockOffset, ThatJumpsWithinTheRecordIsRefused) {
  const Motion motion = RandomMotion(4);
  const Recorded a = Record(motion, 0, 60, 100, 0, 0, 1);
  Recorded b = Record(motion, 0, 60, 100, 2, 0, 2);
  for (double& t : b.times)
    if (t > 42) t += 0.2;
  ExpectWords(ErrorOf([&] { EstimateOffset(a.path(), b.path(), "hand.csv"); }),
              {"jumps or drifts", "Cut the file"});
}

}  // namespace
}  // namespace predictor::tracks
