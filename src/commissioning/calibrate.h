// What is measured together with a person beside the arms: handle, bases, velocity loop, and the
// test of pushes. Each tells the person what to do and returns what was found; the machine file is
// written by whoever called. Errors: InputError (a refusal, or the person gives up), DeviceError.
#pragma once

#include <string>
#include <vector>

#include "commissioning/bases.h"
#include "commissioning/chirp.h"
#include "commissioning/handle.h"
#include "commissioning/loop_fit.h"
#include "commissioning/session.h"

namespace predictor {

// Poses into which the person leads the arm by its own free-drive; we only read.
HandleCalibration MeasureHandle(Session* session, const Station& station);

// Points that the person touches with the tip of arm A, then, in the same order, with that of arm
// B; `tip`: where it is in E [m], of both.
BaseCalibration MeasureBases(Session* session, const Station& a, const Station& b,
                             const Vector3& tip);

// Swings one joint after the other, while the person holds the enabling key and nobody touches the
// handle. No joint goes faster than moves the handle by `speed` [m/s]. Letting go brings the joint
// to rest, and it begins again. Beyond a joint's limits, off its path, or touched: refused.
inline constexpr char kSwingKey = 's';
std::vector<LoopRecord> SwingJoints(Session* session, Station* station, double speed,
                                    const ChirpOptions& options = {});
// The loop out of the swings; tells what each joint alone looks like.
LoopFit FitSwings(Session* session, const std::vector<LoopRecord>& records);

// The person pushes the handle along the axes of the world. `other`: the other hand's, or null.
// Returns if all read as pushed; else it throws what they look like.
void TestPushes(Session* session, const Station& pushed, const Station* other);

}  // namespace predictor
