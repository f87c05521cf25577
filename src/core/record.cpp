#include "core/record.h"

namespace predictor {

StatusRecord ToRecord(const Status& status) {
  return {status.cause, status.hand,  status.quantity, status.power_off,
          {},           status.value, status.limit};
}

Status FromRecord(const StatusRecord& r) {
  return {r.cause, r.hand, r.value, r.limit, r.quantity, r.power_off != 0};
}

PoseRecord ToRecord(const Pose& X) {
  return {{X.p.x(), X.p.y(), X.p.z()}, {X.q.w(), X.q.x(), X.q.y(), X.q.z()}};
}

Pose FromRecord(const PoseRecord& r) {
  return {Vector3(r.p[0], r.p[1], r.p[2]), Quaternion(r.q[0], r.q[1], r.q[2], r.q[3])};
}

}  // namespace predictor
