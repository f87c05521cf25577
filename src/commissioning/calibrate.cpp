#include "commissioning/calibrate.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "commissioning/feeler.h"
#include "commissioning/push_test.h"
#include "core/error.h"
#include "core/format.h"

namespace predictor::commissioning {
namespace {

constexpr double kPatience = 10;  // longest wait for the readings of one pose [s]

// Collects readings for one second at rest. Returns the reason why the pose cannot be used, or ""
// if it can be used.
std::string TakePose(Session* session, const Station& station, PoseRecorder* recorder) {
  recorder->Begin();
  const double begin = session->Now();
  while (!recorder->complete()) {
    if (session->Now() - begin > kPatience) return recorder->Refusal();
    session->Step();
    if (station.fresh_wrench())
      recorder->Add(station.reading().q, station.GravityInSensor(), station.wrench().F_S,
                    session->Now());
  }
  return recorder->Refusal();
}

// Describes a pose to help the person choose the next pose.
std::string PoseText(std::size_t number, const RestingPose& pose) {
  const Vector3 down = pose.g_S.normalized();
  return Formatted("Pose %zu taken. Down is (%+.2f, %+.2f, %+.2f) in the sensor's frame.", number,
                   down.x(), down.y(), down.z());
}

// Waits until the tip rests, and returns the tip's position in the frame of the arm's base.
Vector3 TakePoint(Session* session, const Station& station, const Vector3& tip) {
  constexpr int kSamples = 100;
  constexpr double kRests = 0.0005;  // [m]
  for (;;) {
    Vector3 sum = Vector3::Zero(), first = Vector3::Zero();
    double moved = 0;
    for (int n = 0; n < kSamples;) {
      session->Step();
      if (!station.fresh_joints()) continue;
      const Vector3 p =
          station.spec().arm.base.X_RB().Inverse() * (station.EndEffectorPose() * tip);
      if (n == 0) first = p;
      moved = std::max(moved, (p - first).norm());
      sum += p;
      ++n;
    }
    if (moved <= kRests) return sum / kSamples;
    session->Ask(
        Formatted("The tip moved by %.1f mm. Hold the tip still and press Enter.", 1e3 * moved),
        {kEnter});
  }
}

// Collects points of one arm. `count` is the number of points, or 0 if the person decides.
std::vector<Vector3> TakePoints(Session* session, const Station& station, const Vector3& tip,
                                std::size_t count) {
  std::vector<Vector3> points;
  for (;;) {
    const bool enough = count == 0 && points.size() >= static_cast<std::size_t>(kMinBasePoints);
    if (count > 0 && points.size() == count) return points;
    const char key =
        session->Ask(Formatted("Touch point %zu with the tip of the %s arm and press Enter%s.",
                               points.size() + 1, station.name().c_str(),
                               enough ? ", or d if all points are done" : ""),
                     enough ? std::string{kEnter, 'd'} : std::string{kEnter});
    if (key == 'd') return points;
    points.push_back(TakePoint(session, station, tip));
    session->Show(Formatted("  at (%.1f, %.1f, %.1f) mm in its base.", 1e3 * points.back().x(),
                            1e3 * points.back().y(), 1e3 * points.back().z()));
  }
}

// A wrong tip shifts the bases, and the residuals may not reveal it.
void AskForNoTip(Session* session, const Station& a, const Station& b) {
  const char answer = session->Ask(
      Formatted("No --tip was given, so the end-effector's origin must touch the points (the "
                "end-effector of the %s arm is %s; the end-effector of the %s arm is %s). Do the "
                "end-effectors' origins of both arms touch the "
                "points? Press y or n.",
                a.name().c_str(), a.spec().arm.end_effector.c_str(), b.name().c_str(),
                b.spec().arm.end_effector.c_str()),
      "yn");
  if (answer == 'n')
    throw InputError(
        "Nothing was written. Start again with --tip X Y Z, the position of the tip in the "
        "end-effector's frame [m], for example --tip 0 0 0.18.");
}

Wrench Feel(Feeler* feeler, const Station& station) {
  HandWrench hand;
  if (!feeler->Feel(&hand).ok())
    throw DeviceError("The " + station.name() + " sensor is outside its range.");
  return hand.F_H_W;
}

// One push that is read incorrectly shows that there is an error, but only the three pushes
// together identify this error.
void ShowReading(Session* session, const PushTest& test, int axis) {
  session->Show(Formatted("  reads %s.", Name(test.readings()[static_cast<std::size_t>(axis)])));
  if (const std::string wrong = test.Wrong(axis); !wrong.empty())
    session->Show(
        "  DIFFERS FROM THE PUSH. " + wrong +
        (test.done()
             ? ""
             : " Continue anyway, because only all three pushes together show the reason."));
}

}  // namespace

HandleCalibration MeasureHandle(Session* session, const Station& station) {
  session->Show(Formatted(
      "The handle of the %s arm must be measured in at least %d poses. For each pose, "
      "guide the arm in free-drive and tilt the handle in a new direction. For the best "
      "result, let each axis of the handle point down once. Then take your hands off the arm.",
      station.name().c_str(), kMinHandlePoses));
  PoseRecorder recorder(station.spec().arm.sensor);
  std::vector<RestingPose> poses;
  for (;;) {
    const char key = session->Ask(
        Formatted(
            "Pose %zu: press Enter to take the pose%s, u to remove the last pose, or q to cancel.",
            poses.size() + 1,
            poses.size() >= static_cast<std::size_t>(kMinHandlePoses) ? ", d to finish" : ""),
        {kEnter, 'd', 'u'});
    if (key == 'u') {
      if (!poses.empty()) poses.pop_back();
    } else if (key == 'd') {
      try {
        return CalibrateHandle(poses, station.spec().arm.sensor);
      } catch (const InputError& error) {
        session->Show(error.what());
      }
    } else if (const std::string refusal = TakePose(session, station, &recorder);
               !refusal.empty()) {
      session->Show(refusal);
    } else {
      poses.push_back(recorder.pose());
      session->Show(PoseText(poses.size(), poses.back()));
    }
  }
}

BaseCalibration MeasureBases(Session* session, const Station& a, const Station& b,
                             const std::optional<Vector3>& given) {
  if (!given) AskForNoTip(session, a, b);
  const Vector3 tip = given.value_or(Vector3::Zero());
  session->Show(
      "Mark three points or more (six are better) that both arms can reach. The points must be far "
      "apart, not on a line, and not all at the same height. Guide the arms in free-drive.");
  const std::vector<Vector3> by_a = TakePoints(session, a, tip, 0);
  const std::vector<Vector3> by_b = TakePoints(session, b, tip, by_a.size());
  std::vector<TouchedPoint> points;
  for (std::size_t i = 0; i < by_a.size(); ++i) points.push_back({by_a[i], by_b[i]});
  return CalibrateBases(points);
}

void TestPushes(Session* session, const Station& pushed, const Station* other) {
  Feeler own(pushed);
  own.Tare(session);
  std::optional<Feeler> far;
  if (other) far.emplace(*other).Tare(session);
  PushTest test;
  int shown = -1;
  double since = session->Now();
  auto hint = PushTest::Hint::kNone;
  while (!test.done()) {
    session->Step();
    test.Update(Feel(&own, pushed), far ? Feel(&*far, *other) : Wrench::Zero(), Session::kStep);
    if (test.axis() != shown) {
      if (shown >= 0) ShowReading(session, test, shown);
      shown = test.axis();
      if (test.done()) break;
      session->Show(
          Formatted("Push the %s handle steadily along +%c of the world%s with 5 to 25 N.",
                    pushed.name().c_str(), "xyz"[shown], shown == 2 ? " (up)" : ""));
      since = session->Now();
    }
    // A hint is shown when its reason has persisted for some time, and is repeated later.
    if (test.hint() != hint || test.hint() == PushTest::Hint::kNone) since = session->Now();
    hint = test.hint();
    if (session->Now() - since > 2) {
      session->Show(Sentence(hint));
      since = session->Now() + 3;
    }
  }
  if (!test.passed()) throw InputError(test.Refusal());
}

}  // namespace predictor::commissioning
