#include "commissioning/probe.h"

#include <algorithm>
#include <cmath>

#include "commissioning/arm_checks.h"
#include "core/error.h"
#include "core/format.h"
#include "models/arm_model.h"

namespace predictor::commissioning {
namespace {

constexpr double kTick = 0.001;     // interval between commands to stand still [s]
constexpr double kRatePart = 0.05;  // allowed deviation of a rate from the file
constexpr double kBeyond = 0.1;     // a joint guided further beyond its limit means a different arm
                                    // [rad]

double Quantile(std::vector<double> x, double part) {
  if (x.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(part * static_cast<double>(x.size() - 1));
  std::nth_element(x.begin(), x.begin() + at, x.end());
  return x[static_cast<std::size_t>(at)];
}

// Collects the arrivals of one stream of samples.
class Arrivals {
 public:
  // `now` is in [s]. Returns true for a new sample.
  bool Look(std::uint64_t sequence, double age, double now) {
    if (std::isfinite(age)) ages_.push_back(age);
    if (any_ && sequence == last_) return false;
    if (any_) {
      intervals_.push_back(now - time_);
      numbers_ += static_cast<double>(sequence - last_);
    } else {
      begin_ = now;
    }
    any_ = true;
    last_ = sequence;
    time_ = now;
    return true;
  }
  // Returns the time since the last new sample, or since `start` [s].
  double Silence(double now, double start) const { return now - (any_ ? time_ : start); }

  SampleTimes Finish() const {
    SampleTimes times;
    times.samples = static_cast<int>(intervals_.size()) + (any_ ? 1 : 0);
    if (!intervals_.empty() && time_ > begin_) {
      times.rate = numbers_ / (time_ - begin_);
      times.lost = 1 - static_cast<double>(intervals_.size()) / std::max(1.0, numbers_);
      times.max = *std::max_element(intervals_.begin(), intervals_.end());
    }
    times.p50 = Quantile(intervals_, 0.5);
    times.p99 = Quantile(intervals_, 0.99);
    times.age_p50 = Quantile(ages_, 0.5);
    if (!ages_.empty()) times.age_max = *std::max_element(ages_.begin(), ages_.end());
    return times;
  }

 private:
  std::vector<double> intervals_, ages_;
  double begin_ = 0, time_ = 0, numbers_ = 0;
  std::uint64_t last_ = 0;
  bool any_ = false;
};

// The mean and the standard deviation of the new readings.
class WrenchMean {
 public:
  void Add(const Wrench& F) {
    if (count_ == 0) first_ = F;
    const Wrench d = F - first_;
    sum_ += d;
    squares_ += d.cwiseProduct(d);
    ++count_;
  }
  void Write(Probed* probed) const {
    probed->has_wrench = count_ > 0;
    if (count_ == 0) return;
    const Wrench mean = sum_ / count_;
    probed->F_S = first_ + mean;
    probed->deviation = (squares_ / count_ - mean.cwiseProduct(mean)).cwiseMax(0).cwiseSqrt();
  }

 private:
  Wrench first_ = Wrench::Zero(), sum_ = Wrench::Zero(), squares_ = Wrench::Zero();
  int count_ = 0;
};

class Prober {
 public:
  Prober(Network* network, const ProbeOptions& options) : network_(network), options_(options) {}

  // `read(now)`: polls once. `arrivals` determines whether a sample is new.
  template <class Read>
  void Watch(const Arrivals& arrivals, const Read& read, Probed* probed) {
    const double start = Now();
    for (double now = start; now < start + options_.duration; now = Now()) {
      const std::string trouble = read(now);
      if (!trouble.empty()) {
        probed->trouble = trouble;
        return;
      }
      if (arrivals.Silence(now, start) > options_.patience) {
        probed->trouble = Formatted(
            "The device has sent no sample for %.1f s. Check its cable, and check that no other "
            "program uses it.",
            options_.patience);
        return;
      }
      network_->Wait(options_.poll);
    }
  }

  void ProbeArm(Arm* arm, Probed* probed) {
    Arrivals arrivals, wrenches;
    WrenchMean mean;
    ArmReading reading;
    const JointVector rest = JointVector::Zero(arm->facts().joints);
    double next = 0;
    Watch(
        arrivals,
        [&](double now) -> std::string {
          Status status = arm->Read(&reading);
          // If the driver runs a program on the controller, that program must receive data from
          // this process.
          if (status.ok() && now >= next) {
            status = arm->Write(rest, false);
            next = now + kTick;
          }
          if (!status.ok()) return TroubleOf(*arm);
          arrivals.Look(reading.sequence, reading.age, now);
          const bool own = arm->facts().own_wrench;
          if (own && wrenches.Look(reading.wrench.sequence, reading.wrench.age, now))
            mean.Add(reading.wrench.F_S);
          return "";
        },
        probed);
    probed->times = arrivals.Finish();
    probed->q = reading.q;
    if (reading.fault && probed->trouble.empty()) probed->trouble = TroubleOf(*arm);
    mean.Write(probed);
  }

  void ProbeSensor(WrenchSensor* sensor, Probed* probed) {
    Arrivals arrivals;
    WrenchMean mean;
    WrenchReading reading;
    Watch(
        arrivals,
        [&](double now) -> std::string {
          if (!sensor->Read(&reading).ok()) return TroubleOf(*sensor);
          if (arrivals.Look(reading.sequence, reading.age, now)) mean.Add(reading.F_S);
          return "";
        },
        probed);
    probed->times = arrivals.Finish();
    mean.Write(probed);
    if (reading.saturated)
      probed->remarks.emplace_back(
          "The sensor reports that its range is exceeded. Remove the load.");
  }

 private:
  template <class Device>
  static std::string TroubleOf(const Device& device) {
    const std::string trouble = device.Trouble();
    return trouble.empty() ? "The device reports a fault without naming this fault." : trouble;
  }
  double Now() const { return 1e-9 * static_cast<double>(network_->Now()); }

  Network* network_;
  const ProbeOptions& options_;
};

// Compares measured rates. A rate of 0 means that the rate was not measured.
bool DiffersMuch(double rate, double said) {
  return rate > 0 && std::abs(rate - said) > kRatePart * said;
}

// `rate` is the rate that the device's version determines or, if the version does not determine a
// rate, the measured rate.
void CompareRate(double rate, double said, const std::string& key, Probed* probed) {
  if (!DiffersMuch(rate, said)) return;
  probed->mismatches.push_back(Formatted(
      "The device sends %.0f samples per second, but the machine file says %.0f. Correct %s, or "
      "check that this is the intended device.",
      rate, said, key.c_str()));
}

// Compares the arm that answers with the model in the machine file. Drivers cannot distinguish arms
// of one manufacturer that have the same number of joints.
void CompareModel(const Machine& machine, int hand, const DeviceFacts& facts, Probed* probed) {
  const ArmSpec& spec = machine.arm(hand)->arm;
  const std::string key = std::string("arms.") + HandName(hand) + ".arm";
  try {
    const auto model = LoadArmModel(spec, spec.base.X_RB(), {}, key);
    if (facts.joints != model->dof())
      return probed->mismatches.push_back(
          Located(InputError::At(
                      key + ".model",
                      Formatted("%s.model has %d joints, but the arm that answers has %d. Give the "
                                "model of this arm, or check that this is the intended arm.",
                                key.c_str(), model->dof(), facts.joints)),
                  machine)
              .what());
    if (const std::string refusal = KinematicsRefusal(facts, spec, *model); !refusal.empty())
      probed->mismatches.push_back(refusal);
    for (int j = 0; j < model->dof() && j < probed->q.size(); ++j)
      if (probed->q[j] < model->position_lower()[j] - kBeyond ||
          probed->q[j] > model->position_upper()[j] + kBeyond)
        probed->mismatches.push_back(Formatted(
            "The arm's joint %s is at %.3f rad, but %s.model allows %.3f to %.3f rad. Check "
            "that this is the model of this arm.",
            model->joint_name(j).c_str(), probed->q[j], key.c_str(), model->position_lower()[j],
            model->position_upper()[j]));
  } catch (const InputError& error) {
    probed->mismatches.emplace_back(Located(error, machine).what());
  }
}

// Connects to a device with `connect` and observes the device with `watch`. This function records
// any error as a problem of this device.
template <class Connect, class Watch>
void Try(const std::string& place, const Connect& connect, const Watch& watch,
         std::vector<Probed>* all) {
  Probed probed;
  probed.place = place;
  try {
    const auto device = connect();
    if (!device) return;  // the machine has no such device
    probed.name = device->facts().name;
    watch(device.get(), &probed);
  } catch (const DeviceError& error) {
    probed.trouble = error.what();
  }
  all->push_back(std::move(probed));
}

void AppendTimes(const SampleTimes& t, std::string* text) {
  AppendLine(text,
             "    %.1f Hz (%d samples, %.2f %% missed); interval %.2f / %.2f / %.2f ms (p50 / p99 "
             "/ max); age %.2f ms, at most %.2f ms",
             t.rate, t.samples, 1e2 * t.lost, 1e3 * t.p50, 1e3 * t.p99, 1e3 * t.max,
             1e3 * t.age_p50, 1e3 * t.age_max);
}

}  // namespace

std::vector<Probed> ProbeMachine(const Machine& machine, const Connector& connector,
                                 Network* network, const ProbeOptions& options) {
  std::vector<Probed> all;
  Prober prober(network, options);
  for (int hand = 0; hand < kHands; ++hand) {
    if (!machine.arm(hand)) continue;
    const MachineArm& side = *machine.arm(hand);
    const std::string name = HandName(hand);
    Try(
        name + " arm", [&] { return connector.arm(side, network); },
        [&](Arm* arm, Probed* probed) {
          prober.ProbeArm(arm, probed);
          const double reported = arm->facts().rate;
          CompareRate(reported > 0 ? reported : probed->times.rate, side.arm.sample_rate,
                      "arms." + name + ".arm.sample_rate", probed);
          if (reported > 0 && DiffersMuch(probed->times.rate, reported))
            probed->remarks.push_back(Formatted(
                "The arm should send %.0f samples per second. Check whether the network or "
                "this computer is busy.",
                reported));
          CompareModel(machine, hand, arm->facts(), probed);
          probed->remarks.insert(probed->remarks.end(), arm->facts().remarks.begin(),
                                 arm->facts().remarks.end());
          if (const std::string refusal = PayloadRefusal(arm->facts(), side); !refusal.empty())
            probed->remarks.push_back(refusal);
          if (side.sensor.make == SensorMake::kOwn && !arm->facts().own_wrench)
            probed->trouble +=
                (probed->trouble.empty() ? "" : " ") +
                std::string(
                    "The arm does not measure a wrench at its handle. Add a force/torque "
                    "sensor to this arm.");
        },
        &all);
    Try(
        name + " sensor", [&] { return connector.sensor(side, network); },
        [&](WrenchSensor* sensor, Probed* probed) {
          prober.ProbeSensor(sensor, probed);
          CompareRate(probed->times.rate, side.arm.sensor.sample_rate,
                      "arms." + name + ".arm.sensor.sample_rate", probed);
        },
        &all);
  }
  return all;
}

bool AllAnswer(const std::vector<Probed>& probed) {
  return std::all_of(probed.begin(), probed.end(), [](const Probed& p) { return p.answers(); });
}

bool AllMatch(const std::vector<Probed>& probed) {
  return std::all_of(probed.begin(), probed.end(),
                     [](const Probed& p) { return p.mismatches.empty(); });
}

std::string ProbeText(const std::vector<Probed>& probed) {
  std::string text;
  for (const Probed& p : probed) {
    AppendLine(&text, "%s: %s", p.place.c_str(),
               p.answers() ? p.name.c_str() : (p.name.empty() ? "DOES NOT ANSWER" : "TROUBLE"));
    if (!p.trouble.empty()) AppendLine(&text, "    %s", p.trouble.c_str());
    for (const std::string& mismatch : p.mismatches)
      AppendLine(&text, "    DIFFERS FROM THE MACHINE FILE: %s", mismatch.c_str());
    if (p.times.samples > 1) AppendTimes(p.times, &text);
    if (p.q.size() > 0) {
      text += "    joints";
      for (const double q : p.q) Append(&text, " %.3f", q);
      text += " rad\n";
    }
    if (p.has_wrench)
      AppendLine(&text,
                 "    wrench now %.2f %.2f %.2f N, %.3f %.3f %.3f N·m (with bias and handle; noise "
                 "%.3f N, %.4f N·m)",
                 p.F_S[0], p.F_S[1], p.F_S[2], p.F_S[3], p.F_S[4], p.F_S[5],
                 p.deviation.head<3>().maxCoeff(), p.deviation.tail<3>().maxCoeff());
    for (const std::string& remark : p.remarks) AppendLine(&text, "    %s", remark.c_str());
  }
  return text;
}

}  // namespace predictor::commissioning
