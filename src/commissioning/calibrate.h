// Measurements in which a person next to the arms takes part: handle, bases, velocity loop, and the
// push test. Each function instructs the person and returns a result. The caller writes the machine
// file. The functions throw InputError (if a result is refused or the person gives up) and
// DeviceError.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commissioning/bases.h"
#include "commissioning/chirp.h"
#include "commissioning/handle.h"
#include "commissioning/loop_fit.h"
#include "commissioning/motion_watch.h"
#include "commissioning/session.h"

namespace predictor::commissioning {

// The person guides the arm into poses in the arm's own free-drive mode. The program only reads.
HandleCalibration MeasureHandle(Session* session, const Station& station);

// The person touches points with the tip of arm A and then, in the same order, with the tip of arm
// B. `tip` is the position of the tip in E [m], for both arms. If `tip` is empty, the program asks
// the person whether the origin of E touches the points.
BaseCalibration MeasureBases(Session* session, const Station& a, const Station& b,
                             const std::optional<Vector3>& tip);

struct SwingOptions {
  MachineLimits limits;
  EnablingContact enabling;
  ChirpOptions chirp;
};

// Swings one joint after the other, while the person consents (motion_watch.h) and no one touches
// the handle. The speed of each joint is limited so that the handle does not exceed
// `limits.align_speed`. If the person releases the key, the joint comes to rest and is measured
// again. Any condition that would stop a run is an error. A joint that leaves its planned path is
// also an error. In every case, the arm first comes to rest, and the person is notified. The
// function measures only the joints that `swings` does not contain yet. Finished joints are added
// to `swings` even if the function throws.
inline constexpr char kSwingKey = 's';
void SwingJoints(Session* session, Station* station, const SwingOptions& options, Swings* swings);
// Fits the loop to the swings, and shows the separate result of each joint.
LoopFit FitSwings(Session* session, const std::vector<LoopRecord>& records);

// The person pushes the handle along the axes of the world. `other` is the station of the other
// hand, or null. Returns normally if every push is read correctly. Otherwise, throws InputError
// with a message that describes the pattern of the readings.
void TestPushes(Session* session, const Station& pushed, const Station* other);

}  // namespace predictor::commissioning
