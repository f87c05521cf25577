#include "analysis/population/population.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/population/run_json.h"
#include "analysis/scenarios.h"
#include "core/error.h"
#include "core/random.h"
#include "evaluation/statistics_samples.h"
#include "rig/person.h"
#include "scenario/scenario_io.h"
#include "support/temporary_folder.h"

namespace predictor::population {
namespace {

std::vector<double> Of(const std::vector<SampledPerson>& people, Sex sex,
                       double (*value)(const SampledPerson&)) {
  std::vector<double> values;
  for (const SampledPerson& person : people)
    if (person.body.sex == sex) values.push_back(value(person));
  return values;
}

TEST(People, AreTheSameInAPopulationOfAnySize) {
  const auto few = SamplePopulation(5, 3), many = SamplePopulation(9, 3);
  for (std::size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i].body.height, many[i].body.height);
    EXPECT_EQ(few[i].body.strength, many[i].body.strength);
    EXPECT_EQ(few[i].hand.visual_delay, many[i].hand.visual_delay);
    EXPECT_EQ(few[i].seed, many[i].seed);
  }
  EXPECT_NE(SamplePopulation(1, 4)[0].body.height, few[0].body.height);
}

TEST(People, HaveThePublishedHeightsAndCorrelatedStrength) {
  const auto people = SamplePopulation(6000, 1);
  const auto height = [](const SampledPerson& p) { return p.body.height; };
  const auto women = Of(people, Sex::kFemale, height), men = Of(people, Sex::kMale, height);
  ASSERT_EQ(women.size(), 3000U);
  EXPECT_NEAR(Mean(women), 1.62, 4 * 0.065 / std::sqrt(3000));
  EXPECT_NEAR(Mean(men), 1.75, 4 * 0.07 / std::sqrt(3000));
  EXPECT_NEAR(SampleDeviation(women), 0.065, 0.004);
  EXPECT_NEAR(SampleDeviation(men), 0.07, 0.004);
  std::vector<double> elbow, shoulder;
  for (const SampledPerson& person : people) {
    elbow.push_back(person.body.strength[0]);
    shoulder.push_back(person.body.strength[2]);
  }
  EXPECT_NEAR(Correlation(elbow, shoulder), 0.7, 0.03);
  EXPECT_NEAR(Mean(elbow), 1, 0.02);
  EXPECT_NEAR(SampleDeviation(elbow), 0.3, 0.01);
}

TEST(People, FitIntoAScenario) {
  Scenario scenario = LoadScenario(kScenarios / "box_9kg.yaml");
  for (const SampledPerson& person : SamplePopulation(100, 1)) {
    WritePerson(person, &scenario);
    EXPECT_NO_THROW(ParseScenario(SaveScenario(scenario), "person", scenario.folder()));
  }
}

// The values are from Newcombe, Statistics in Medicine 17 (1998) 857, method 3, table I.
TEST(Share, HasThePublishedIntervals) {
  const auto check = [](int count, int of, double low, double high) {
    EXPECT_NEAR(ShareOf(count, of).low, low, 5e-5);
    EXPECT_NEAR(ShareOf(count, of).high, high, 5e-5);
  };
  check(81, 263, 0.2553, 0.3662);
  check(15, 148, 0.0624, 0.1605);
  check(0, 20, 0, 0.1611);
  check(1, 29, 0.0061, 0.1718);
  EXPECT_EQ(ShareOf(0, 0).high, 1);
  // Rounding errors do not appear in tables.
  for (const int of : {7, 9, 198, 200}) {
    EXPECT_EQ(ShareOf(0, of).low, 0) << of;
    EXPECT_EQ(ShareOf(of, of).high, 1) << of;
    EXPECT_EQ(ShareOf(of - 1, of, 1).high, 1) << of;
  }
}

// Makes up two designs. In the second design, each person's values are larger by `shift`.
PopulationStudy MadeUp(int people, double shift) {
  PopulationStudy study;
  study.people = SamplePopulation(people, 1);
  for (int d = 0; d < 2; ++d) {
    PopulationDesign design = {d == 0 ? "low" : "high", "box", 0.8 + 0.4 * d, {}};
    for (int i = 0; i < people; ++i) {
      PopulationRun run;
      run.person = i + 1;
      run.held = 2;
      for (std::size_t q = 0; q < StudyQuantities().size(); ++q)
        run.values.push_back(10 * (i % 7) + i + d * shift);
      run.rula_share[3] = 0.25;
      run.rula_share[5] = 0.75;
      design.runs.push_back(run);
    }
    study.designs.push_back(design);
  }
  return study;
}

TEST(Comparison, FindsTheShiftForTheSamePeople) {
  PopulationStudy study = MadeUp(30, 5);
  Compare(&study);
  ASSERT_EQ(study.differences.size(), StudyQuantities().size());
  for (const PairedDifference& d : study.differences) {
    EXPECT_EQ(d.a, 1U);
    EXPECT_NEAR(d.shift.estimate, 5, 1e-12);  // although the people differ by 80
    EXPECT_NEAR(d.shift.lower, 5, 1e-12);
    EXPECT_LT(d.p, 1e-6);
    EXPECT_GE(d.p_holm, d.p);
    const bool high_is_bad = StudyQuantities()[d.quantity].bad == assessment::Bad::kHigh;
    EXPECT_EQ(d.better.count, high_is_bad ? 0 : 30);
    EXPECT_EQ(d.better.of, 30);
  }
}

// Stops the runs of some people in the second design. Their values become bounds.
void StopRuns(int people, double bound, PopulationStudy* study) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(people); ++i) {
    PopulationRun& run = study->designs[1].runs[i];
    run.cause = StopCause::kForce;
    for (std::size_t q = 0; q < run.values.size(); ++q)
      run.values[q] = StudyQuantities()[q].bad == assessment::Bad::kHigh ? bound : -bound;
  }
}

TEST(Comparison, CountsPeopleWithoutAValueInNoStatistic) {
  PopulationStudy study = MadeUp(30, 5);
  StopRuns(10, 0, &study);
  study.designs[0].runs[29].values[0] = std::nan("");
  Compare(&study);
  EXPECT_EQ(study.summaries[0][0].people, 29);
  EXPECT_EQ(study.summaries[1][0].people, 30);
  EXPECT_EQ(study.summaries[1][0].stopped, 10);
  EXPECT_EQ(study.differences[0].better.of, 29);
  EXPECT_EQ(study.differences[1].better.of, 30);
}

// The values 1, 2, 3, 4, 5, of which 2 and 5 are lower bounds. By hand, the shares above 1, 3 and 4
// are 4/5, 4/5 · 2/3 = 8/15 and 8/15 · 1/2 = 4/15. Half of the people are therefore above 3 but not
// above 4, and more than 5 % are above each value.
TEST(Comparison, HasTheQuantilesOfCensoredValues) {
  PopulationStudy study = MadeUp(5, 0);
  for (std::size_t i = 0; i < 5; ++i) {
    PopulationRun& run = study.designs[0].runs[i];
    if (i == 1 || i == 4) run.cause = StopCause::kForce;
    for (std::size_t q = 0; q < run.values.size(); ++q)
      run.values[q] = (StudyQuantities()[q].bad == assessment::Bad::kHigh ? 1.0 : -1.0) *
                      static_cast<double>(i + 1);
  }
  Compare(&study);
  for (std::size_t q = 0; q < StudyQuantities().size(); ++q) {
    const bool high = StudyQuantities()[q].bad == assessment::Bad::kHigh;
    const DesignSummary& s = study.summaries[0][q];
    EXPECT_EQ(s.median.value, high ? 4 : -4) << q;
    EXPECT_FALSE(s.median.at_least);
    const CensoredValue& worst = high ? s.p95 : s.p5;
    EXPECT_TRUE(worst.at_least) << q;
    EXPECT_GE(std::abs(worst.value), 4) << q;
  }
}

// If the truth behind the bounds is anything that the bounds permit, the results of the true values
// must lie in the results of the bounds.
TEST(Comparison, CoversEveryTruthBehindStoppedRuns) {
  PopulationStudy stopped = MadeUp(30, 5);
  StopRuns(4, 12, &stopped);
  Compare(&stopped);
  RandomStream random(5, "truth");
  for (int trial = 0; trial < 20; ++trial) {
    PopulationStudy truth = stopped;
    for (PopulationRun& run : truth.designs[1].runs) {
      if (run.cause == StopCause::kNone) continue;
      run.cause = StopCause::kNone;
      for (std::size_t q = 0; q < run.values.size(); ++q)
        run.values[q] += (StudyQuantities()[q].bad == assessment::Bad::kHigh ? 1 : -1) * 200 *
                         std::pow(random.Uniform(), 3);
    }
    Compare(&truth);
    for (std::size_t i = 0; i < stopped.differences.size(); ++i) {
      const PairedDifference &bounds = stopped.differences[i], &d = truth.differences[i];
      EXPECT_LE(bounds.shift.lower, d.shift.lower);
      EXPECT_GE(bounds.shift.upper, d.shift.upper);
      EXPECT_GE(bounds.p, d.p);
      EXPECT_LE(bounds.better.low, d.better.low);
      EXPECT_GE(bounds.better.high, d.better.high);
    }
  }
}

// The complete run of a person exceeds each value for at least as long as its first part.
TEST(Comparison, BoundsOfTheFirstPartOfARunHoldForTheWholeRun) {
  assessment::Assessment whole, part;
  RandomStream random(6, "part");
  const auto kinds = assessment::Quantities();
  for (const assessment::QuantityKind& kind : kinds) {
    assessment::QuantityResult q;
    q.kind = &kind;
    for (int i = 0; i < 400; ++i) q.values.push_back(random.Normal());
    whole.quantities.push_back(q);
    q.values.resize(100);
    part.quantities.push_back(q);
  }
  whole.reached = 0.7;
  part.reached = 0.4;  // the body missed for 60 of 400 samples in the first part
  int compared = 0;
  for (const StudyQuantity& quantity : StudyQuantities()) {
    const double value = quantity.of(whole, kTailShare);
    const double bound = quantity.of(part, 4 * kTailShare);
    if (!std::isfinite(value)) continue;
    ++compared;
    if (quantity.bad == assessment::Bad::kHigh)
      EXPECT_LE(bound, value) << quantity.path;
    else
      EXPECT_GE(bound, value) << quantity.path;
  }
  EXPECT_GE(compared, 7);
}

TEST(Comparison, CountsPeopleBeyondALimit) {
  PopulationStudy study = MadeUp(30, 0);
  for (std::size_t q = 0; q < StudyQuantities().size(); ++q)
    for (std::size_t i = 0; i < 30; ++i)
      study.designs[0].runs[i].values[q] = StudyQuantities()[q].limit + (i < 6 ? 1 : -1);
  Compare(&study);
  for (std::size_t q = 0; q < StudyQuantities().size(); ++q) {
    if (!StudyQuantities()[q].has_limit()) continue;
    const bool high_is_bad = StudyQuantities()[q].bad == assessment::Bad::kHigh;
    EXPECT_EQ(study.summaries[0][q].beyond.count, high_is_bad ? 6 : 24) << q;
  }
}

// Checks that the output has each key of the schema and no other one.
void ExpectDescribed(const nlohmann::json& schema, const nlohmann::json& json) {
  if (json.is_null()) {
    EXPECT_NE(schema["type"].dump().find("null"), std::string::npos) << schema;
  } else if (json.is_object()) {
    EXPECT_EQ(schema["properties"].size(), json.size());
    for (const auto& [key, value] : json.items()) {
      ASSERT_TRUE(schema["properties"].contains(key)) << key;
      ExpectDescribed(schema["properties"][key], value);
    }
  } else if (json.is_array()) {
    EXPECT_EQ(schema["type"], "array");
    for (const auto& item : json) ExpectDescribed(schema["items"], item);
  } else {
    EXPECT_NE(schema["type"].dump().find(json.is_string() ? "string" : "n"), std::string::npos);
  }
}

TEST(Output, ContainsNoMinusZero) {
  PopulationStudy study = MadeUp(4, 0);
  for (PopulationDesign& design : study.designs)
    for (PopulationRun& run : design.runs)
      for (double& value : run.values) value = run.person == 2 ? -0.0 : -1e-9;
  Compare(&study);
  EXPECT_EQ(PersonsCsv(study).find(",-0,"), std::string::npos);
  const std::string text = PopulationText(study), page = PopulationPage(study, "1");
  for (const char* minus_zero : {" -0 ", " -0.0 ", " -0.00000 "})
    EXPECT_EQ(text.find(minus_zero), std::string::npos) << minus_zero;
  for (const char* minus_zero : {"<td>-0<", "<td>-0.0<", "<td>-0 to", " to -0<"})
    EXPECT_EQ(page.find(minus_zero), std::string::npos) << minus_zero;
}

TEST(Output, JsonFitsItsSchemaAndTablesAreComplete) {
  PopulationStudy study = MadeUp(4, 5);
  study.designs[1].runs[2].cause = StopCause::kForce;
  study.designs[1].height.reset();
  study.designs[1].runs[0].beyond_lifft = study.designs[1].runs[3].beyond_lifft = true;
  Compare(&study);
  const auto schema = nlohmann::json::parse(PopulationSchema());
  const auto json = nlohmann::json::parse(PopulationJson(study));
  ExpectDescribed(schema, json);
  EXPECT_EQ(json["designs"][1]["stopped"], 1);
  EXPECT_EQ(json["designs"][0]["beyond_lifft"], 0);
  EXPECT_EQ(json["designs"][1]["beyond_lifft"], 2);
  for (const std::string& shown : {PopulationText(study), PopulationPage(study, "1")}) {
    EXPECT_NE(shown.find("for 2 of 4 people, a load exceeds 100 N·m"), std::string::npos);
    EXPECT_EQ(shown.find("people, a load exceeds"), shown.rfind("people, a load exceeds"));
  }
  const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
  const auto quantities = static_cast<std::ptrdiff_t>(StudyQuantities().size());
  EXPECT_EQ(lines(PersonsCsv(study)), 1 + 2 * 4);
  EXPECT_EQ(lines(DesignsCsv(study)), 1 + 2 * quantities);
  EXPECT_EQ(lines(DifferencesCsv(study)), 1 + quantities);
  EXPECT_NE(PopulationText(study).find("1 of them stopped"), std::string::npos);
  const std::string page = PopulationPage(study, "1");
  EXPECT_NE(page.find("RULA"), std::string::npos);
  // The colours of the action levels run from green to dark red: scores 3 to 4 have the second of
  // four colours, and scores 5 to 6 the third.
  for (const char* bar : {"background: #d1b751\" title=\"3 to 4: investigate: 25 %\"",
                          "background: #d57623\" title=\"5 to 6: change soon: 75 %\""})
    EXPECT_NE(page.find(bar), std::string::npos) << bar;
  EXPECT_NE(page.find("one simulated person (simulated sensor)"), std::string::npos);
  const std::string caveat = "Use the compression only to compare designs.";
  EXPECT_NE(page.find(caveat), std::string::npos);
  EXPECT_NE(PopulationText(study).find(caveat), std::string::npos);
  for (const std::string& output : {DesignsCsv(study), PopulationJson(study)}) {
    EXPECT_NE(output.find("simulated sensor"), std::string::npos);
    EXPECT_EQ(output.find("measured"), std::string::npos);
  }
  // The limits of the scores are in the table.
  for (const char* limit : {"<td>&gt; 4</td>", "<td>&gt; 7</td>", "<td>&gt; 3400</td>",
                            "<td>&lt; 0.0</td>", "REBA's high risk begins at 8"})
    EXPECT_NE(page.find(limit), std::string::npos) << limit;
}

TEST(RunJson, IsReadBackOrRefused) {
  using Json = nlohmann::ordered_json;
  PopulationRun run = MadeUp(1, 0).designs[0].runs[0], found;
  run.values[2] = std::nan("");
  run.beyond_lifft = true;
  const std::string text = JsonOf(run).dump();
  const Json json = Json::parse(text);
  ASSERT_TRUE(ReadRun(json, &found));
  EXPECT_EQ(JsonOf(found).dump(), text);
  EXPECT_TRUE(std::isnan(found.values[2]));
  for (const auto& [member, value] : json.items()) {
    Json damaged = json;
    damaged[member] = "no number";
    EXPECT_FALSE(ReadRun(damaged, &found)) << member;
    damaged.erase(member);
    EXPECT_FALSE(ReadRun(damaged, &found)) << member;
  }
  Json unknown = json;
  unknown["cause"] = kStopCauses;
  EXPECT_FALSE(ReadRun(unknown, &found));
  EXPECT_EQ(JsonOf(found).dump(), text);
}

TEST(Study, RunsAndContinuesWhereItEnded) {
  const test::TemporaryFolder folder;
  PopulationOptions options;
  options.scenarios = {kScenarios / "box_9kg.yaml"};
  options.set = {"duration=1.5"};
  options.heights = {0.9, 1.2};
  options.folder = folder.path();
  options.persons = 2;
  const PopulationStudy study = MakePopulationStudy(options);
  ASSERT_EQ(study.designs.size(), 2U);
  EXPECT_EQ(study.kept, 0);
  EXPECT_NEAR(*study.designs[0].height, 0.9, 1e-9);
  // In both designs, the handles move in the same way, but their height relative to the body is
  // different.
  EXPECT_NE(study.designs[0].runs[0].values, study.designs[1].runs[0].values);
  for (const PopulationDesign& design : study.designs)
    for (const PopulationRun& run : design.runs) EXPECT_GT(run.held, 1);
  options.persons = 3;
  const PopulationStudy more = MakePopulationStudy(options);
  EXPECT_EQ(more.kept, 4);
  EXPECT_EQ(JsonOf(more.designs[1].runs[1]).dump(), JsonOf(study.designs[1].runs[1]).dump());
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "population.html"));
}

TEST(Study, RefusesAScenarioWithoutAPlaceOfTheOperator) {
  const test::TemporaryFolder folder;
  PopulationOptions options;
  options.scenarios = {kScenarios / "box_9kg.yaml"};
  options.set = {"operator.stance=null"};
  options.folder = folder.path();
  EXPECT_THROW(MakePopulationStudy(options), InputError);
}

// The left hand of a mirrored person must do what the original person's right hand does, and vice
// versa.
assessment::Assessment AssessLift(double side) {
  Scenario scenario = QuietScenario(2);
  scenario.operator_.embodied = true;
  scenario.operator_.body = BodySpec();
  scenario.operator_.stance = StanceSpec();
  ActionSpec move = MakeActionSpec("move", 0.6, {"duration=1"});
  move.Set("by=[0.05, " + std::to_string(0.1 * side) + ", 0.1]");
  scenario.operator_.script = {MakeActionSpec("grip", 0, {"duration=0.3"}), move};
  Person person(scenario);
  for (int hand = 0; hand < kHands; ++hand) {
    const double y = (hand == 0 ? 0.25 : -0.25) + 0.1 * side;
    person.input.handle[static_cast<std::size_t>(hand)].X_W = {{0.4, y, 1.0}, {1, 0, 0, 0}};
  }
  assessment::SampleCollector samples(scenario);
  std::uint64_t tick = 0;
  person.Run(2, [&] {
    TickRecord record{};
    record.tick = ++tick;
    record.run_time = person.input.run_time;
    record.ran = 1;
    for (std::size_t h = 0; h < kHands; ++h) {
      record.hands[h].present = 1;
      record.hands[h].gripping = person.output.grip[h] > 0.5;
      record.hands[h].real.pose = ToRecord(person.input.handle[h].X_W);
      for (int k = 0; k < 6; ++k)
        record.hands[h].wrench[static_cast<std::size_t>(k)] = person.output.F_H_W[h][k];
    }
    samples.Add(record);
  });
  assessment::AssessOptions how;
  how.intervals = false;
  return Assess(scenario, 9.0, samples, how);
}

TEST(Mirror, AMirroredPersonHasMirroredForcesAndTheSameScores) {
  const assessment::Assessment left = AssessLift(1), right = AssessLift(-1);
  ASSERT_EQ(left.quantities.size(), right.quantities.size());
  const auto tail = [](const assessment::Assessment& a, const std::string& path) {
    for (const assessment::QuantityResult& q : a.quantities)
      if (path == q.kind->path) return q.tail();
    ADD_FAILURE() << path;
    return 0.0;
  };
  double largest = 0;
  for (const char* name : {"hands.%s.force_n", "arms.%s.elevation_rad", "arms.%s.elbow_flexion_rad",
                           "strength.%s_shoulder"}) {
    const auto path = [&](const char* side) {
      std::string text = name;
      return text.replace(text.find("%s"), 2, side);
    };
    const double value = tail(left, path("left"));
    EXPECT_NEAR(value, tail(right, path("right")), 1e-3 * (1 + std::abs(value))) << name;
    largest = std::max(largest, std::abs(value - tail(left, path("right"))));
  }
  EXPECT_GT(largest, 0.05);  // the handles are to one side
  EXPECT_NEAR(tail(left, "lower_back.compression_n"), tail(right, "lower_back.compression_n"), 1);
  for (std::size_t w = 0; w < left.worksheets.size(); ++w)
    EXPECT_EQ(left.worksheets[w].values, right.worksheets[w].values);
}

}  // namespace
}  // namespace predictor::population
