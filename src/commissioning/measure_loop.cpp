#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "commissioning/calibrate.h"
#include "commissioning/motion_watch.h"
#include "core/error.h"
#include "core/format.h"

namespace predictor::commissioning {
namespace {

constexpr double kRest = 0.4;              // time at rest before and after a swing [s]
constexpr double kPathWidth = 0.02;        // a larger deviation from the path is an error [rad]
constexpr double kMargin = 0.05;           // smallest distance from a joint's limit [rad]
constexpr double kAccelerationPart = 0.3;  // share of the joint's acceleration limit
constexpr double kHeldOn = 0.2;            // consent that lasts this long counts as not revoked [s]
constexpr double kRemind = 3;  // interval between two reminders about keys without effect [s]

// The swing of one joint, which lasts only while the person consents.
class Swing {
 public:
  Swing(Session* session, Station* station, int joint, const Chirp& chirp, Consent* consent,
        MotionWatch* watch)
      : session_(session),
        station_(station),
        joint_(joint),
        chirp_(chirp),
        consent_(consent),
        watch_(watch),
        start_(station->reading().q),
        recorder_(joint, 1 / station->spec().arm.sample_rate) {
    watch->Begin();
  }

  // Returns the record, or no value if the key was released or the swing was interrupted. In every
  // case, the arm is brought to rest, and the person is notified if the swing did not end as
  // planned.
  std::optional<LoopRecord> Run() try {
    const double begin = session_->Now();
    for (double now = begin; now - begin < chirp_.duration() + 2 * kRest; now = session_->Now()) {
      if (!consent_->Update(session_->key(), now)) {
        session_->Show(Rest() +
                       " You released the key or device, or pressed another key. This joint will "
                       "be measured again.");
        return std::nullopt;
      }
      Tick(chirp_.v(now - begin - kRest));
    }
    Rest();
    return std::move(recorder_).Finish();
  } catch (const HeldUp& late) {
    session_->Show(Rest() + " " + late.what() + " This joint will be measured again.");
    consent_->Revoke(session_->Now());
    return std::nullopt;
  } catch (...) {
    session_->Show(Rest());
    throw;
  }

 private:
  std::string Rest() { return session_->BringToRest(station_, chirp_.acceleration()); }

  void Tick(double v) {
    JointVector command = JointVector::Zero(start_.size());
    command[joint_] = v;
    session_->Step(station_, [&] {
      watch_->Check(session_->due());
      CheckPath();
      return command = watch_->Bounded(command);
    });
    const ArmReading& reading = station_->reading();
    if (station_->fresh_joints())
      recorder_.AddSample(session_->Now() - reading.age, reading.q[joint_]);
    recorder_.AddCommand(session_->due(), session_->Now(), command[joint_]);
  }

  void CheckPath() const {
    const JointVector way = (station_->reading().q - start_).cwiseAbs();
    for (int j = 0; j < way.size(); ++j)
      if (way[j] > (j == joint_ ? chirp_.reach() : 0) + kPathWidth)
        throw InputError(
            Formatted("Joint %d left its planned path: it is %.0f mrad from its start. Nothing was "
                      "written to the machine file.",
                      j + 1, 1e3 * way[j]));
  }

  Session* session_;
  Station* station_;
  int joint_;
  const Chirp& chirp_;
  Consent* consent_;
  MotionWatch* watch_;
  JointVector start_;
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
        Formatted("Joint %d is only %.0f mrad from its limit. Guide the arm to a pose further from "
                  "its limits.",
                  joint + 1, 1e3 * room));
}

// Returns whether the person consents before `until` [s]. Explains to the person why a key is not
// sufficient.
bool Consents(Consent* consent, Session* session, double until) {
  double touched = HUGE_VAL, reminded = -HUGE_VAL;
  for (double now = session->Now(); now < until; now = session->Now()) {
    if (consent->Update(session->key(), now)) return true;
    if (session->key() == kSwingKey && now - reminded > kRemind) touched = std::min(touched, now);
    if (now - touched > HeldKey::kFirstRepeat) {
      session->Show("Not accepted yet: " + consent->Wanted() + ".");
      touched = HUGE_VAL;
      reminded = now;
    }
    session->Step();
  }
  return false;
}

// Waits until the person consents. If `continues` is true, the measurement of the previous joint
// was completed, so the person may still be consenting.
void Await(Consent* consent, Session* session, const std::string& joint, bool continues) {
  if (continues && Consents(consent, session, session->Now() + kHeldOn)) {
    session->Show(joint + " starts immediately, because the key or device is still held.");
    return;
  }
  session->Show(joint + ": " + consent->Wanted() + ".");
  static_cast<void>(Consents(consent, session, HUGE_VAL));
}

}  // namespace

void SwingJoints(Session* session, Station* station, const SwingOptions& options, Swings* swings) {
  const ChirpOptions& chirp_options = options.chirp;
  const int joints = station->model().dof();
  if (swings->joints != joints) *swings = {joints, {}};
  session->Show(Formatted(
      "THE %s ARM WILL MOVE: each joint oscillates by at most %.0f mrad for %.0f s. Keep your "
      "hands off the handle, keep everyone out of reach, and keep one hand on the emergency stop. "
      "%s to let the arm move. To stop the arm, release the key or press any other key.",
      station->name() == "left" ? "LEFT" : "RIGHT", 1e3 * chirp_options.angle,
      2 * chirp_options.time,
      options.enabling.station == nullptr ? "Hold s" : "Hold the enabling device"));
  MotionWatch watch(*station, options.limits);
  watch.Tare(session);
  Consent consent(kSwingKey, options.enabling);
  consent.Update(0, session->Now());  // a device that is already pressed does not count
  for (bool continues = false; !swings->complete();) {
    const int joint = swings->measured();
    Await(&consent, session, Formatted("Joint %d of %d", joint + 1, joints), continues);
    const Chirp chirp(OptionsFor(*station, joint, options.limits.align_speed, chirp_options));
    CheckRoom(*station, joint, chirp.reach());
    auto record = Swing(session, station, joint, chirp, &consent, &watch).Run();
    continues = record.has_value();
    if (record) swings->records.push_back(std::move(*record));
  }
}

LoopFit FitSwings(Session* session, const std::vector<LoopRecord>& records) {
  for (const LoopRecord& record : records) try {
      const LoopFit fit = FitLoop(std::span(&record, 1));
      session->Show(Formatted("  joint %d alone: %.1f Hz, %.2f, %.1f ms; lag %.1f ms",
                              record.joint + 1, fit.bandwidth.value, fit.damping_ratio.value,
                              1e3 * fit.delay.value, 1e3 * fit.lag()));
    } catch (const InputError& error) {
      session->Show(Formatted("  joint %d alone: %s", record.joint + 1, error.what()));
    }
  return FitLoop(records);
}

}  // namespace predictor::commissioning
