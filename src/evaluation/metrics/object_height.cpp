// Measures the height of the object, and whether the simulated operator lifts it.
#include <algorithm>
#include <cmath>

#include "evaluation/metrics/registry.h"
#include "scenario/action_time.h"
#include "scenario/actions/action.h"

namespace predictor::metrics {
namespace {

// The first action of the script that moves the object up.
struct Lift {
  double start = INFINITY, end = INFINITY;  // [s]
  double height = NAN;                      // [m]
};

Lift FirstLift(const Scenario& scenario) {
  Lift first;
  if (scenario.operator_.type != "virtual") return first;
  const std::vector<ActionSpec>& script = scenario.operator_.script;
  for (std::size_t i = 0; i < script.size(); ++i) {
    const double time = ActionTime(script[i]);
    Intent intent;
    const auto action = MakeAction(script[i], static_cast<int>(i));
    action->Begin(&intent);
    action->Advance(time, 1, &intent);
    constexpr double kMinLift = 0.005;  // smaller motions are not lifts [m]
    if (intent.X_WO.p.z() > kMinLift && script[i].start < first.start)
      first = {script[i].start, script[i].start + time, intent.X_WO.p.z()};
  }
  return first;
}

class ObjectHeight final : public Metric {
 public:
  explicit ObjectHeight(const Scenario& scenario) : lift_(FirstLift(scenario)) {}

  void Add(const TickRecord& record) noexcept override {
    if (!record.ran) return;
    final_ = record.object.pose.p[2];
    if (record.run_time >= lift_.start && record.run_time <= lift_.end) {
      if (std::isnan(before_lift_)) before_lift_ = highest_lift_ = final_;
      highest_lift_ = std::max(highest_lift_, final_);
    }
    lift_ended_ = lift_ended_ || record.run_time >= lift_.end;
    if (std::isnan(initial_)) initial_ = min_ = max_ = final_;
    min_ = std::min(min_, final_);
    max_ = std::max(max_, final_);
  }

  void AppendTo(std::vector<Result>* results) const override {
    const auto add = [&](const char* key, const char* label, double value) {
      results->push_back({.path = std::string("object.height_m.") + key,
                          .group = "Height of the object",
                          .label = label,
                          .unit = units::kMetre,
                          .meaning = std::string("height of the object's origin in W: ") + label,
                          .value = value,
                          .compared = false});
    };
    add("initial", "at the start", initial_);
    add("min", "lowest", min_);
    add("max", "highest", max_);
    add("final", "at the end", final_);
    results->push_back({.path = "object.lift_m",
                        .group = "Object lifted by",
                        .unit = units::kMillimetre,
                        .meaning = "largest height of the object above its start",
                        .value = max_ - initial_,
                        .shown = false});
    const auto add_lift = [&](const char* path, const char* meaning, double value) {
      results->push_back({.path = path,
                          .group = "Lift by the script",
                          .unit = units::kMillimetre,
                          .meaning = meaning,
                          .value = lift_ended_ ? value : NAN,
                          .shown = false,
                          .compared = false});
    };
    add_lift("object.scripted_lift_m",
             "height by which the script's first upward action intends to move the object; null: "
             "there is none, or the run ended before",
             lift_.height);
    add_lift("object.scripted_rise_m", "height by which the object rose during this action",
             highest_lift_ - before_lift_);
  }

 private:
  const Lift lift_;
  double before_lift_ = NAN, highest_lift_ = NAN;  // [m]
  bool lift_ended_ = false;
  double initial_ = NAN, min_ = NAN, max_ = NAN, final_ = NAN;  // [m]
};

}  // namespace

const MetricKind kObjectHeight = {.make = MakeMetric<ObjectHeight>};

}  // namespace predictor::metrics
