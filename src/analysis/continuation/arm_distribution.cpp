#include "analysis/continuation/arm_distribution.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/linear_algebra.h"
#include "core/text.h"

namespace predictor {

const std::array<const char*, kArmParameters> kArmParameterNames = {
    "stiffness_x", "stiffness_y", "stiffness_z", "damping_ratio",
    "mass",        "reflex_gain", "reflex_delay"};

namespace {

constexpr int kGain = 5;  // index of the only parameter that is normally distributed
constexpr double kMaxGain = 1, kMaxDelay = 0.2;
constexpr double kCommonStiffness = 0.35, kAxisStiffness = 0.2;
constexpr double kDampingSpread = 0.35, kMassSpread = 0.3, kGainSpread = 0.15, kDelaySpread = 0.2;
constexpr std::size_t kMaxFile = 1 << 20;  // [bytes]

ArmDistribution::Vector MomentsOf(const HandSpec& hand) {
  ArmDistribution::Vector x;
  x << hand.stiffness, hand.damping_ratio, hand.mass, hand.reflex_gain, hand.reflex_delay;
  return x;
}

// Returns a square root of a covariance, which may be singular. Throws InputError if the matrix is
// not a covariance.
ArmDistribution::Matrix RootOf(const ArmDistribution::Matrix& covariance) {
  const auto [values, vectors] = SymmetricModesOf(covariance);
  const double largest = values.cwiseAbs().maxCoeff();
  if (!covariance.allFinite() || !covariance.isApprox(covariance.transpose(), 1e-9) ||
      values.minCoeff() < -1e-9 * std::max(largest, 1e-12))
    throw InputError("The covariance of the arm is not symmetric and positive semidefinite.");
  return vectors * values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

nlohmann::json ParseArm(const std::string& file) {
  const std::string text = ReadWholeFile(file, kMaxFile + 1);
  if (text.size() > kMaxFile) throw InputError(file, "The file is larger than 1 MiB.");
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(file, "This is not JSON: there is an error at byte " +
                               std::to_string(error.byte) +
                               ". Give a file that `predictor identify-arm` wrote with --left or "
                               "--right.");
  }
}

// Returns the indices of the parameters whose names occur in the file.
std::vector<int> ParametersIn(const nlohmann::json& json) {
  std::vector<int> found;
  for (const auto& entry : json.at("parameters")) {
    const auto name = entry.get<std::string>();
    const auto at = std::ranges::find(kArmParameterNames, name);
    if (at == kArmParameterNames.end())
      throw InputError("Parameter " + Quote(name) + " is not known. The known ones are: " +
                       Join({kArmParameterNames.begin(), kArmParameterNames.end()}) + ".");
    found.push_back(static_cast<int>(at - kArmParameterNames.begin()));
  }
  return found;
}

}  // namespace

Vector3 ArmImpedance::Damping() const { return 2 * damping_ratio * (mass * stiffness).cwiseSqrt(); }

ArmDistribution ArmDistribution::Prior(const HandSpec& hand) {
  ArmDistribution arm;
  arm.mean_ = MomentsOf(hand).cwiseMax(1e-9).array().log();
  arm.mean_[kGain] = hand.reflex_gain;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      arm.covariance_(i, j) =
          kCommonStiffness * kCommonStiffness + (i == j ? kAxisStiffness * kAxisStiffness : 0);
  const double more[] = {kDampingSpread, kMassSpread, kGainSpread, kDelaySpread};
  for (int k = 0; k < 4; ++k) arm.covariance_(3 + k, 3 + k) = more[k] * more[k];
  arm.root_ = RootOf(arm.covariance_);
  arm.reference_ = std::cbrt(hand.stiffness.prod());
  arm.rotation_stiffness_ = hand.rotation_stiffness;
  arm.rotation_damping_ = hand.rotation_damping;
  arm.source_ = "the project's prior around the scenario's hand";
  return arm;
}

// For a log-normal x with mean m, Cov(log xi, log xj) = log(1 + Cij / (mi mj)). For a normal g,
// Cov(g, log x) = C / m.
ArmDistribution ArmDistribution::FromMoments(const Vector& mean, const Matrix& covariance,
                                             const HandSpec& hand, const std::string& source) {
  ArmDistribution arm = Prior(hand);
  RootOf(covariance);  // checks the covariance
  for (int i = 0; i < kArmParameters; ++i)
    if (!(mean[i] > 0) && i != kGain)
      throw InputError(std::string("The mean of ") + kArmParameterNames[i] +
                       " of the arm must be positive.");
  for (int i = 0; i < kArmParameters; ++i) {
    for (int j = 0; j < kArmParameters; ++j) {
      const bool gi = i == kGain, gj = j == kGain;
      const double c = covariance(i, j);
      arm.covariance_(i, j) = gi && gj ? c
                              : gi     ? c / mean[j]
                              : gj     ? c / mean[i]
                                       : std::log(1 + c / (mean[i] * mean[j]));
    }
    arm.mean_[i] = i == kGain ? mean[i] : std::log(mean[i]) - arm.covariance_(i, i) / 2;
  }
  arm.root_ = RootOf(arm.covariance_);
  arm.source_ = source;
  return arm;
}

ArmDistribution ArmDistribution::Read(const std::string& file, const HandSpec& hand) {
  const nlohmann::json json = ParseArm(file);
  try {
    if (json.at("predictor_arm").get<int>() != 1)
      throw InputError("The version (predictor_arm) must be 1.");
    const std::vector<int> which = ParametersIn(json);
    const auto mean = json.at("mean").get<std::vector<double>>();
    const auto covariance = json.at("covariance").get<std::vector<std::vector<double>>>();
    if (mean.size() != which.size() || covariance.size() != which.size())
      throw InputError("parameters, mean and covariance must have the same length.");
    // For parameters that the file does not contain, the moments of the prior are kept.
    Vector m = MomentsOf(hand);
    Matrix c = Matrix::Zero();
    const ArmDistribution prior = Prior(hand);
    for (int i = 0; i < kArmParameters; ++i)
      c(i, i) = prior.covariance_(i, i) * (i == kGain ? 1 : m[i] * m[i]);
    for (std::size_t i = 0; i < which.size(); ++i) {
      if (covariance[i].size() != which.size()) throw InputError("The covariance must be square.");
      m[which[i]] = mean[i];
      for (std::size_t j = 0; j < which.size(); ++j) c(which[i], which[j]) = covariance[i][j];
    }
    return FromMoments(m, c, hand, Printable(json.value("source", std::string("the file"))));
  } catch (const nlohmann::json::exception& error) {
    throw InputError(file, std::string("The arm cannot be read: ") + Printable(error.what()));
  } catch (const InputError& error) {
    throw InputError(file, error.what());
  }
}

ArmImpedance ArmDistribution::Draw(RandomStream* random) const {
  Vector normal;
  for (int i = 0; i < kArmParameters; ++i) normal[i] = random->Normal();
  return Make(mean_ + root_ * normal);
}

ArmImpedance ArmDistribution::Make(const Vector& x) const {
  ArmImpedance arm;
  arm.stiffness = x.head<3>().array().exp();
  arm.damping_ratio = std::exp(x[3]);
  arm.mass = std::exp(x[4]);
  arm.reflex_gain = std::clamp(x[kGain], 0.0, kMaxGain);
  arm.reflex_delay = std::min(std::exp(x[6]), kMaxDelay);
  const double scale = std::cbrt(arm.stiffness.prod()) / reference_;
  arm.rotation_stiffness = scale * rotation_stiffness_;
  arm.rotation_damping = std::sqrt(scale) * rotation_damping_;
  return arm;
}

double ArmDistribution::Percentile(int parameter, double probability) const {
  constexpr double kZ = 1.6448536269514722;  // the 95 % quantile of the normal distribution
  const double z = probability < 0.5 ? -kZ : probability > 0.5 ? kZ : 0;
  const double x = mean_[parameter] + z * std::sqrt(covariance_(parameter, parameter));
  return parameter == kGain ? std::clamp(x, 0.0, kMaxGain) : std::exp(x);
}

}  // namespace predictor
