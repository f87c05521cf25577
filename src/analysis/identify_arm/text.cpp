// Writes the identified arms as text for the user, as JSON, and as a file for other commands.
#include <cmath>
#include <nlohmann/json.hpp>

#include "analysis/identify_arm/identify_arm.h"
#include "core/format.h"
#include "core/hands.h"

namespace predictor {
namespace {

using Json = nlohmann::ordered_json;

struct PlaneRow {
  const char *name, *unit, *key;
  int first;  // parameter of axis u; then the one that couples u and v, then v
};
constexpr std::array<PlaneRow, 3> kRows = {
    PlaneRow{"mass", "kg", "mass_kg", plane::kMass},
    PlaneRow{"damping", "N·s/m", "damping_ns_m", plane::kDamping},
    PlaneRow{"stiffness", "N/m", "stiffness_n_m", plane::kStiffness}};

// Returns an axis as text: "x", "-y" or "[0.71, 0.71, 0]".
std::string AxisName(const Vector3& axis) {
  for (int i = 0; i < 3; ++i)
    if (std::abs(std::abs(axis[i]) - 1) < 1e-9)
      return std::string(axis[i] < 0 ? "-" : "") + "xyz"[i];
  return Formatted("[%.2f, %.2f, %.2f]", axis.x(), axis.y(), axis.z());
}

std::string Cell(const ArmFit& fit, int k, double factor = 1) {
  return Formatted("%8.3g ± %-7.2g %s", factor * fit.value[k], factor * fit.half_width(k),
                   IsWide(fit, k) ? "wide" : "    ");
}

// Returns whether the arm certainly has a reflex. Otherwise, the delay of the reflex has no
// meaning.
bool HasReflex(const ArmFit& fit) { return fit.value[plane::kGain] > fit.half_width(plane::kGain); }

void AddHand(const ArmIdentification& all, std::size_t hand, std::string* text) {
  const ArmOfHand& arm = all.hands[hand];
  if (!arm.present) return;
  if (!arm.identified())
    return AppendLine(text, "%s hand: not identified. %s", hand == 0 ? "Left" : "Right",
                      arm.refusal.c_str());
  const ArmFit& fit = *arm.fit;
  AppendLine(text, "%s hand, from %d displacements (%d not usable), at most %.1f N",
             hand == 0 ? "Left" : "Right", arm.taken, arm.spoiled, arm.largest_force);
  const std::string u = "along " + AxisName(all.plane[0]), v = "along " + AxisName(all.plane[1]);
  AppendLine(text, "  %-19s %-24s %-24s %s", "", u.c_str(), v.c_str(), "between them");
  for (const PlaneRow& row : kRows)
    AppendLine(text, "  %-10s %-8s %s %s %8.3g ± %.2g", row.name,
               Formatted("[%s]", row.unit).c_str(), Cell(fit, row.first).c_str(),
               Cell(fit, row.first + 2).c_str(), fit.value[row.first + 1],
               fit.half_width(row.first + 1));
  AppendLine(text, "  reflex gain        %s", Cell(fit, plane::kGain).c_str());
  if (HasReflex(fit))
    AppendLine(text, "  reflex delay [ms]  %s", Cell(fit, plane::kDelay, 1e3).c_str());
  else
    AppendLine(text, "  reflex delay       not identified, because the gain may be zero");
}

Json JsonOf(const ArmFit& fit, int k) {
  return {{"value", fit.value[k]}, {"half_width_90", fit.half_width(k)}, {"wide", IsWide(fit, k)}};
}

Json JsonOf(const ArmOfHand& arm, const char* name) {
  Json json = {{"hand", name},
               {"refusal", arm.identified() ? Json(nullptr) : Json(arm.refusal)},
               {"displacements", arm.taken},
               {"not_usable", arm.spoiled},
               {"largest_force_n", arm.largest_force}};
  if (!arm.identified()) return json;
  const ArmFit& fit = *arm.fit;
  for (const PlaneRow& row : kRows)
    json[row.key] = {{"uu", JsonOf(fit, row.first)},
                     {"uv", JsonOf(fit, row.first + 1)},
                     {"vv", JsonOf(fit, row.first + 2)}};
  json["reflex_gain"] = JsonOf(fit, plane::kGain);
  json["reflex_delay_s"] = HasReflex(fit) ? JsonOf(fit, plane::kDelay) : Json(nullptr);
  json["residual_n"] = fit.residual;
  return json;
}

// ---- the file for other commands ----------------------------------------------------------------

struct Derived {
  std::vector<std::string> names;
  Eigen::VectorXd mean;
  Eigen::MatrixXd slopes;  // of the derived parameters with respect to those of the plane

  void Add(const std::string& name, double value, const PlaneVector& slope) {
    const auto n = static_cast<Eigen::Index>(names.size());
    names.push_back(name);
    mean.conservativeResize(n + 1);
    slopes.conservativeResize(n + 1, kPlaneParameters);
    mean[n] = value;
    slopes.row(n) = slope;
  }
};

// Returns the mean damping ratio ζ = D / (2 √(M K)) of both axes, with its interval from error
// propagation.
void AddDampingRatio(const ArmFit& fit, double mass, Derived* derived) {
  double ratio = 0;
  PlaneVector slope = PlaneVector::Zero();
  for (const int i : {0, 2}) {
    const int d = plane::kDamping + i, k = plane::kStiffness + i;
    const double D = fit.value[d], K = std::max(1e-6, fit.value[k]);
    const double zeta = D / (2 * std::sqrt(mass * K));
    ratio += zeta / 2;
    slope[d] += zeta / (2 * D);
    slope[k] -= zeta / (4 * K);
    for (const int m : {0, 2}) slope[plane::kMass + m] -= zeta / (8 * mass);
  }
  derived->Add("damping_ratio", ratio, slope);
}

Derived DerivedOf(const ArmIdentification& all, const ArmFit& fit) {
  Derived derived;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const std::string name = AxisName(all.plane[axis]);
    if (name.front() == '[') continue;
    const int k = plane::kStiffness + 2 * static_cast<int>(axis);
    derived.Add(std::string("stiffness_") + name.back(), fit.value[k], PlaneVector::Unit(k));
  }
  const double mass = (fit.value[plane::kMass] + fit.value[plane::kMass + 2]) / 2;
  AddDampingRatio(fit, mass, &derived);
  derived.Add("mass", mass,
              0.5 * (PlaneVector::Unit(plane::kMass) + PlaneVector::Unit(plane::kMass + 2)));
  derived.Add("reflex_gain", fit.value[plane::kGain], PlaneVector::Unit(plane::kGain));
  if (HasReflex(fit))
    derived.Add("reflex_delay", fit.value[plane::kDelay], PlaneVector::Unit(plane::kDelay));
  return derived;
}

}  // namespace

std::string ArmText(const ArmIdentification& identification, const std::string& source) {
  std::string text;
  AppendLine(&text, "Arm of the %s, modelled from measured force and motion in %s",
             identification.simulated ? "simulated operator" : "operator", source.c_str());
  AppendLine(&text, "± is half the 90 %% interval; axes of the world");
  for (std::size_t hand = 0; hand < kHands; ++hand) AddHand(identification, hand, &text);
  return text;
}

std::string ArmJson(const ArmIdentification& identification, const std::string& source) {
  const auto axis = [](const Vector3& v) { return Json{v.x(), v.y(), v.z()}; };
  Json json = {
      {"version", 1},
      {"source", source},
      {"operator", identification.simulated ? "simulated" : "person"},
      {"label", "modelled"},
      {"complete", identification.complete()},
      {"plane", {{"u", axis(identification.plane[0])}, {"v", axis(identification.plane[1])}}},
      {"hands", Json::array()}};
  for (std::size_t hand = 0; hand < kHands; ++hand)
    if (identification.hands[hand].present)
      json["hands"].push_back(JsonOf(identification.hands[hand], kHandNames[hand]));
  return json.dump(2) + "\n";
}

std::string ArmFile(const ArmIdentification& identification, int hand, const std::string& source) {
  const ArmFit& fit = *identification.hands[static_cast<std::size_t>(hand)].fit;
  const Derived derived = DerivedOf(identification, fit);
  const Eigen::MatrixXd covariance = derived.slopes * fit.covariance * derived.slopes.transpose();
  Json json = {{"predictor_arm", 1},
               {"source", std::string(HandName(hand)) + " hand identified in " + source},
               {"parameters", derived.names},
               {"mean", std::vector<double>(derived.mean.begin(), derived.mean.end())},
               {"covariance", Json::array()}};
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < covariance.cols(); ++j)
      row.push_back((covariance(i, j) + covariance(j, i)) / 2);
    json["covariance"].push_back(row);
  }
  return json.dump(2) + "\n";
}

}  // namespace predictor
