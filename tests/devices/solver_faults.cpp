#include "devices/solver_faults.h"

#include <mujoco/mujoco.h>

#include <limits>

extern "C" {
#include "api.h"
#include "constants.h"
#include "support/constants.h"

void __real_daqp_solve(DAQPResult* result, DAQPWorkspace* work);
void __wrap_daqp_solve(DAQPResult* result, DAQPWorkspace* work);
void __real_mj_step2(const mjModel* model, mjData* data);
void __wrap_mj_step2(const mjModel* model, mjData* data);
}

namespace predictor {
namespace {

QpFault qp_fault = QpFault::kNone;
PhysicsFault physics_fault = PhysicsFault::kNone;

}  // namespace

void BreakQp(QpFault fault) { qp_fault = fault; }
void BreakPhysics(PhysicsFault fault) { physics_fault = fault; }

}  // namespace predictor

void __wrap_daqp_solve(DAQPResult* result, DAQPWorkspace* work) {
  using predictor::QpFault;
  __real_daqp_solve(result, work);
  switch (predictor::qp_fault) {
    case QpFault::kNone:
      return;
    case QpFault::kInfeasible:
      result->exitflag = DAQP_EXIT_INFEASIBLE;
      return;
    case QpFault::kIterationLimit:
      result->exitflag = DAQP_EXIT_ITERLIMIT;
      return;
    case QpFault::kWrong:  // the nominal solution without limits
      for (int i = 0; i < work->n; ++i) result->x[i] = 3 * result->x[i] + 0.5;
      return;
    case QpFault::kNotANumber:
      for (int i = 0; i < work->n; ++i) result->x[i] = predictor::kNan;
      return;
  }
}

void __wrap_mj_step2(const mjModel* model, mjData* data) {
  using predictor::PhysicsFault;
  __real_mj_step2(model, data);
  if (predictor::physics_fault == PhysicsFault::kNotANumber) data->qpos[0] = predictor::kNan;
  if (predictor::physics_fault == PhysicsFault::kDiverges) data->qvel[0] = 1e4;
}
