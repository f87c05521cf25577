#include "assessment/assessment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assessment/output.h"
#include "assessment/person_chain.h"
#include "assessment/samples.h"
#include "core/error.h"
#include "core/random.h"

namespace predictor::assessment {
namespace {

Assessment Judge(double force, bool intervals = false, const BodySpec& body = {}) {
  Scenario scenario = PersonScenario();
  scenario.operator_.body = body;
  const SampleCollector run =
      Collect(scenario, 1, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, force); });
  return Assess(scenario, 9, RunOf(run), {.intervals = intervals});
}

const QuantityResult& Find(const Assessment& a, const std::string& path) {
  for (const QuantityResult& q : a.quantities)
    if (path == q.kind->path) return q;
  throw std::out_of_range(path);
}

// The force on both hands turns the upper body forward about the disc. Its lever is the horizontal
// distance from the disc to the hands. The posture does not depend on the force.
TEST(Assessment, TheBackHoldsTheForceTimesItsLever) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run =
      Collect(scenario, 1, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, 40); });
  const PersonSetup setup = SetupOf(scenario, RunOf(run).handles);
  const NominalChain chain = RunNominal(setup, run.samples(), {}, [](double) {});
  const person::BodyModel model(setup.body);
  const person::BodyVector& q = chain.postures.back().q;
  ASSERT_TRUE(chain.postures.back().reached);
  const Vector3 disc = person::Place(model, q).p[person::kTorsoFlexion];
  // the hands are 0.45 m in front of the middle of the ankles
  const double lever = 0.45 - disc.x();
  const double moment = Find(Judge(40), "lower_back.flexion_moment_nm").mean -
                        Find(Judge(0), "lower_back.flexion_moment_nm").mean;
  EXPECT_NEAR(moment, 2 * 40 * lever * std::cos(q[person::kPelvisYaw]), 1e-6);
  EXPECT_NEAR(std::abs(chain.frames.back().loads.overload[person::kTorsoFlexion]), moment, 1e-6);
}

TEST(Assessment, MeasuredForcesHaveNoIntervalAndModelledValuesHaveOne) {
  const Assessment a = Judge(20, true);
  const QuantityResult& force = Find(a, "hands.left.force_n");
  EXPECT_NEAR(force.mean, 20, 1e-9);
  EXPECT_FALSE(force.tail_interval);
  for (const QuantityResult& q : a.quantities) {
    if (q.kind->origin == Origin::kMeasured || q.kind->nominal_only) continue;
    ASSERT_TRUE(q.tail_interval) << q.kind->path;
    EXPECT_LT(q.tail_interval->low, q.tail_interval->high) << q.kind->path;
  }
  for (const WorksheetResult& w : a.worksheets) {
    double sum = 0, time = 0;
    for (const double p : w.probability) sum += p;
    for (const double p : w.share) time += p;
    EXPECT_NEAR(sum, 1, 1e-9) << w.kind->name;
    EXPECT_NEAR(time, 1, 1e-9) << w.kind->name;
  }
}

TEST(Assessment, AHigherForceScoresNoBetter) {
  const Assessment light = Judge(5), heavy = Judge(120);
  for (std::size_t i = 0; i < light.worksheets.size(); ++i)
    EXPECT_LE(light.worksheets[i].worst, heavy.worksheets[i].worst);
  EXPECT_GT(heavy.worksheets[0].worst, light.worksheets[0].worst);
}

// The hands push against each other. The worksheets do not count this squeezing force as a load.
TEST(Assessment, ASqueezeIsNotALoad) {
  Scenario scenario = PersonScenario();
  const auto judge = [&](double inward) {
    const SampleCollector run = Collect(scenario, 1, [&](std::uint64_t tick) {
      TickRecord record = RecordOf(tick, 1.0, 5);
      record.hands[0].wrench[1] = inward;  // the left hand is at −y
      record.hands[1].wrench[1] = -inward;
      return record;
    });
    return Assess(scenario, 9, RunOf(run), {.intervals = false});
  };
  EXPECT_EQ(judge(60).worksheets[0].worst, judge(0).worksheets[0].worst);
  EXPECT_EQ(judge(60).worksheets[2].worst, judge(0).worksheets[2].worst);
}

// A step of force within 0.1 s is a shock, but noise of 3 N is not.
TEST(Assessment, OnlyARealStepOfForceIsAShock) {
  const Scenario scenario = PersonScenario();
  const auto worst = [&](double step, double noise) {
    RandomStream random(3, "noise");
    const SampleCollector run = Collect(scenario, 2, [&](std::uint64_t tick) {
      return RecordOf(tick, 1.0, 2 + (tick > 1000 ? step : 0) + noise * random.Normal());
    });
    return Assess(scenario, 9, RunOf(run), {.intervals = false}).worksheets[1].worst;
  };
  EXPECT_EQ(worst(0, 3), worst(0, 0));
  EXPECT_GT(worst(45, 0), worst(20, 0));
}

TEST(Assessment, WarnsAboutAnImpossiblePlace) {
  Scenario scenario = PersonScenario();
  const auto judge = [&] {
    const SampleCollector run =
        Collect(scenario, 0.5, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, 5); });
    return Assess(scenario, 9, RunOf(run), {.intervals = false});
  };
  EXPECT_TRUE(judge().warnings.empty());
  scenario.operator_.stance->facing = 0;
  ASSERT_FALSE(judge().warnings.empty());
  EXPECT_NE(judge().warnings[0].find("behind the operator"), std::string::npos);
  scenario.operator_.stance->ground.z() = kGround + 1.5;
  EXPECT_THROW(judge(), InputError);
}

// Nothing is concluded from a posture in which the hands are not at the handles.
TEST(Assessment, AnAbsurdPlaceIsRefused) {
  Scenario scenario = PersonScenario();
  const SampleCollector run =
      Collect(scenario, 0.2, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, 5); });
  for (const double distance : {2.0, 100.0}) {
    scenario.operator_.stance->ground.x() = 0.5 + distance;
    try {
      Assess(scenario, 9, RunOf(run), {.intervals = false});
      FAIL() << distance << " m";
    } catch (const OutOfReach& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find(distance == 2 ? "2.00 m away" : "100.00 m away"), std::string::npos)
          << text;
      EXPECT_NE(text.find("operator.stance.ground"), std::string::npos) << text;
    }
  }
}

// For a tenth of the time, the handles are 3 m to the side.
Assessment JudgeWithJump(bool intervals) {
  const Scenario scenario = PersonScenario();
  const SampleCollector run = Collect(scenario, 2, [&](std::uint64_t tick) {
    // Lost ticks before and after it keep the smoothed motion free of the jumps.
    const std::uint64_t lost = tick > 1200 ? 1000 : tick > 1000 ? 500 : 0;
    TickRecord record = RecordOf(tick + lost, 1.0, 20);
    if (tick > 1000 && tick <= 1200)
      for (HandRecord& hand : record.hands) hand.real.pose.p[1] += 3;
    return record;
  });
  return Assess(scenario, 9, RunOf(run), {.intervals = intervals});
}

TEST(Assessment, APostureThatMissesTheHandlesHasNoValues) {
  const Assessment a = JudgeWithJump(true);
  for (const QuantityResult& q : a.quantities) {
    if (q.kind->origin == Origin::kMeasured) continue;
    EXPECT_FALSE(std::isfinite(q.values[110])) << q.kind->path;
    EXPECT_TRUE(std::isfinite(q.values[50])) << q.kind->path;
    EXPECT_TRUE(std::isfinite(q.mean)) << q.kind->path;
  }
  // The mean does not contain the part without values: it is the mean of a still posture.
  EXPECT_NEAR(Find(a, "trunk.flexion_rad").mean, Find(Judge(20), "trunk.flexion_rad").mean, 1e-6);
  EXPECT_EQ(a.worksheets[0].values[110], 0);
  EXPECT_EQ(a.worksheets[0].share[0], 0);
  EXPECT_EQ(a.worksheets[0].probability[0], 0);
  const auto gap = [&](const char* what) {
    return std::ranges::any_of(a.not_evaluable, [&](const NotEvaluable& n) {
      return n.what.find(what) != std::string::npos;
    });
  };
  EXPECT_TRUE(gap("posture, loads and scores for 10.0 % of the time"));
  // A tenth is too long for the damage, which has no value for a part of the time.
  EXPECT_TRUE(a.damage.empty());
  EXPECT_TRUE(a.fatigue.empty());
  EXPECT_TRUE(gap("damage of the lower back (LiFFT)"));
  EXPECT_TRUE(gap("fatigue of the left elbow"));
  EXPECT_EQ(AssessmentCsv(a).find("nan"), std::string::npos);
  EXPECT_EQ(AssessmentPage(a, "").find(">nan"), std::string::npos);
}

// The output must omit the quantities of a handle that the scenario does not have.
TEST(Assessment, OneHandHasNoRightSide) {
  Scenario scenario = PersonScenario();
  scenario.right_handle.reset();
  const SampleCollector run = Collect(scenario, 0.5, [&](std::uint64_t tick) {
    TickRecord record = RecordOf(tick, 1.0, 5);
    record.hands[1] = {};
    return record;
  });
  const Assessment a = Assess(scenario, 9, RunOf(run), {.intervals = false});
  for (const QuantityResult& q : a.quantities) EXPECT_NE(q.kind->hand, 1) << q.kind->path;
  for (const FatigueResult& f : a.fatigue) EXPECT_EQ(f.joint.find("right"), std::string::npos);
}

TEST(Assessment, RefusesAnAbsurdBodyAndAnEmptyRun) {
  EXPECT_THROW(Judge(0, false, {.height = 5, .mass = 75}), InputError);
  const Scenario scenario = PersonScenario();
  EXPECT_THROW(Assess(scenario, 9, RunOf(SampleCollector(scenario)), {}), InputError);
}

TEST(Assessment, StatesWhatCouldNotBeJudged) {
  Scenario scenario = PersonScenario();
  const SampleCollector run =
      Collect(scenario, 1, [&](std::uint64_t tick) { return RecordOf(tick, 1.0, 5); });
  const Assessment a = Assess(scenario, {}, RunOf(run), {.intervals = false});
  bool lifting = false;
  for (const NotEvaluable& n : a.not_evaluable) lifting = lifting || n.what == "lifting equations";
  EXPECT_TRUE(lifting);
}

// If the same person's hands exert more force, the load on the person's back is larger in every
// posture.
TEST(Assessment, DesignsAreComparedForTheSamePossiblePersons) {
  const Comparison comparison = Compare(Judge(5, true), Judge(40, true));
  for (const Difference& d : comparison.differences) {
    if (std::string(d.kind->path) != "lower_back.flexion_moment_nm") continue;
    ASSERT_TRUE(d.interval);
    EXPECT_LT(d.interval->high, 0);
    EXPECT_NEAR(*d.share_better, 1, 1e-9);
    // The interval of the difference must be narrower than it would be for independent people.
    const person::Interval heavy = *Find(Judge(40, true), d.kind->path).tail_interval;
    EXPECT_LT(d.interval->high - d.interval->low, heavy.high - heavy.low);
  }
  EXPECT_THROW(Compare(Judge(5), Judge(5, false, {.height = 1.6, .mass = 60})), InputError);
}

// The text and the page name both runs, and state what the sign of a difference means. The drawing
// of a negative difference is to the left of zero.
TEST(Assessment, AComparisonNamesBothRunsAndIsTheFirstChapterOfThePage) {
  Assessment light = Judge(5, true), heavy = Judge(40, true);
  light.recording = "light.mcap";
  heavy.recording = "heavy.mcap";
  const Comparison comparison = Compare(light, heavy);
  const std::string text = ComparisonText(comparison);
  const std::string page = AssessmentPage(light, "1.0", &comparison);
  for (const char* words : {"light compared with heavy", "light − heavy (90 %)",
                            "light is better for", "the value of light is larger"}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
  const std::size_t chapter = page.find("Compared with heavy.mcap");
  ASSERT_NE(chapter, std::string::npos);
  EXPECT_LT(chapter, page.find("Summary of light.mcap"));
  // All people have a smaller moment with the smaller force. The zero is at 65 px.
  const std::size_t row = page.find("moment caused by the hands", chapter);
  const std::size_t dot = page.find("<circle cx=\"", row);
  ASSERT_NE(dot, std::string::npos);
  EXPECT_LT(std::stod(page.substr(dot + 12)), 65);
  EXPECT_EQ(AssessmentPage(light, "1.0").find("Compared with"), std::string::npos);
  heavy.recording = "light.person.csv";
  light.recording = "light.person.csv";
  EXPECT_EQ(ComparisonTitle(Compare(light, heavy)),
            "light.person (first) compared with light.person (second)");
}

// The designs differ in the object's mass, a key, and by 32 cm in the height of the handles.
TEST(Assessment, AComparisonStatesWhatTheDesignsDifferIn) {
  Assessment light = Judge(5), heavy = Judge(40);
  light.recording = "light.mcap";
  heavy.recording = "heavy.mcap";
  Comparison comparison = Compare(light, heavy);
  const ComparedDesign a = {
      .name = "", .scenario = PersonScenario(), .object_mass = 9, .handle_height = 1.01};
  ComparedDesign b = a;
  b.object_mass = 18;
  b.handle_height = 1.33;
  b.scenario->environment.friction = 0.25;
  AddDesigns(a, b, &comparison);
  const std::string text = ComparisonText(comparison), html = ComparisonHtml(comparison);
  for (const char* words :
       {"mass of the object: 9 kg in light, 18 kg in heavy",
        "height of the handles at the start: 1.010 m in light, 1.330 m in heavy",
        "environment.friction: ", "0.25 in heavy",
        "Warning: The handles of heavy start 32 cm higher above the ground than those of light."}) {
    EXPECT_NE(text.find(words), std::string::npos) << words;
    EXPECT_NE(html.find(words), std::string::npos) << words;
  }
  b.handle_height = a.handle_height + 0.049;
  EXPECT_EQ(HandleHeightWarning(a, b), "");
  b.handle_height = a.handle_height - 0.051;
  EXPECT_NE(HandleHeightWarning(a, b).find("5 cm lower"), std::string::npos);
  EXPECT_TRUE(DesignDifferences(a, a).empty());
}

// Where the limit of the compression appears, its caveat does, too: with the picture, the table and
// the plot of the page, and in the text.
TEST(Assessment, TheLimitOfTheCompressionHasACaveat) {
  const Assessment a = Judge(20);
  EXPECT_NE(AssessmentText(a).find(kCompressionCaveat), std::string::npos);
  const std::string page = AssessmentPage(a, "1.0");
  const std::string words = "Use the compression only to compare designs.";
  std::size_t times = 0;
  for (std::size_t at = page.find(words); at != std::string::npos; at = page.find(words, at + 1))
    ++times;
  EXPECT_EQ(times, 3U);
}

// A simulated run measures nothing: its sensors are simulated.
TEST(Assessment, ASimulatedRunHasSimulatedSensors) {
  Assessment a = Judge(20);
  a.safety.emplace();
  for (const bool simulated : {true, false}) {
    a.operator_type = simulated ? "virtual" : "person";
    a.safety->simulated = simulated;
    for (const std::string& output : {AssessmentText(a), AssessmentPage(a, "1.0")}) {
      EXPECT_EQ(output.find("imulated sensor") != std::string::npos, simulated);
      EXPECT_EQ(output.find("What the hands felt (measured)") == std::string::npos, simulated);
    }
  }
}

// The possible postures decide about the advice. Probabilities: 27 % for 1, 8 % for 2, 38 % for 3
// and 27 % for 4, while the nominal posture has the score 2 all the time.
TEST(Assessment, TheProbableScoreComesBeforeTheNominalOne) {
  Assessment a = Judge(20);
  WorksheetResult& reba = *std::ranges::find_if(
      a.worksheets, [](const auto& w) { return std::string(w.kind->name) == "REBA"; });
  reba.worst = reba.p95 = 2;
  const std::string alone = Sentence(reba);
  EXPECT_NE(alone.find("no advice follows"), std::string::npos) << alone;
  EXPECT_EQ(alone.find(reba.kind->action(2).sentence), std::string::npos) << alone;
  reba.probability.assign(static_cast<std::size_t>(reba.kind->most) + 1, 0);
  reba.probability[1] = 0.27;
  reba.probability[2] = 0.08;
  reba.probability[3] = 0.38;
  reba.probability[4] = 0.27;
  EXPECT_EQ(Sentence(reba).find("REBA: probably 3 (90 %: 1 to 4). "), 0U) << Sentence(reba);
  EXPECT_NE(AssessmentPage(a, "1.0").find("REBA: probably 3 (90 %: 1 to 4). "), std::string::npos);
  // A tail of 4 % is outside the range of 90 %. A tail of 6 % with a higher action level has its
  // own advice.
  reba.probability = {0, 0.04, 0.06, 0.86, 0.04};
  reba.probability.resize(static_cast<std::size_t>(reba.kind->most) + 1);
  EXPECT_EQ(Sentence(reba).find("REBA: probably 3 (90 %: 2 to 3). "), 0U) << Sentence(reba);
  reba.probability[3] = 0.84;
  reba.probability[4] = 0;
  reba.probability[8] = 0.06;
  EXPECT_NE(Sentence(reba).find("With a score of 8: "), std::string::npos) << Sentence(reba);
}

// ---- output -----------------------------------------------------------------------------------

using Json = nlohmann::json;

// Checks that each member of `value` is described and that each required member exists.
void ExpectDescribed(const Json& value, const Json& schema, const std::string& path) {
  if (value.is_object() && schema.contains("properties")) {
    for (const auto& [key, member] : value.items()) {
      ASSERT_TRUE(schema["properties"].contains(key)) << path << '/' << key;
      ExpectDescribed(member, schema["properties"][key], path + '/' + key);
    }
    for (const auto& key : schema["required"])
      EXPECT_TRUE(value.contains(key.get<std::string>())) << path << '/' << key;
  }
  if (value.is_array() && schema.contains("items"))
    for (const Json& item : value) ExpectDescribed(item, schema["items"], path + "/…");
}

TEST(AssessmentOutput, ConformsToItsSchema) {
  const Json schema = Json::parse(AssessmentSchema());
  Assessment judged = Judge(20, true);
  JudgeUserLimits(ParseUserLimits("edition,ours\nquantity,limit,unit,allowed_s,clause\n"
                                  "trunk.flexion_rad,20,deg,0,1\n",
                                  "limits.csv"),
                  &judged);
  const Json json = Json::parse(AssessmentJson(judged));
  EXPECT_EQ(json["limits"].size(), 1u);
  ExpectDescribed(json, schema, "");
  const Assessment light = Judge(5, true), heavy = Judge(40, true);
  const Comparison comparison = Compare(light, heavy);
  ExpectDescribed(Json::parse(AssessmentJson(light, &comparison)), schema, "");
  EXPECT_EQ(json["quantities"]["hands.left.force_n"]["origin"], "measured");
  EXPECT_NEAR(json["quantities"]["hands.left.force_n"]["mean"].get<double>(), 20, 1e-9);
}

TEST(AssessmentOutput, TheJobOfSeveralRecordingsConformsToItsSchema) {
  const Json schema = Json::parse(LiftingJobSchema());
  Lift lift;
  lift.task = {.mean_load = 9, .max_load = 9, .origin = {0.4, 0.8, 0}, .destination = {0.4, 1, 0}};
  lift.vertical_force = 45;
  const std::vector<RecordedLifts> both = {{"a.mcap", "K7QM2XPX", 0.2, {lift}},
                                           {"b.mcap", "", 0.3, {lift, lift}}};
  const Json json = Json::parse(LiftingJobJson(both));
  ExpectDescribed(json, schema, "");
  EXPECT_EQ(json["lifting_job"]["lifts"], 3);
  EXPECT_NEAR(json["lifting_job"]["duration_min"].get<double>(), 0.5, 1e-12);
  const std::vector<Lift> lifts(3, lift);
  EXPECT_EQ(json["lifting_job"]["unassisted_composite_lifting_index"],
            JobOf(lifts, 0.5).unassisted);
  EXPECT_TRUE(Json::parse(LiftingJobJson(std::span(both).first(1)))["lifting_job"].is_null());
  const std::string csv = LiftingJobCsv(both);
  EXPECT_EQ(std::ranges::count(csv, '\n'), 4);
  EXPECT_NE(csv.find("a.mcap,K7QM2XPX,"), std::string::npos) << csv;
}

TEST(AssessmentOutput, CsvHasARowForEachTimeAndEqualColumns) {
  const Assessment a = Judge(20, true);
  const std::string csv = AssessmentCsv(a);
  std::vector<long> commas;
  std::size_t begin = 0;
  for (std::size_t end; (end = csv.find('\n', begin)) != std::string::npos; begin = end + 1)
    commas.push_back(std::count(csv.begin() + static_cast<long>(begin),
                                csv.begin() + static_cast<long>(end), ','));
  ASSERT_EQ(commas.size(), a.times.size() + 1);
  for (const long n : commas) EXPECT_EQ(n, commas[0]);
}

TEST(AssessmentOutput, TextAndPageLabelEveryNumber) {
  const Assessment a = Judge(20, true);
  const std::string text = AssessmentText(a), page = AssessmentPage(a, "1.0");
  for (const QuantityResult& q : a.quantities) {
    if (!q.kind->has_row()) continue;  // the title of the joints' table labels them
    const std::size_t row = text.find(q.kind->label);
    ASSERT_NE(row, std::string::npos) << q.kind->label;
    const std::string line = text.substr(row, text.find('\n', row) - row);
    EXPECT_TRUE(line.ends_with(Name(q.kind->origin, a.simulated()))) << line;
    EXPECT_NE(page.find(q.kind->label), std::string::npos) << q.kind->label;
  }
  for (const char* word : {"(standard)", "(modelled)", "Not evaluable", "simulated"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
    EXPECT_NE(page.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace predictor::assessment
