// The state of the person at one time of a run: posture, loads, scores and damage. The evaluator
// reports this state.
//
// The page, the recording and the page's TypeScript are derived from the tables in this file.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace predictor {

enum class PersonStatus : std::uint8_t {
  kJudged,
  kWaiting,      // no simulated time has passed yet
  kNoHand,       // no hand holds a handle, so the posture is unknown
  kBelowGround,  // the handles are below the ground: operator.stance.ground is wrong
};
inline constexpr std::array kPersonStatusNames = {"judged", "waiting", "no_hand", "below_ground"};

// The origin of the head of the nominal posture.
enum class HeadSource : std::uint8_t {
  kModelled,    // follows from the hands
  kMeasured,    // by the headset
  kImpossible,  // modelled, because this person's head cannot be where the headset measured it
};
inline constexpr std::array kHeadSourceNames = {"modelled", "measured", "impossible"};

// Measurements that other systems send during the run (core/stream_sample.h).
enum class PersonInput : std::uint8_t { kLeftElbow, kRightElbow, kLeftEmg, kRightEmg, kHeartRate };
inline constexpr std::array kPersonInputNames = {"left_elbow", "right_elbow", "left_emg",
                                                 "right_emg", "heart_rate"};
inline constexpr std::size_t kPersonInputs = kPersonInputNames.size();
enum class InputStatus : std::uint8_t {
  kNone,        // no stream measures it
  kMeasured,    // by a stream
  kMissing,     // a stream should measure it, but there is no present value
  kImpossible,  // it is not used, because it cannot belong to this person
};
inline constexpr std::array kInputStatusNames = {"none", "measured", "missing", "impossible"};

// Points of the body, for drawing. Most are joints. The points of the eyes and of the head are at
// their centres. The point of the hand is at the knuckles, and the point of the toes is at the
// front of the foot, on the ground.
enum class BodyPoint : std::uint8_t {
  kPelvis,  // middle of the hip joints
  kL5S1,
  kNeck,  // C7
  kHead,
  kEyes,
  kLeftShoulder,
  kLeftElbow,
  kLeftWrist,
  kLeftHand,
  kRightShoulder,
  kRightElbow,
  kRightWrist,
  kRightHand,
  kLeftHip,
  kLeftKnee,
  kLeftAnkle,
  kLeftToes,
  kRightHip,
  kRightKnee,
  kRightAnkle,
  kRightToes,
};
inline constexpr std::array kBodyPointNames = {
    "pelvis",     "l5s1",        "neck",      "head",           "eyes",        "left_shoulder",
    "left_elbow", "left_wrist",  "left_hand", "right_shoulder", "right_elbow", "right_wrist",
    "right_hand", "left_hip",    "left_knee", "left_ankle",     "left_toes",   "right_hip",
    "right_knee", "right_ankle", "right_toes"};
inline constexpr std::size_t kBodyPoints = kBodyPointNames.size();
static_assert(kBodyPoints == static_cast<std::size_t>(BodyPoint::kRightToes) + 1);

// Parts of the body for which a load is computed.
enum class BodyPart : std::uint8_t {
  kLowerBack,
  kLeftShoulder,
  kRightShoulder,
  kLeftElbow,
  kRightElbow
};
inline constexpr std::array kBodyPartNames = {"lower_back", "left_shoulder", "right_shoulder",
                                              "left_elbow", "right_elbow"};
inline constexpr std::size_t kBodyParts = kBodyPartNames.size();

// Limits for L5/S1 [N], and their sources.
inline constexpr double kCompressionLimit = 3400, kShearLimit = 700;
inline constexpr const char* kCompressionLimitName = "NIOSH's limit for compression";
inline constexpr const char* kShearLimitName = "Gallagher & Marras's limit for frequent shear";
// The absolute compression of the model deviates from measurements by up to a factor of two.
inline constexpr const char* kCompressionCaveat =
    "The model is too uncertain for NIOSH's limit. Use the compression only to compare designs.";

// Values for the nominal posture, each with an interval that covers the possible postures.
enum class PersonGauge : std::uint8_t {
  kCompression,
  kShear,
  kMoment,
  kBalance,
  kTrunkFlexion,
  kLeftShoulderUse,
  kRightShoulderUse,
  kLeftElbowUse,
  kRightElbowUse,
  kLeftHandForce,
  kRightHandForce,
  kLeftActivation,
  kRightActivation,
  kLeftStiffness,
  kRightStiffness,
};
enum class GaugeSource : std::uint8_t {
  kMeasured,  // by the sensors of the arms
  kModelled,  // with an interval
  kMuscles,   // modelled by the muscles of the nominal posture alone, so without an interval
};
inline constexpr std::array kGaugeSourceNames = {"measured", "modelled", "muscles"};
struct PersonGaugeRow {
  const char *name, *unit, *meaning;
  double limit;  // 0: none, except for balance
  bool low_is_bad;
  GaugeSource source;
  int hand = -1;  // the hand that the gauge belongs to; −1: neither
};
inline constexpr std::array kPersonGaugeRows = {
    PersonGaugeRow{
        "lower_back_compression", "N",
        "compression of the disc L5/S1; too uncertain for the limit, so only for comparisons",
        kCompressionLimit, false, GaugeSource::kModelled},
    PersonGaugeRow{"lower_back_shear", "N", "forward shear of L5/S1", kShearLimit, false,
                   GaugeSource::kModelled},
    PersonGaugeRow{"lower_back_moment", "N m", "moment of the extensors of the back about L5/S1", 0,
                   false, GaugeSource::kModelled},
    PersonGaugeRow{
        "balance_margin", "m",
        "distance from the centre of pressure to the edge of the feet; negative: outside", 0, true,
        GaugeSource::kModelled},
    PersonGaugeRow{"trunk_flexion", "rad", "angle of the torso to the vertical, forward", 0, false,
                   GaugeSource::kModelled},
    PersonGaugeRow{"left_shoulder_use", "",
                   "torque divided by the mean strength of this sex, flexion", 1, false,
                   GaugeSource::kModelled, 0},
    PersonGaugeRow{"right_shoulder_use", "",
                   "torque divided by the mean strength of this sex, flexion", 1, false,
                   GaugeSource::kModelled, 1},
    PersonGaugeRow{"left_elbow_use", "", "torque divided by the mean strength of this sex", 1,
                   false, GaugeSource::kModelled, 0},
    PersonGaugeRow{"right_elbow_use", "", "torque divided by the mean strength of this sex", 1,
                   false, GaugeSource::kModelled, 1},
    PersonGaugeRow{"left_hand_force", "N", "magnitude of the force on the handle", 0, false,
                   GaugeSource::kMeasured, 0},
    PersonGaugeRow{"right_hand_force", "N", "magnitude of the force on the handle", 0, false,
                   GaugeSource::kMeasured, 1},
    PersonGaugeRow{"left_arm_activation", "", "largest activation of a muscle", 0, false,
                   GaugeSource::kMuscles, 0},
    PersonGaugeRow{"right_arm_activation", "", "largest activation of a muscle", 0, false,
                   GaugeSource::kMuscles, 1},
    PersonGaugeRow{"left_hand_stiffness", "N/m", "smallest principal stiffness; a lower bound", 0,
                   false, GaugeSource::kMuscles, 0},
    PersonGaugeRow{"right_hand_stiffness", "N/m", "smallest principal stiffness; a lower bound", 0,
                   false, GaugeSource::kMuscles, 1},
};
inline constexpr std::size_t kPersonGauges = kPersonGaugeRows.size();

// Worksheets. A class is an action level of the worksheet. Level 1 is the lowest.
struct PersonScoreRow {
  const char* name;
  int most;     // highest score
  int classes;  // action levels
};
inline constexpr std::array kPersonScoreRows = {
    PersonScoreRow{"rula", 7, 4}, PersonScoreRow{"reba", 15, 5}, PersonScoreRow{"owas", 4, 4}};
inline constexpr std::size_t kPersonScores = kPersonScoreRows.size();
inline constexpr std::size_t kMaxClasses = 5;

// Warnings, as bits. A warning begins when its value has been at or beyond `on` for kWarnAfter. The
// warning ends when the value has returned past `off` for kCalmAfter. Both times are design
// choices.
enum class PersonWarning : std::uint8_t {
  kCompression,
  kShear,
  kBalance,
  kLeftShoulder,
  kRightShoulder,
  kLeftElbow,
  kRightElbow,
  kRula,
  kReba,
  kOwas,
  kReach,
};
struct PersonWarningRow {
  const char* name;
  double on, off;  // if on < off, low values are bad
  const char* words;
};
// The warning about a joint begins at half of the mean strength. If the standard deviation of the
// strength is 0.3 times its mean, one person in twenty is at most this strong. The warning of a
// worksheet begins at its highest action level.
inline constexpr double kUseWarning = 0.5, kUseCalm = 0.4;
inline constexpr std::array kPersonWarningRows = {
    PersonWarningRow{"lower_back_compression", kCompressionLimit, 3100,
                     "The compression of the lower back is above 3400 N."},
    PersonWarningRow{"lower_back_shear", kShearLimit, 640,
                     "The shear of the lower back is above 700 N."},
    PersonWarningRow{"balance", 0, 0.01,
                     "The centre of pressure is outside the feet: this person must step or lean."},
    PersonWarningRow{"left_shoulder", kUseWarning, kUseCalm,
                     "The left shoulder needs more than half of the mean strength."},
    PersonWarningRow{"right_shoulder", kUseWarning, kUseCalm,
                     "The right shoulder needs more than half of the mean strength."},
    PersonWarningRow{"left_elbow", kUseWarning, kUseCalm,
                     "The left elbow needs more than half of the mean strength."},
    PersonWarningRow{"right_elbow", kUseWarning, kUseCalm,
                     "The right elbow needs more than half of the mean strength."},
    PersonWarningRow{"rula", 4, 3, "RULA requires immediate changes."},
    PersonWarningRow{"reba", 5, 4, "REBA requires immediate action."},
    PersonWarningRow{"owas", 4, 3, "OWAS requires immediate changes."},
    PersonWarningRow{"reach", 1, 0, "The body does not reach the handles."},
};
inline constexpr std::size_t kPersonWarnings = kPersonWarningRows.size();
inline constexpr double kWarnAfter = 0.1, kCalmAfter = 1;  // [s]

// The representation of an unknown value.
inline constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct GaugeState {
  float value = kUnknown;                 // of the nominal posture, in the unit of its row
  float low = kUnknown, high = kUnknown;  // 90 % interval, at PersonState::interval_time
};
struct ScoreState {
  std::uint8_t score = 0;  // of the nominal posture; 0: not known
  std::uint8_t level = 0;  // its action level
  std::uint16_t reserved = 0;
  // Share of the possible people at each action level, at interval_time. The first element belongs
  // to level 1.
  std::array<float, kMaxClasses> probability = {kUnknown, kUnknown, kUnknown, kUnknown, kUnknown};
};
struct PartState {
  // Loads that determine the colours. For the lower back, the load is the compression divided by
  // its limit; for the other parts, the load is the torque divided by the mean strength.
  float load = kUnknown;
  float capacity = kUnknown;   // strength that remains despite fatigue (3CC-r), as a share
  float damage = kUnknown;     // of the run so far: LiFFT for the lower back, Shoulder Tool
  float day_share = kUnknown;  // the same as a share of the tool's reference day
  // Largest load of the run, as a share of the largest load in the tool's range. If it is above 1,
  // the damage is extrapolated. Unknown if the tool has no such limit.
  float load_over_range = kUnknown;
};

struct InputState {
  InputStatus status = InputStatus::kNone;
  std::array<std::uint8_t, 3> reserved = {};
  float last = kUnknown;  // run time of the last value [s]; unknown: there was none
};

// Times are simulated times since RUN began [s]. Loads and scores are older than the points by the
// evaluator's delay, because accelerations need later samples.
struct PersonState {
  std::uint64_t tick = 0;     // newest tick that was evaluated
  std::uint64_t wall_ns = 0;  // monotonic clock at that tick
  double run_time = 0;        // of the points: middle of the 10 ms that end with that tick
  double load_time = 0;       // of loads, scores, warnings
  double interval_time = 0;   // of intervals and probabilities; not valid until there are some
  double since = 0;           // start of damage and fatigue: start of the run, or of the evaluator
  PersonStatus status = PersonStatus::kWaiting;
  std::uint8_t reached = 0;          // 1: in this posture, both hands reach their handles
  std::uint16_t warnings = 0;        // bits by PersonWarning
  float miss = 0;                    // largest distance by which a hand misses its handle [m]
  float sampled_reached = kUnknown;  // share of the possible people who reach both handles
  HeadSource head = HeadSource::kModelled;  // of the points
  std::array<std::uint8_t, 3> reserved = {};
  float heart_rate = kUnknown;  // newest measured value [1/min]
  std::array<InputState, kPersonInputs> inputs;
  std::array<std::array<float, 3>, kBodyPoints> points = {};  // in W [m]; see status
  std::array<PartState, kBodyParts> parts;
  std::array<GaugeState, kPersonGauges> gauges;
  std::array<ScoreState, kPersonScores> scores;
};

constexpr bool Has(const PersonState& state, PersonWarning warning) {
  return (state.warnings >> static_cast<unsigned>(warning) & 1U) != 0;
}

// Calls the visitor for each quantity of a state, in the order of the message. Methods:
//   Number(name, unit, meaning, x)      null if it is not finite
//   Flag(name, meaning, x)
//   Word(name, meaning, names, index)   one of the names
//   Words(name, meaning, names, bits)   a list of the names
//   Vector(name, meaning, x, known)     three numbers [m], or null
//   List(name, meaning, x, count)       `count` numbers, or null if the first is not finite
//   Group(name, meaning, f)             f(visitor) visits the content
template <class V, class S>
void VisitPerson(V& v, S& s);

namespace person_rows {

inline constexpr auto kWarningNames = [] {
  std::array<const char*, kPersonWarnings> names{};
  for (std::size_t i = 0; i < kPersonWarnings; ++i) names[i] = kPersonWarningRows[i].name;
  return names;
}();

template <class V, class S>
void VisitInputs(V& v, S& s) {
  for (std::size_t i = 0; i < kPersonInputs; ++i)
    v.Group(kPersonInputNames[i], "", [&, input = &s.inputs[i]](V& in) {
      in.Word("status", "whether it is measured", kInputStatusNames,
              static_cast<std::size_t>(input->status));
      in.Number("last", "s", "time of the last value; null: there was none", input->last);
    });
}

template <class V, class S>
void VisitParts(V& v, S& s) {
  for (std::size_t i = 0; i < kBodyParts; ++i)
    v.Group(kBodyPartNames[i], "", [&, part = &s.parts[i]](V& in) {
      in.Number("load", "", "for colouring: share of the limit, or of the mean strength",
                part->load);
      in.Number("capacity", "", "strength that fatigue leaves, as a share", part->capacity);
      in.Number("damage", "", "of the run so far", part->damage);
      in.Number("day_share", "", "damage as a share of the tool's reference day", part->day_share);
      in.Number(
          "load_over_range", "",
          "largest load of the run, as a share of the largest load in the tool's range; above "
          "1: the damage is extrapolated",
          part->load_over_range);
    });
}

template <class V, class S>
void VisitGauges(V& v, S& s) {
  for (std::size_t i = 0; i < kPersonGauges; ++i) {
    const PersonGaugeRow& row = kPersonGaugeRows[i];
    v.Group(row.name, row.meaning, [&, gauge = &s.gauges[i], unit = row.unit](V& in) {
      in.Number("value", unit, "nominal posture", gauge->value);
      in.Number("low", unit, "90 % interval", gauge->low);
      in.Number("high", unit, "90 % interval", gauge->high);
    });
  }
}

template <class V, class S>
void VisitScores(V& v, S& s) {
  for (std::size_t i = 0; i < kPersonScores; ++i)
    v.Group(kPersonScoreRows[i].name, "", [&, score = &s.scores[i], i](V& in) {
      in.Number("score", "", "nominal posture; 0: not known", score->score);
      in.Number("level", "", "its action level; 1 is the lowest", score->level);
      in.List("probability", "of each action level", score->probability,
              static_cast<std::size_t>(kPersonScoreRows[i].classes));
    });
}

}  // namespace person_rows

template <class V, class S>
void VisitPerson(V& v, S& s) {
  v.Number("tick", "", "the newest tick that is taken into account", s.tick);
  v.Number("run_time", "s", "time of the points: middle of the 10 ms that end with that tick",
           s.run_time);
  v.Number("load_time", "s", "time of loads, scores and warnings", s.load_time);
  v.Number("interval_time", "s", "time of intervals and probabilities", s.interval_time);
  v.Number("since", "s", "start of damage and fatigue", s.since);
  v.Word("status", "whether the person is judged, or why not", kPersonStatusNames,
         static_cast<std::size_t>(s.status));
  v.Word("head", "origin of the head of the points; impossible: modelled despite a measurement",
         kHeadSourceNames, static_cast<std::size_t>(s.head));
  v.Number("heart_rate", "1/min", "newest value that a stream measured", s.heart_rate);
  v.Group("inputs", "measurements of other systems",
          [&](V& in) { person_rows::VisitInputs(in, s); });
  v.Flag("reached", "both hands reach their handles", s.reached);
  v.Number("miss", "m", "largest distance between a hand and its handle", s.miss);
  v.Number("sampled_reached", "", "share of the possible people who reach both", s.sampled_reached);
  v.Words("warnings", "active warnings", person_rows::kWarningNames, s.warnings);
  v.Group("points", "in W [m]", [&](V& in) {
    for (std::size_t i = 0; i < kBodyPoints; ++i)
      in.Vector(kBodyPointNames[i], "", s.points[i], s.status == PersonStatus::kJudged);
  });
  v.Group("parts", "", [&](V& in) { person_rows::VisitParts(in, s); });
  v.Group("gauges", "", [&](V& in) { person_rows::VisitGauges(in, s); });
  v.Group("scores", "", [&](V& in) { person_rows::VisitScores(in, s); });
}

}  // namespace predictor
