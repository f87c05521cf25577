#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "commissioning/calibrate.h"
#include "commissioning/motion_watch.h"
#include "core/error.h"
#include "core/format.h"

namespace predictor {
namespace {

constexpr double kRest = 0.4;              // before and after a swing [s]
constexpr double kPathWidth = 0.02;        // off the path is off [rad]
constexpr double kMargin = 0.05;           // from a joint's limit [rad]
constexpr double kAccelerationPart = 0.3;  // of the joint's limit

// One joint's swing while the person consents.
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

  // The record; none if it was let go, or held up, before the end. However it ends, the arm rests,
  // and the person is told so where it did not end as it should.
  std::optional<LoopRecord> Run() try {
    const double begin = session_->Now();
    for (double now = begin; now - begin < chirp_.duration() + 2 * kRest; now = session_->Now()) {
      if (!consent_->Update(session_->key(), now)) {
        session_->Tell(Rest() + " Let go: this joint begins again.");
        return std::nullopt;
      }
      Tick(chirp_.v(now - begin - kRest));
    }
    Rest();
    return std::move(recorder_).Finish();
  } catch (const HeldUp& late) {
    session_->Tell(Rest() + " " + late.what() + " Let go: this joint begins again.");
    consent_->Revoke(session_->Now());
    return std::nullopt;
  } catch (...) {
    session_->Tell(Rest());
    throw;
  }

 private:
  std::string Rest() { return session_->BringToRest(station_, chirp_.acceleration()); }

  void Tick(double v) {
    JointVector command = JointVector::Zero(start_.size());
    command[joint_] = v;
    session_->Step(station_, [&] {
      watch_->Check(session_->Now());
      CheckPath();
      return command = watch_->Bounded(command);
    });
    const ArmReading& reading = station_->reading();
    if (station_->fresh_joints()) recorder_.Seen(session_->Now() - reading.age, reading.q[joint_]);
    recorder_.Told(session_->Now(), command[joint_]);
  }

  void CheckPath() const {
    const JointVector way = (station_->reading().q - start_).cwiseAbs();
    for (int j = 0; j < way.size(); ++j)
      if (way[j] > (j == joint_ ? chirp_.reach() : 0) + kPathWidth)
        throw InputError(
            Formatted("Joint %d left its path: it is %.0f mrad from where it began. "
                      "Nothing was written.",
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
        Formatted("Joint %d is only %.0f mrad from its limit. Lead the arm to a more "
                  "comfortable pose.",
                  joint + 1, 1e3 * room));
}

void Await(Consent* consent, Session* session) {
  while (!consent->Update(session->key(), session->Now())) session->Step();
}

// What the person is told to do, for as long as the arm may move.
std::string HowToHold(const SwingOptions& options) {
  return options.enabling.station == nullptr
             ? Formatted("hold %c", kSwingKey)
             : Formatted("hold the enabling device and touch %c", kSwingKey);
}

}  // namespace

std::vector<LoopRecord> SwingJoints(Session* session, Station* station,
                                    const SwingOptions& options) {
  const ChirpOptions& chirp_options = options.chirp;
  session->Tell(Formatted(
      "THE %s ARM MOVES: each joint swings a little (%.0f mrad at most), for %.0f s. Hands off the "
      "handle, nobody within reach, one hand on the emergency stop. For as long as it may move, "
      "%s; letting go stops it, and so does any other key.",
      station->name() == "left" ? "LEFT" : "RIGHT", 1e3 * chirp_options.angle,
      2 * chirp_options.time, HowToHold(options).c_str()));
  MotionWatch watch(*station, options.limits);
  watch.Tare(session);
  Consent consent(kSwingKey, options.enabling);
  std::vector<LoopRecord> records;
  while (static_cast<int>(records.size()) < station->model().dof()) {
    const int joint = static_cast<int>(records.size());
    session->Tell(Formatted("Joint %d of %d: %s.", joint + 1, station->model().dof(),
                            HowToHold(options).c_str()));
    Await(&consent, session);
    const Chirp chirp(OptionsFor(*station, joint, options.limits.align_speed, chirp_options));
    CheckRoom(*station, joint, chirp.reach());
    if (auto record = Swing(session, station, joint, chirp, &consent, &watch).Run())
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
