#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "commissioning/calibrate.h"
#include "core/error.h"
#include "core/format.h"

namespace predictor {
namespace {

constexpr double kRest = 0.4;              // before and after a swing [s]
constexpr double kPathWidth = 0.02;        // off the path is off [rad]
constexpr double kMargin = 0.05;           // from a joint's limit [rad]
constexpr double kTouch = 15;              // by which the wrench may change [N]
constexpr double kTouchTorque = 3;         // [N·m]
constexpr double kAccelerationPart = 0.3;  // of the joint's limit

// One joint's swing while the key is held.
class Swing {
 public:
  Swing(Session* session, Station* station, int joint, const Chirp& chirp, HeldKey* key)
      : session_(session),
        station_(station),
        joint_(joint),
        chirp_(chirp),
        key_(key),
        start_(station->reading().q),
        wrench_(station->wrench().F_S),
        recorder_(joint) {}

  // The record; none if the key was let go before the end. However it ends, the arm rests, and the
  // person is told so where it did not end as it should.
  std::optional<LoopRecord> Run() try {
    const double begin = session_->Now();
    for (double now = begin; now - begin < chirp_.duration() + 2 * kRest; now = session_->Now()) {
      if (!key_->Update(session_->key(), now)) {
        session_->Tell(Rest() + " Let go: this joint begins again.");
        return std::nullopt;
      }
      Tick(chirp_.v(now - begin - kRest));
    }
    Rest();
    return std::move(recorder_).Finish();
  } catch (...) {
    session_->Tell(Rest());
    throw;
  }

 private:
  std::string Rest() { return session_->BringToRest(station_, chirp_.acceleration()); }

  void Tick(double v) {
    JointVector command = JointVector::Zero(start_.size());
    command[joint_] = v;
    session_->Step(station_, command);
    const ArmReading& reading = station_->reading();
    if (station_->fresh_joints()) recorder_.Seen(session_->Now() - reading.age, reading.q[joint_]);
    recorder_.Told(session_->Now(), v);
    Check(reading);
  }

  void Check(const ArmReading& reading) {
    const JointVector way = (reading.q - start_).cwiseAbs();
    const Wrench change = (station_->wrench().F_S - wrench_).cwiseAbs();
    std::string trouble;
    for (int j = 0; j < way.size(); ++j)
      if (way[j] > (j == joint_ ? chirp_.reach() : 0) + kPathWidth)
        trouble = Formatted("Joint %d left its path by %.0f mrad.", j + 1, 1e3 * way[j]);
    if (change.head<3>().maxCoeff() > kTouch || change.tail<3>().maxCoeff() > kTouchTorque)
      trouble = "Something touches the handle.";
    if (!trouble.empty()) throw InputError(trouble + " Nothing was written.");
  }

  Session* session_;
  Station* station_;
  int joint_;
  const Chirp& chirp_;
  HeldKey* key_;
  JointVector start_;
  Wrench wrench_;
  LoopRecorder recorder_;
};

ChirpOptions OptionsFor(const Station& station, int joint, double speed, ChirpOptions options) {
  const double lever = std::max(station.Lever(joint), 0.1);
  const double limit = OneOrEach(station.spec().arm.acceleration_limit, joint);
  options.speed = std::min(options.speed, speed / lever);
  options.acceleration = std::min(options.acceleration, kAccelerationPart * limit);
  return options;
}

void CheckRoom(const Station& station, int joint, double reach) {
  const double q = station.reading().q[joint];
  const RobotModel& model = station.model();
  const double room =
      std::min(q - model.position_lower()[joint], model.position_upper()[joint] - q);
  if (room < reach + kMargin)
    throw InputError(
        Formatted("Joint %d is only %.0f mrad from its limit. Lead the arm to a more "
                  "comfortable pose.",
                  joint + 1, 1e3 * room));
}

void AwaitKey(Session* session, HeldKey* key) {
  while (!key->Update(session->key(), session->Now())) session->Step();
}

}  // namespace

std::vector<LoopRecord> SwingJoints(Session* session, Station* station, double speed,
                                    const ChirpOptions& options) {
  session->Tell(Formatted(
      "THE %s ARM MOVES: each joint swings a little (%.0f mrad at most), for %.0f s. Hands off the "
      "handle, nobody within reach, one hand on the emergency stop. Hold %c for as long as it may "
      "move; letting go stops it.",
      station->name() == "left" ? "LEFT" : "RIGHT", 1e3 * options.angle, 2 * options.time,
      kSwingKey));
  HeldKey key(kSwingKey);
  std::vector<LoopRecord> records;
  while (static_cast<int>(records.size()) < station->model().dof()) {
    const int joint = static_cast<int>(records.size());
    session->Tell(
        Formatted("Joint %d of %d: hold %c.", joint + 1, station->model().dof(), kSwingKey));
    AwaitKey(session, &key);
    const Chirp chirp(OptionsFor(*station, joint, speed, options));
    CheckRoom(*station, joint, chirp.reach());
    if (auto record = Swing(session, station, joint, chirp, &key).Run())
      records.push_back(std::move(*record));
  }
  return records;
}

LoopFit FitSwings(Session* session, const std::vector<LoopRecord>& records) {
  for (const LoopRecord& record : records) try {
      const LoopFit fit = FitLoop(std::span(&record, 1));
      session->Tell(Formatted("  joint %d alone: %.1f Hz, %.2f, %.1f ms; lag %.1f ms",
                              record.joint + 1, fit.bandwidth.value, fit.damping_ratio.value,
                              1e3 * fit.delay.value, 1e3 * fit.lag()));
    } catch (const InputError& error) {
      session->Tell(Formatted("  joint %d alone: %s", record.joint + 1, error.what()));
    }
  return FitLoop(records);
}

}  // namespace predictor
