// Tests the conversion of electromyograms from a table into muscle activations of the model.
#include "assessment/measured_emg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assessment/assessment.h"
#include "assessment/output.h"
#include "assessment/samples.h"
#include "core/error.h"
#include "core/format.h"
#include "support/temporary_folder.h"

namespace predictor::assessment::emg {
namespace {

constexpr double kDuration = 3;                 // [s]
constexpr double kShape = -2, kDelay = 0.04;    // as in tracks::EmgMap
constexpr double kAmplitude = 0.8;              // of the voltage at full activation [mV]
constexpr double kCarrier = 120, kRate = 2000;  // [Hz]
constexpr double kMvc = kAmplitude * 2 / std::numbers::pi;  // mean of a rectified sine

SampleCollector MadeRun(bool right = true) {
  return Collect(PersonScenario(), kDuration, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1.0, 20);
    if (!right) record.hands[1].gripping = 0;
    return record;
  });
}

// Returns the voltage of a carrier whose envelope u gives the activation (e^(A u) - 1)/(e^A - 1).
// The voltage precedes the activation by the delay.
double VoltageAt(double time, const std::function<double(double)>& activation) {
  const double u = std::log1p(activation(time + kDelay) * std::expm1(kShape)) / kShape;
  return kAmplitude * u * std::sin(2 * std::numbers::pi * kCarrier * time);
}

// Returns the activation of a slow contraction between 10 and 50 %.
double SlowlyAt(double time) { return 0.3 + 0.2 * std::sin(2 * std::numbers::pi * 0.4 * time); }

class MeasuredEmgTest : public testing::Test {
 protected:
  // Loads a mapping of a table that was written with these values.
  tracks::BodyTrack Load(const std::string& emg, const std::function<double(double)>& voltage,
                         double rate = kRate) const {
    std::ofstream table(folder_.path() / "emg.csv");
    table << "time [s],EMG1 [mV]\n";
    for (double t = -0.5; t < kDuration + 0.5; t += 1 / rate) {
      const double value = voltage(t);
      if (std::isinf(value)) continue;  // the row is lost
      table << Formatted("%.6f,", t);
      if (std::isfinite(value)) table << Formatted("%.9g", value);
      table << "\n";
    }
    table.close();
    std::ofstream(folder_.path() / "emg.yaml") << "file: emg.csv\nemg:\n" << emg;
    return tracks::LoadBodyTrack(folder_.path() / "emg.yaml");
  }
  tracks::BodyTrack LoadSlow(const std::string& emg) const {
    return Load(emg, [](double t) { return VoltageAt(t, SlowlyAt); });
  }

  const test::TemporaryFolder folder_;
};

std::string Row(const std::string& arm, const std::string& muscles, double weight = 10) {
  return "  - {channel: EMG1, arm: " + arm + ", muscles: [" + muscles +
         "], mvc: " + Formatted("%.9g, weight: %g}\n", kMvc, weight);
}

Assessment JudgeWith(const std::vector<tracks::BodyTrack>& tracks, bool right = true) {
  AssessOptions options;
  options.intervals = false;
  options.tracks = tracks;
  return Assess(PersonScenario(), 9, RunOf(MadeRun(right)), options);
}

double MeanOf(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q.mean;
  throw std::out_of_range(path);
}

bool Warns(const Assessment& a, const std::string& words) {
  return std::ranges::any_of(a.warnings, [&](const std::string& warning) {
    return warning.find(words) != std::string::npos;
  });
}

TEST_F(MeasuredEmgTest, TheActivationComesBackThroughTheTable) {
  const Assessment a = JudgeWith({LoadSlow(Row("right", "triceps_long"))});
  ASSERT_EQ(a.measured.emg.channels.size(), 1u);
  const MeasuredEmg& channel = a.measured.emg.channels[0];
  EXPECT_EQ(channel.hand, 1);
  EXPECT_EQ(channel.share, 1);
  EXPECT_EQ(channel.above, 0);
  double worst = 0;
  const std::vector<PersonSample> samples = Held(MadeRun().samples());
  ASSERT_EQ(channel.measured.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    worst = std::max(worst, std::abs(channel.measured[i] - SlowlyAt(samples[i].recorded)));
  // The low-pass flattens a contraction of 0.4 Hz by less than (0.4/6)⁴, and the voltage of the
  // carrier rises and falls within the passband.
  EXPECT_LT(worst, 0.01);
}

// With a large weight, the antagonist has the measured activation. The joint torques must not
// change, so the elbow flexors must compensate for the antagonist.
TEST_F(MeasuredEmgTest, AMeasuredAntagonistIsBalancedByTheOthers) {
  const Assessment without = JudgeWith({});
  const Assessment with =
      JudgeWith({LoadSlow(Row("right", "triceps_lateral, triceps_medial", 1e4))});
  const EmgAgreement agreement = AgreementOf(with.measured.emg.channels[0]);
  EXPECT_NEAR(agreement.modelled, agreement.measured, 0.01);
  EXPECT_GT(MeanOf(with, "muscles.right.elbow_extensors"), 0.2);
  EXPECT_LT(MeanOf(without, "muscles.right.elbow_extensors"), 0.1);
  EXPECT_GT(MeanOf(with, "muscles.right.elbow_flexors"),
            MeanOf(without, "muscles.right.elbow_flexors") + 0.05);
  EXPECT_LT(MeanOf(with, "muscles.right.reserve_nm"), kReserveLimit);
  // The results of the other arm must not change.
  EXPECT_EQ(MeanOf(with, "muscles.left.largest"), MeanOf(without, "muscles.left.largest"));
}

TEST_F(MeasuredEmgTest, EveryOutputDistinguishesMeasuredFromModelledValues) {
  const Assessment a = JudgeWith({LoadSlow(Row("right", "biceps_long, biceps_short"))});
  const std::string csv = AssessmentCsv(a);
  EXPECT_NE(csv.find("measured.muscles.right.biceps_long+biceps_short,modelled.muscles.right."),
            std::string::npos);
  const auto json = nlohmann::json::parse(AssessmentJson(a));
  const auto& emg = json.at("measured").at("electromyograms").at(0);
  EXPECT_EQ(emg.at("electromyogram").at("origin"), "measured");
  EXPECT_EQ(emg.at("model").at("origin"), "modelled");
  EXPECT_NEAR(emg.at("electromyogram").at("mean_activation"), 0.3, 0.1);
  for (const std::string& text : {AssessmentText(a), AssessmentPage(a, "1")}) {
    EXPECT_NE(text.find("EMG1: measured for 100.0 %"), std::string::npos);
    EXPECT_NE(text.find("modelled with it"), std::string::npos);
  }
}

std::string GapOf(const Assessment& a, const std::string& words) {
  for (const NotEvaluable& gap : a.not_evaluable)
    if (gap.what.find("EMG1") != std::string::npos && gap.why.find(words) != std::string::npos)
      return gap.what;
  return "";
}

// If a channel cannot be used, the output must omit it and state the reason, and no result may
// change.
TEST_F(MeasuredEmgTest, AnUnusableChannelIsReportedWithTheReason) {
  const Assessment without = JudgeWith({});
  const auto slow = [](double t) { return VoltageAt(t, SlowlyAt); };
  struct Case {
    tracks::BodyTrack track;
    const char* words;
  };
  const std::string row = Row("right", "triceps_long");
  for (const Case& c : {Case{Load(row, slow, 500), "500 samples per second"},
                        Case{Load(row, [](double) { return 1.5; }), "same value throughout"},
                        Case{Load(row, slow, 10), "Check the unit of the times"}}) {
    const Assessment a = JudgeWith({c.track});
    EXPECT_TRUE(a.measured.emg.channels.empty()) << c.words;
    EXPECT_NE(GapOf(a, c.words), "") << c.words;
    EXPECT_EQ(MeanOf(a, "muscles.right.largest"), MeanOf(without, "muscles.right.largest"));
  }
  const Assessment free = JudgeWith({LoadSlow(row)}, false);
  EXPECT_NE(GapOf(free, "the right arm holds no handle"), "");
}

TEST_F(MeasuredEmgTest, MissingValuesAreNotInvented) {
  // One value in a hundred is NaN, and the rows from 1 to 1.5 s are missing.
  int n = 0;
  const tracks::BodyTrack track = Load(Row("right", "triceps_long"), [&](double t) {
    if (t > 1 && t < 1.5) return std::numeric_limits<double>::infinity();
    return ++n % 100 == 0 ? std::nan("") : VoltageAt(t, SlowlyAt);
  });
  const Assessment a = JudgeWith({track});
  const MeasuredEmg& channel = a.measured.emg.channels.at(0);
  const double lost = 0.5 + 2 * kEmgSettling + kDelay;
  EXPECT_NEAR(channel.share, 1 - lost / kDuration, 0.01);
  const std::vector<PersonSample> samples = Held(MadeRun().samples());
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::isfinite(channel.measured[i])) {
      EXPECT_NEAR(channel.measured[i], SlowlyAt(samples[i].recorded), 0.02);
    }
  EXPECT_TRUE(Warns(a, "gaps that are not used: 1, of up to 0.50 s"));
  EXPECT_TRUE(Warns(a, "the recorder's clock jumped"));
}

TEST_F(MeasuredEmgTest, AContractionAboveTheMaximumIsReported) {
  const Assessment a = JudgeWith({Load(Row("right", "triceps_long"), [](double t) {
    return 1.5 * VoltageAt(t, [](double) { return 0.9; });
  })});
  EXPECT_NEAR(a.measured.emg.channels.at(0).above, 1, 1e-9);
  EXPECT_EQ(a.measured.emg.channels[0].measured[100], 1);
  EXPECT_TRUE(Warns(a, "exceeds mvc for 100.0 %"));
}

std::string ErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST_F(MeasuredEmgTest, RefusesWrongMappings) {
  const auto expect = [&](const std::string& emg, const char* words) {
    const std::string error = ErrorOf([&] { JudgeWith({LoadSlow(emg)}); });
    EXPECT_NE(error.find(words), std::string::npos) << error;
  };
  expect("  - {channel: EMG1, arm: left, muscles: [brachialis]}\n",
         "relative to a maximum voluntary contraction");
  expect("  - {channel: EMG1, arm: left, muscles: [brachialis], mvc: -1}\n", "mvc");
  expect("  - {channel: EMG1, muscles: [brachialis], mvc: 1}\n", "arm");
  expect("  - {channel: EMG1, arm: left, mvc: 1}\n", "muscles");
  expect("  - {channel: EMG9, arm: left, muscles: [brachialis], mvc: 1}\n", "EMG1");
  expect("  - {channel: EMG1, arm: left, muscles: [brachials], mvc: 1}\n",
         "Did you mean brachialis?");
  expect(Row("left", "brachialis") + Row("left", "brachialis"), "Map it once.");
}

}  // namespace
}  // namespace predictor::assessment::emg
