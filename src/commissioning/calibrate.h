// What is measured together with a person beside the arms: handle, bases, velocity loop, and the
// test of pushes. Each tells the person what to do and returns what was found; the machine file is
// written by whoever called. Errors: InputError (a refusal, or the person gives up), DeviceError.
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

namespace predictor {

// Poses into which the person leads the arm by its own free-drive; we only read.
HandleCalibration MeasureHandle(Session* session, const Station& station);

// Points that the person touches with the tip of arm A, then, in the same order, with that of arm
// B; `tip`: where it is in E [m], of both. None: the person is asked whether E's origin touches.
BaseCalibration MeasureBases(Session* session, const Station& a, const Station& b,
                             const std::optional<Vector3>& tip);

struct SwingOptions {
  MachineLimits limits;
  EnablingContact enabling;
  ChirpOptions chirp;
};

// Swings one joint after the other, while the person consents (motion_watch.h) and nobody touches
// the handle. No joint goes faster than moves the handle by `limits.align_speed`. Letting go brings
// the joint to rest, and it is measured anew. What a run would stop for, or a joint off its path,
// is an error; however it ends, the arm is brought to rest first, and the person is told. swings:
// goes on with the joints that it lacks; has what was measured where it throws, too.
inline constexpr char kSwingKey = 's';
void SwingJoints(Session* session, Station* station, const SwingOptions& options, Swings* swings);
// The loop out of the swings; tells what each joint alone looks like.
LoopFit FitSwings(Session* session, const std::vector<LoopRecord>& records);

// The person pushes the handle along the axes of the world. `other`: the other hand's, or null.
// Returns if all read as pushed; else it throws what they look like.
void TestPushes(Session* session, const Station& pushed, const Station* other);

}  // namespace predictor
