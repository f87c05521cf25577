// Injects faults into the solvers that the tick calls. The linker redirects the calls to wrappers
// (-Wl,--wrap).
#pragma once

namespace predictor {

enum class QpFault { kNone, kInfeasible, kIterationLimit, kWrong, kNotANumber };
enum class PhysicsFault { kNone, kNotANumber, kDiverges };

// From now on, the fault occurs in this process.
void BreakQp(QpFault fault);
void BreakPhysics(PhysicsFault fault);

}  // namespace predictor
