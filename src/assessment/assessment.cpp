#include "assessment/assessment.h"

#include <algorithm>
#include <cmath>

#include "assessment/person_chain.h"
#include "core/error.h"
#include "core/format.h"
#include "evaluation/statistics_samples.h"
#include "evaluation/stops.h"

namespace predictor::assessment {
namespace {

// Returns the smallest score that is exceeded during at most 5 % of the time. The element
// share[score] is the share of time with that score.
int ScoreExceededRarely(const std::vector<double>& share) {
  constexpr double kRounding = 1e-9;
  std::size_t score = 0;
  for (double above = 1 - share[0]; above > 0.05 + kRounding && score + 1 < share.size();)
    above -= share[++score];
  return static_cast<int>(score);
}

// Values of one quantity: values[time][person].
using Table = std::vector<std::vector<double>>;

std::vector<double> KnownOf(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values;
}

// Returns one value for each person, from that person's known values over time. The value is not a
// number if the person has no known value.
std::vector<double> OfEachPerson(const Table& table,
                                 double (*of_time)(const std::vector<double>&)) {
  std::vector<double> results;
  for (std::size_t person = 0; person < table.front().size(); ++person) {
    std::vector<double> values;
    for (const auto& row : table) values.push_back(row[person]);
    values = KnownOf(std::move(values));
    results.push_back(values.empty() ? kUnknownValue : of_time(values));
  }
  return results;
}

void AddIntervals(const SampledChain& sampled, std::span<const PersonSample> samples,
                  QuantityResult* result) {
  Table table;
  for (std::size_t k = 0; k < sampled.at.size(); ++k) {
    std::vector<double>& row = table.emplace_back();
    for (const Frame& frame : sampled.frames[k])
      row.push_back(result->kind->of({frame, samples[sampled.at[k]]}));
    const auto interval = IntervalOfKnown(row);
    result->low.push_back(interval ? interval->low : kUnknownValue);
    result->high.push_back(interval ? interval->high : kUnknownValue);
  }
  result->mean_interval =
      IntervalOfKnown(OfEachPerson(table, [](const std::vector<double>& x) { return Mean(x); }));
  result->person_tail =
      result->kind->bad == Bad::kHigh
          ? OfEachPerson(table, [](const std::vector<double>& x) { return Quantile(x, 0.95); })
          : OfEachPerson(table, [](const std::vector<double>& x) { return Quantile(x, 0.05); });
  result->tail_interval = IntervalOfKnown(result->person_tail);
}

// Uses only the times that have a value. If no time has a value, the results are not a number.
void SummariseOverTime(QuantityResult* result) {
  std::vector<double> values = KnownOf(result->values);
  if (values.empty()) values.push_back(kUnknownValue);
  result->mean = Mean(values);
  result->p5 = Quantile(values, 0.05);
  result->p95 = Quantile(values, 0.95);
  const auto [min, max] = std::ranges::minmax(values);
  result->min = min;
  result->max = max;
}

QuantityResult QuantityOf(const QuantityKind& kind, const NominalChain& nominal,
                          const SampledChain& sampled, std::span<const PersonSample> samples) {
  QuantityResult result;
  result.kind = &kind;
  for (std::size_t i = 0; i < samples.size(); ++i)
    result.values.push_back(kind.of({nominal.frames[i], samples[i]}));
  SummariseOverTime(&result);
  if (!sampled.at.empty() && kind.origin != Origin::kMeasured && !kind.nominal_only)
    AddIntervals(sampled, samples, &result);
  return result;
}

// The mean over the times with known postures.
void AddProbabilities(const SampledChain& sampled, WorksheetResult* result) {
  double times = 0;
  for (const std::vector<Frame>& frames : sampled.frames) {
    std::vector<double> scores;
    for (const Frame& frame : frames)
      if (frame.known) scores.push_back(result->kind->of(frame));
    times += scores.empty() ? 0 : 1;
    for (const double score : scores)
      result->probability[static_cast<std::size_t>(score)] +=
          1.0 / static_cast<double>(scores.size());
    scores.resize(frames.size(), kUnknownValue);
    const auto interval = IntervalOfKnown(scores);
    result->likely_low.push_back(interval ? interval->low : kUnknownValue);
    result->likely_high.push_back(interval ? interval->high : kUnknownValue);
  }
  for (double& probability : result->probability) probability /= std::max(1.0, times);
}

WorksheetResult WorksheetOf(const WorksheetKind& kind, const NominalChain& nominal,
                            const SampledChain& sampled) {
  WorksheetResult result;
  result.kind = &kind;
  const auto classes = static_cast<std::size_t>(kind.most) + 1;
  result.share.assign(classes, 0);
  result.probability.assign(sampled.at.empty() ? 0 : classes, 0);
  const auto known = static_cast<double>(std::ranges::count_if(nominal.frames, &Frame::known));
  for (const Frame& frame : nominal.frames) {
    const int score = kind.of(frame);
    result.values.push_back(score);
    if (frame.known) result.share[static_cast<std::size_t>(score)] += 1.0 / known;
  }
  result.worst = *std::max_element(result.values.begin(), result.values.end());
  result.p95 = ScoreExceededRarely(result.share);
  if (!sampled.at.empty()) AddProbabilities(sampled, &result);
  return result;
}

std::vector<double> SeriesOf(const NominalChain& nominal, double (*of)(const Frame&)) {
  std::vector<double> values;
  for (const Frame& frame : nominal.frames) values.push_back(of(frame));
  return values;
}

// Returns the load over the whole run. While no hand holds a handle, the arms hang down and rest.
std::vector<double> OverRun(const std::vector<double>& held, std::span<const PersonSample> all) {
  std::vector<double> load;
  std::size_t next = 0;
  for (const PersonSample& sample : all) load.push_back(IsHeld(sample) ? held[next++] : 0);
  return load;
}

// Returns the load over the whole run, or nothing if the load is unknown for too long. In this
// case, `what` cannot be evaluated.
std::optional<std::vector<double>> LoadOverRun(const std::string& what, const NominalChain& nominal,
                                               double (*of)(const Frame&),
                                               std::span<const PersonSample> all, Assessment* a) {
  const std::vector<double> held = SeriesOf(nominal, of);
  if (const auto whole = WithoutGaps(held)) return OverRun(*whole, all);
  const auto known = static_cast<double>(KnownOf(held).size());
  a->not_evaluable.push_back(
      {what,
       Formatted("the load is unknown for %.1f %% of the time, which is more than %.0f %%",
                 100 * (1 - known / static_cast<double>(held.size())), 100 * kMaxUnknownShare)});
  return {};
}

// Adds the damage of the run and of each lift.
void AddDamage(const Scenario& scenario, const NominalChain& nominal,
               std::span<const PersonSample> all, Assessment* a) {
  const auto add = [&](const ergonomics::DamageTool& tool, const std::string& part,
                       double (*moment)(const Frame&)) {
    auto load = LoadOverRun(std::string("damage of the ") + part + " (" + tool.name + ")", nominal,
                            moment, all, a);
    if (load) a->damage.push_back(DamageOfMoment(tool, part, *load));
    return load;
  };
  if (const auto load = add(ergonomics::kLiftTool, "lower back", LiftMoment))
    AddDamageOfLifts(all, SmoothMoment(*load), &a->lifts);
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    double (*const moment)(const Frame&) =
        hand == 0 ? [](const Frame& f) { return ShoulderMoment(f, 0); }
                  : [](const Frame& f) { return ShoulderMoment(f, 1); };
    add(ergonomics::kShoulderTool, std::string(HandName(hand)) + " shoulder", moment);
  }
}

void AddFatigue(const Scenario& scenario, const NominalChain& nominal,
                std::span<const PersonSample> all, const WorkPattern& work, Assessment* a) {
  using ergonomics::FatigueJoint;
  const auto add = [&](int hand, const char* joint, FatigueJoint kind,
                       double (*use)(const Frame&)) {
    if (!scenario.Has(hand)) return;
    if (const auto load = LoadOverRun(std::string("fatigue of the ") + joint, nominal, use, all, a))
      a->fatigue.push_back(FatigueOfLoad(joint, kind, *load, work.fatigue_trial));
  };
  add(0, "left shoulder", FatigueJoint::kShoulder,
      [](const Frame& f) { return f.shoulder_use[0]; });
  add(1, "right shoulder", FatigueJoint::kShoulder,
      [](const Frame& f) { return f.shoulder_use[1]; });
  add(0, "left elbow", FatigueJoint::kElbow, [](const Frame& f) { return f.elbow_use[0]; });
  add(1, "right elbow", FatigueJoint::kElbow, [](const Frame& f) { return f.elbow_use[1]; });
}

// Throws InputError if the place of the person is impossible, because every result would then be
// wrong. Returns the mean horizontal distance of the handles from the feet [m].
double CheckPlace(std::span<const PersonSample> samples, Assessment* a) {
  Vector3 mean = Vector3::Zero();  // mean position of the gripping hands, in S
  double hands = 0, highest = 0;
  for (const PersonSample& sample : samples)
    for (const person::HandSample& hand : sample.body.hands) {
      if (!hand.present) continue;
      const Vector3 p = a->setup.stance.X_WS.Inverse() * hand.X_WD.p;
      mean += p;
      hands += 1;
      highest = std::max(highest, p.z());
    }
  mean /= hands;
  if (mean.z() < 0)
    throw InputError(
        Formatted("The handles are %.2f m below the ground on which the operator stands. Correct "
                  "operator.stance.ground, or ground in the machine file.",
                  -mean.z()));
  if (mean.x() < 0)
    a->warnings.emplace_back("The handles are behind the operator. Check operator.stance.facing.");
  const double distance = std::hypot(mean.x(), mean.y());
  if (distance > 0.8)
    a->warnings.push_back(Formatted(
        "The handles are %.2f m away from the operator's feet. Check operator.stance.ground.",
        distance));
  return distance;
}

// Throws OutOfReach if no posture is known.
void CheckReach(const NominalChain& nominal, double distance, Assessment* a) {
  const auto unknown = static_cast<double>(
      std::ranges::count_if(nominal.frames, [](const Frame& f) { return !f.known; }));
  const double share = unknown / static_cast<double>(nominal.frames.size());
  if (share == 1) {
    const auto nearest = std::ranges::min_element(
        nominal.postures, {}, [](const person::Posture& posture) { return posture.miss(); });
    throw OutOfReach(Formatted(
        "The operator's body never reaches the handles: a hand misses its handle by at least "
        "%.2f m. The handles are %.2f m away from the operator's feet. Correct "
        "operator.stance.ground, operator.stance.facing or operator.body.",
        nearest->miss(), distance));
  }
  if (share > 0)
    a->not_evaluable.push_back(
        {Formatted("posture, loads and scores for %.1f %% of the time", 100 * share),
         Formatted("a hand of the modelled body misses its handle by more than %.0f cm",
                   100 * kLargestMiss)});
}

void AddStopWarning(const PersonRun& run, Assessment* a) {
  if (!IsLimit(run.stopped)) return;
  a->warnings.push_back(
      Formatted("The emulator stopped this run at a limit (%s). The largest values of this run are "
                "therefore only lower bounds of what the person would have experienced. The "
                "command `predictor continue` predicts the values of a run without this stop.",
                Name(run.stopped)));
}

void AddBalanceWarning(const NominalChain& nominal, Assessment* a) {
  const auto falling = std::ranges::count_if(
      nominal.frames, [](const Frame& f) { return f.loads.balance.margin < 0; });
  constexpr double kShort = 0.1;  // a person can be off balance for this time without falling [s]
  if (static_cast<double>(falling) < kShort * kSampleRate) return;
  a->warnings.push_back(Formatted(
      "The centre of pressure is outside the feet for %.1f s: a person could not stand like this.",
      static_cast<double>(falling) / kSampleRate));
}

void AddReach(const NominalChain& nominal, const SampledChain& sampled, Assessment* a) {
  std::size_t reaching = 0;
  for (const person::Posture& posture : nominal.postures) {
    reaching += posture.reached ? 1 : 0;
    a->worst_miss = std::max(a->worst_miss, posture.miss());
  }
  a->reached = static_cast<double>(reaching) / static_cast<double>(nominal.postures.size());
  double reached = 0, all = 0;
  for (const auto& frames : sampled.frames)
    for (const Frame& frame : frames) {
      reached += frame.reached ? 1 : 0;
      all += 1;
    }
  a->sampled_reached = all > 0 ? reached / all : 0;
}

void AddPictures(const NominalChain& nominal, std::span<const PersonSample> samples, bool possible,
                 Assessment* a) {
  a->worst = PictureAt(a->setup, samples, nominal, WorstSample(nominal), possible);
  constexpr std::size_t kPictures = 6;
  for (std::size_t k = 0; k < kPictures; ++k)
    a->pictures.push_back(
        PictureAt(a->setup, samples, nominal, k * (samples.size() - 1) / (kPictures - 1), false));
}

const char* DurationWords(ergonomics::LiftDuration duration) {
  constexpr const char* kWords[] = {"for at most one hour, with as much rest afterwards",
                                    "for at most two hours, with 0.3 times as much rest afterwards",
                                    "for at most eight hours, with the usual breaks"};
  return kWords[static_cast<std::size_t>(duration)];
}

const char* CouplingWords(ergonomics::Coupling coupling) {
  constexpr const char* kWords[] = {"good", "fair", "poor", "unacceptable"};
  return kWords[static_cast<std::size_t>(coupling)];
}

void AddWords(const Scenario& scenario, const WorkPattern& work, Assessment* a) {
  a->assumptions = {
      "The feet stay where operator.stance places them.",
      MeasuredSentence(a->measured),
      "The acceleration of the trunk is neglected, because the trunk moves slowly.",
      std::string("For RULA and REBA, the postures are ") + (work.repeated ? "" : "not ") +
          "repeated four times a minute and " + (work.held ? "" : "not ") +
          "held for more than a minute.",
      std::string("NIOSH's equation assumes lifts at the rate of this run, ") +
          DurationWords(work.lifting) + ", and " + CouplingWords(work.coupling) +
          " handles. REBA assumes the same handles. LM-MMH assumes a day of lifts at this rate.",
      std::string("Strength is the mean for the person's sex") +
          (work.strength == WorkPattern().strength ? "" : ", times operator.body.strength") +
          ", for flexion and extension only."};
  if (scenario.operator_.type == "virtual")
    a->assumptions.emplace_back(scenario.operator_.embodied
                                    ? "The operator was simulated with this body."
                                    : "The operator was simulated without a body.");
  if (scenario.operator_.type == "person")
    a->assumptions.emplace_back(
        "The hands held the handles throughout: real arms cannot sense whether a hand is there.");
  a->not_evaluable.push_back(
      {"raised shoulders", "the shoulder girdle does not move in the model"});
  if (scenario.operator_.type == "browser")
    a->not_evaluable.push_back({"the person at the page",
                                "a mouse moved the handles, so the posture is that of an imaginary "
                                "person who holds them"});
}

void AddLifts(std::optional<double> object_mass, const PersonRun& run, const WorkPattern& work,
              Assessment* a) {
  a->not_evaluable.push_back(
      {"pushing, pulling and carrying (LM-MMH)",
       Formatted("this method was made for people who walk at least %.1f m, and here the hands "
                 "move horizontally by at most %.2f m, while the feet stand",
                 ergonomics::kShortestHorizontal, HorizontalTravel(run.samples, a->setup.stance))});
  if (!object_mass) {
    a->not_evaluable.push_back({"lifting equations", "the mass of the object is not known"});
    return;
  }
  a->lifts = LiftsOf(run.samples, a->setup.stance,
                     {*object_mass, a->setup.body.sex, work.lifting, work.coupling});
  const LiftingJob job = JobOf(a->lifts, a->duration / 60);
  if (job.lifts > 1) a->job = job;
}

// Adds DUET if the effort of the grip was stated.
void AddHandDamage(const Scenario& scenario, std::span<const PersonSample> all,
                   const WorkPattern& work, Assessment* a) {
  if (!work.grip_effort) {
    a->not_evaluable.push_back({"DUET (hand and forearm)",
                                "the effort of the grip is not measured, and it was not stated "
                                "with --grip-effort"});
    return;
  }
  for (int hand = 0; hand < kHands; ++hand) {
    if (!scenario.Has(hand)) continue;
    const std::size_t exertions = ExertionsOf(all, static_cast<std::size_t>(hand), a->lifts);
    a->damage.push_back(DamageOfRepetitions(
        ergonomics::kHandTool, std::string(HandName(hand)) + " hand and forearm",
        static_cast<double>(exertions) * ergonomics::HandDamage(*work.grip_effort), a->duration));
    a->assumptions.push_back(
        Formatted("The %s hand exerts itself %zu times (once for each grip, or for each lift and "
                  "lowering during it) with an effort of %g of 10, which you stated.",
                  HandName(hand), exertions, *work.grip_effort));
  }
}

// Adds what you stated about the work, and what therefore cannot be evaluated.
void AddStatedWork(const WorkPattern& work, Assessment* a) {
  if (!work.grip_effort)
    a->not_evaluable.push_back({"an upper bound of the hand activity ratio (ACGIH)",
                                "the effort of the grip is not measured, and it was not stated "
                                "with --grip-effort"});
  if (!work.fatigue_trial)
    a->not_evaluable.push_back({"fatigue by trial (Peternel)",
                                "no trial of the person's endurance was stated with "
                                "--fatigue-trial"});
  else
    a->assumptions.push_back(
        Formatted("In a trial, the person held %.0f %% of strength for %.0f s, as you stated. "
                  "Each joint fatigues as in this trial (Peternel).",
                  100 * work.fatigue_trial->reference_load, work.fatigue_trial->reference_time));
}

void AddHandActivity(const Scenario& scenario, const NominalChain& nominal,
                     std::span<const PersonSample> all, const WorkPattern& work, Assessment* a) {
  for (int hand = 0; hand < kHands; ++hand)
    if (scenario.Has(hand))
      a->hand_activity.push_back(HandActivityOf(hand, all, nominal, work.grip_effort));
  AddStatedWork(work, a);
}

}  // namespace

Assessment Assess(const Scenario& scenario, std::optional<double> object_mass, const PersonRun& run,
                  const AssessOptions& options) {
  if (run.samples.empty())
    throw InputError(
        "No simulated time passed in this run, so there is nothing to evaluate. Record a run that "
        "reaches RUN.");
  std::vector<PersonSample> samples = Held(run.samples);
  if (samples.empty())
    throw InputError("No hand held a handle in this run, so there is nothing to evaluate.");
  Assessment a;
  a.scenario = scenario.name;
  a.operator_type = scenario.operator_.type;
  a.setup = SetupOf(scenario, run.handles);
  a.hands = {scenario.Has(0), scenario.Has(1)};
  a.duration = static_cast<double>(run.samples.size()) / kSampleRate;
  a.held = static_cast<double>(samples.size()) / kSampleRate;
  a.warnings = options.notes;
  const double distance = CheckPlace(samples, &a);
  AddStopWarning(run, &a);
  a.measured = AddTracks(options.tracks, a.setup, options.start_unix, &samples);
  a.warnings.insert(a.warnings.end(), a.measured.warnings.begin(), a.measured.warnings.end());
  const double share = options.intervals ? 0.3 : 1;  // share of the progress that the nominal chain
                                                     // accounts for
  WorkPattern work = options.work;
  work.strength = a.setup.body.strength;
  NominalChain nominal =
      RunNominal(a.setup, samples, work, [&](double done) { options.progress(share * done); });
  CheckReach(nominal, distance, &a);
  AddMuscles(a.setup, samples, options.arm, &a.measured.emg.channels, &nominal);
  SampledChain sampled;
  if (options.intervals)
    sampled = RunSampled(a.setup, samples, nominal, kSampledStride, work,
                         [&](double done) { options.progress(share + (1 - share) * done); });
  for (const PersonSample& sample : samples) a.times.push_back(sample.body.time);
  for (const std::size_t i : sampled.at) a.sampled_times.push_back(a.times[i]);
  for (const QuantityKind& kind : Quantities())
    if (kind.hand < 0 || scenario.Has(kind.hand))
      a.quantities.push_back(QuantityOf(kind, nominal, sampled, samples));
  for (const WorksheetKind& kind : Worksheets())
    a.worksheets.push_back(WorksheetOf(kind, nominal, sampled));
  AddReach(nominal, sampled, &a);
  AddBalanceWarning(nominal, &a);
  AddMisfit(nominal.postures, &a.measured, &a.warnings);
  AddLifts(object_mass, run, work, &a);
  AddDamage(scenario, nominal, run.samples, &a);
  AddFatigue(scenario, nominal, run.samples, work, &a);
  AddPictures(nominal, samples, options.intervals, &a);
  AddWords(scenario, work, &a);
  AddHandDamage(scenario, run.samples, work, &a);
  AddHandActivity(scenario, nominal, run.samples, work, &a);
  AddMuscleWords(nominal, &a.warnings, &a.assumptions, &a.not_evaluable);
  if (options.arm)
    a.assumptions.push_back(
        std::string("The moment arms and strengths of the muscles are those of ") +
        options.arm->name() + ", scaled to the person's upper arm.");
  AddEmgWords(a.measured.emg.channels, &a.assumptions, &a.not_evaluable);
  a.not_evaluable.insert(a.not_evaluable.end(), a.measured.emg.gaps.begin(),
                         a.measured.emg.gaps.end());
  return a;
}

}  // namespace predictor::assessment
