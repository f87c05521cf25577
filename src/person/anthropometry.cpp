#include "person/anthropometry.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <string>

#include "core/error.h"
#include "core/text.h"
#include "scenario/stance.h"

namespace predictor::person {
namespace {

// One row of de Leva's table. The mass is a fraction of the body's mass. The centre of mass (from
// the proximal end) and the radii of gyration (about the sagittal, transverse and longitudinal
// axes) are fractions of the length. The length applies to a person of the table's mean height [m].
struct Row {
  double mass, com;
  Vector3 radii;
  double length;
};

struct Table {
  double height;  // mean of the people in the table [m]
  Row head, upper_trunk, middle_trunk, lower_trunk, upper_arm, forearm, hand, thigh, shank, foot;
  double shoulder_height;  // height of the shoulder joints above the hip joints [m]
};

// As in the paper, the centres of mass are measured from the cranial end in the trunk's rows, and
// from the vertex in the head's row. The hand's proximal end is the wrist, and the hand's length
// ends at the third knuckle.
const Table kMaleTable = {1.741,
                          {.0694, .5002, {.303, .315, .261}, .2429},
                          {.1596, .5066, {.505, .320, .465}, .2421},
                          {.1633, .4502, {.482, .383, .468}, .2155},
                          {.1117, .6115, {.615, .551, .587}, .1457},
                          {.0271, .5772, {.285, .269, .158}, .2817},
                          {.0162, .4574, {.276, .265, .121}, .2689},
                          {.0061, .7900, {.628, .513, .401}, .0862},
                          {.1416, .4095, {.329, .329, .149}, .4222},
                          {.0433, .4459, {.255, .249, .103}, .4340},
                          {.0137, .4415, {.257, .245, .124}, .2581},
                          .5155};
const Table kFemaleTable = {1.735,
                            {.0668, .4841, {.271, .295, .261}, .2437},
                            {.1545, .5050, {.466, .314, .449}, .2280},
                            {.1465, .4512, {.433, .354, .415}, .2053},
                            {.1247, .4920, {.433, .402, .444}, .1815},
                            {.0255, .5754, {.278, .260, .148}, .2751},
                            {.0138, .4559, {.261, .257, .094}, .2643},
                            {.0056, .7474, {.531, .454, .335}, .0780},
                            {.1478, .3612, {.369, .364, .162}, .3685},
                            {.0481, .4416, {.271, .267, .093}, .4323},
                            {.0129, .4014, {.299, .279, .139}, .2283},
                            .4979};

constexpr double kMinHeight = 1.2, kMaxHeight = 2.4;              // [m]
constexpr double kMinMass = 30, kMaxMass = 250;                   // [kg]
constexpr double kMinBodyMassIndex = 12, kMaxBodyMassIndex = 70;  // [kg/m²]
// The permitted range of a measured length, relative to the estimated length.
constexpr double kMinLengthFactor = 0.7, kMaxLengthFactor = 1.4;
// The possible heights of the head, as fractions of the body's height. The height of the head is
// the difference between the body's height and the sum of the other lengths.
constexpr double kMinHeadHeight = 0.08, kMaxHeadHeight = 0.2;

[[noreturn]] void Refuse(const std::string& key, const std::string& sentence) {
  throw InputError::At(key, key + " " + sentence);
}

void CheckRange(const std::string& key, double value, double low, double high,
                const std::string& unit) {
  if (value >= low && value <= high) return;
  Refuse(key, "is " + FormatNumber(value) + " " + unit + ", but for an adult it is " +
                  FormatNumber(low) + " to " + FormatNumber(high) + " " + unit + ". Give it in " +
                  unit + ".");
}

double Measured(const char* key, const std::optional<double>& measured, double estimate) {
  if (!measured) return estimate;
  const double low = std::round(kMinLengthFactor * estimate * 1000) / 1000;
  const double high = std::round(kMaxLengthFactor * estimate * 1000) / 1000;
  if (*measured >= low && *measured <= high) return *measured;
  Refuse(
      key,
      "is " + FormatNumber(*measured) + " m, but " + FormatNumber(low) + " to " +
          FormatNumber(high) +
          " m is possible for this height. Measure between the joints' centres, in m, or omit it.");
}

Segment Make(const Row& row, double mass, double length) {
  Segment s;
  s.mass = row.mass * mass;
  s.length = length;
  s.com = row.com * length;
  s.inertia = s.mass * (row.radii * length).array().square();
  return s;
}

// Makes a segment for which the table gives the centre of mass from the distal end.
Segment FromFarEnd(const Row& row, double mass, double length) {
  Segment s = Make(row, mass, length);
  s.com = length - s.com;
  return s;
}

// Combines two segments along z into one. `distal` begins where `proximal` ends.
Segment Combine(const Segment& proximal, const Segment& distal) {
  Segment s;
  s.mass = proximal.mass + distal.mass;
  s.length = proximal.length + distal.length;
  const double distal_com = proximal.length + distal.com;
  s.com = (proximal.mass * proximal.com + distal.mass * distal_com) / s.mass;
  const double apart = distal_com - proximal.com;
  const double parallel = proximal.mass * distal.mass / s.mass * apart * apart;
  s.inertia = proximal.inertia + distal.inertia + Vector3(parallel, parallel, 0);
  return s;
}

void CheckPerson(const BodySpec& spec) {
  CheckRange("height", spec.height, kMinHeight, kMaxHeight, "m");
  CheckRange("mass", spec.mass, kMinMass, kMaxMass, "kg");
  const double index = spec.mass / (spec.height * spec.height);
  if (index < kMinBodyMassIndex || index > kMaxBodyMassIndex)
    Refuse("mass", "is " + FormatNumber(spec.mass) + " kg at a height of " +
                       FormatNumber(spec.height) + " m, which is a body-mass index of " +
                       FormatNumber(std::round(index * 10) / 10) +
                       " kg/m². Check both values. Indices from 12 to 70 kg/m² are possible.");
}

void AddTrunk(const Table& table, const BodySpec& spec, double mass, Anthropometry* a) {
  const double scale = spec.height / table.height;
  const double length =
      table.upper_trunk.length + table.middle_trunk.length + table.lower_trunk.length;
  const double stretch = Measured("trunk", spec.trunk, length * scale) / length;
  const auto part = [&](const Row& row) { return FromFarEnd(row, mass, row.length * stretch); };
  a->pelvis = part(table.lower_trunk);
  a->torso = Combine(part(table.middle_trunk), part(table.upper_trunk));
  a->shoulder_height = table.shoulder_height * stretch;
  a->l5s1_height = 0.058 * spec.height;
  a->l5s1_behind = 0.018 * spec.height;
}

void AddHead(const Table& table, const BodySpec& spec, double mass, Anthropometry* a) {
  const double c7 = a->hip_height() + a->pelvis.length + a->torso.length;
  const double left = spec.height - c7;
  if (left < kMinHeadHeight * spec.height || left > kMaxHeadHeight * spec.height) {
    Refuse("height", "is " + FormatNumber(spec.height) + " m, but shank, thigh and trunk reach " +
                         FormatNumber(std::round(c7 * 1000) / 1000) +
                         " m. Check the measured lengths.");
  }
  a->head = FromFarEnd(table.head, mass, table.head.length * spec.height / table.height);
  a->head.com *= left / a->head.length;
  a->head.length = left;
  a->eyes = {0.05 * spec.height, 0, kEyeHeight * spec.height - c7};
}

}  // namespace

Anthropometry AnthropometryOf(const BodySpec& spec) {
  CheckPerson(spec);
  const Table& t = spec.sex == Sex::kMale ? kMaleTable : kFemaleTable;
  const double scale = spec.height / t.height;
  double sum = t.head.mass + t.upper_trunk.mass + t.middle_trunk.mass + t.lower_trunk.mass;
  for (const Row* row : {&t.upper_arm, &t.forearm, &t.hand, &t.thigh, &t.shank, &t.foot})
    sum += 2 * row->mass;
  const double mass = spec.mass / sum;
  const auto limb = [&](const char* key, const std::optional<double>& measured, const Row& row) {
    return Make(row, mass, Measured(key, measured, row.length * scale));
  };
  Anthropometry a;
  a.height = spec.height;
  a.mass = spec.mass;
  a.upper_arm = limb("upper_arm", spec.upper_arm, t.upper_arm);
  a.forearm = limb("forearm", spec.forearm, t.forearm);
  a.hand = limb("hand", spec.hand, t.hand);
  // The table's sagittal axis is normal to the palm, and in this model the palm faces the body.
  std::swap(a.hand.inertia.x(), a.hand.inertia.y());
  a.thigh = limb("thigh", spec.thigh, t.thigh);
  a.shank = limb("shank", spec.shank, t.shank);
  a.foot = limb("foot", std::nullopt, t.foot);
  a.ankle_height = 0.039 * spec.height;
  a.half_hip_width = 0.05 * spec.height;
  a.half_shoulder_width =
      Measured("shoulder_distance", spec.shoulder_distance, 0.21 * spec.height) / 2;
  AddTrunk(t, spec, mass, &a);
  AddHead(t, spec, mass, &a);
  return a;
}

}  // namespace predictor::person
