// Assesses what a recorded run means for the person: posture, loads, scores, lifts, damage and
// fatigue. Each result states its origin and, where the measurements do not determine the posture,
// its uncertainty.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assessment/exposure.h"
#include "assessment/hand_activity.h"
#include "assessment/lifts.h"
#include "assessment/measured_body.h"
#include "assessment/person_run.h"
#include "assessment/person_setup.h"
#include "assessment/picture.h"
#include "assessment/quantities.h"
#include "assessment/safety/safety.h"
#include "assessment/user_limits.h"
#include "core/error.h"
#include "person/posture_samples.h"

namespace predictor::assessment {

struct QuantityResult {
  const QuantityKind* kind = nullptr;
  double mean = 0, p5 = 0, p95 = 0, min = 0, max = 0;  // over time, for the nominal posture
  // 90 % intervals, over possible postures and bodies, of the mean and of the tail on the bad side.
  std::optional<person::Interval> mean_interval, tail_interval;
  std::vector<double> person_tail;  // tail of each possible person; the people are the same in all
                                    // assessments
  std::vector<double> values;       // values at Assessment::times
  std::vector<double> low, high;    // 90 % interval at Assessment::sampled_times

  // Returns the value that is exceeded (in the bad direction) for 5 % of the time: p95, or p5 if
  // low values are bad.
  double tail() const { return kind->bad == Bad::kHigh ? p95 : p5; }
  double worst() const { return kind->bad == Bad::kHigh ? max : min; }
};

struct WorksheetResult {
  const WorksheetKind* kind = nullptr;
  int worst = 0, p95 = 0;                       // scores of the nominal posture
  std::vector<double> share;                    // share of time for each score (index 0: score 0)
  std::vector<double> probability;              // probability of each score, averaged over time
  std::vector<int> values;                      // scores at Assessment::times
  std::vector<double> likely_low, likely_high;  // range of 90 % of the postures, at sampled_times
};

struct Assessment {
  std::string recording, scenario;
  std::string operator_type;                   // type of the operator, as in the scenario
  std::optional<ParticipantSpec> participant;  // filled by the caller
  PersonSetup setup;
  std::array<bool, kHands> hands = {};  // which handles the scenario has
  double duration = 0;                  // simulated [s]
  double held = 0;  // part of the duration in which a hand held a handle; only this part is judged
                    // [s]
  double reached = 0;          // share of the time in which the body reaches the handles
  double sampled_reached = 0;  // share of the time, averaged over the possible postures
  double worst_miss = 0;       // largest distance by which a hand misses its handle [m]
  std::vector<double> times, sampled_times;  // [s]
  std::vector<QuantityResult> quantities;    // quantities of existing handles, in the order of
                                             // Quantities()
  std::vector<WorksheetResult> worksheets;   // results in the order of Worksheets()
  std::vector<Lift> lifts;
  std::optional<LiftingJob>
      job;  // without a value if there are fewer than two lifts with two hands
  std::vector<DamageResult> damage;
  std::vector<FatigueResult> fatigue;
  std::vector<HandActivity> hand_activity;  // of each existing handle
  std::vector<LimitResult> limits;          // filled by JudgeUserLimits
  BodyPicture worst;                        // body at WorstSample()
  std::vector<BodyPicture> pictures;        // evenly spaced over the judged time
  std::optional<SafetyAssessment> safety;   // filled by JudgeSafety; empty: not judged
  MeasuredBody measured;                    // measurements in addition to the hands
  std::vector<std::string> warnings;        // sentences about doubtful input
  std::vector<std::string> assumptions;
  std::vector<NotEvaluable> not_evaluable;

  bool simulated() const { return operator_type == "virtual"; }  // the operator
};

struct AssessOptions {
  bool intervals = true;  // false: only the nominal posture
  WorkPattern work;
  std::shared_ptr<const muscles::ArmPaths> arm;  // the arms' muscles; null: the built-in model
  std::vector<tracks::BodyTrack> tracks;         // further measurements of the person
  double start_unix = 0;  // start of the recording, for tracks whose clock is Unix time [s]
  std::vector<std::string> notes;  // sentences about what was missing in the recording
  std::function<void(double share)> progress = [](double) {};
};

// The body never reaches the handles, so the person did not stand where the scenario states.
class OutOfReach : public InputError {
 public:
  using InputError::InputError;
};

// Judges the samples of a run. Throws InputError if the body or the place of the person is unknown,
// no adult has such a body, there are no samples, or a track does not belong to this run
// (AddTracks). Throws OutOfReach if a hand misses its handle by more than kLargestMiss at all
// times.
Assessment Assess(const Scenario& scenario, std::optional<double> object_mass, const PersonRun& run,
                  const AssessOptions& options);

inline Assessment Assess(const Scenario& scenario, std::optional<double> object_mass,
                         const SampleCollector& run, const AssessOptions& options) {
  return Assess(scenario, object_mass, RunOf(run), options);
}

}  // namespace predictor::assessment
