// Faults of the solvers that the tick calls, at their own doors: the test program is linked so that
// calls of them pass through here first (-Wl,--wrap).
#pragma once

namespace predictor {

enum class QpFault { kNone, kInfeasible, kIterationLimit, kWrong, kNotANumber };
enum class PhysicsFault { kNone, kNotANumber, kDiverges };

// From now on, of this process.
void BreakQp(QpFault fault);
void BreakPhysics(PhysicsFault fault);

}  // namespace predictor
