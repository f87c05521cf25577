// Hazards that affect what the cobot assumes or senses. These hazards concern the cobot's payload,
// friction and wrist sensor.
#include "simulation/hazards/hazards.h"

namespace predictor::hazards {
namespace {

struct WrongPayloadParameters {
  double mass = 2;  // [kg]
};

template <class V>
void Fields(V& v, WrongPayloadParameters& p) {
  v("payload_error", p.mass,
    Number("kg", "mass by which the controller overestimates the load at the end-effector",
           Within(1000)));
}

struct WrongFrictionParameters {
  double coulomb = 3, viscous = 0;
};

template <class V>
void Fields(V& v, WrongFrictionParameters& p) {
  v("coulomb_error", p.coulomb,
    Number("N·m", "Coulomb friction by which the controller overcompensates each joint",
           Within(1000)));
  v("viscous_error", p.viscous,
    Number("N·m·s/rad", "viscous friction by which the controller overcompensates each joint",
           Within(1e4)));
}

struct SensorBiasParameters {
  Vector3 force = {0, 0, 10}, torque = {0, 0, 0};
};

template <class V>
void Fields(V& v, SensorBiasParameters& p) {
  v("force_bias", p.force, Number("N", "force added to the reading, in axes of W", Within(1000)));
  v("torque_bias", p.torque,
    Number("N·m", "torque added to the reading, in axes of W", Within(1000)));
}

struct SensorDriftParameters {
  Vector3 force = {0, 0, 2}, torque = {0, 0, 0};
};

template <class V>
void Fields(V& v, SensorDriftParameters& p) {
  v("force_drift", p.force,
    Number("N/s", "drift of the force reading, in axes of W", Within(1000)));
  v("torque_drift", p.torque,
    Number("N·m/s", "drift of the torque reading, in axes of W", Within(1000)));
}

void MistakePayload(const WrongPayloadParameters& p, double, Disturbance* d) noexcept {
  d->payload += p.mass;
}

void MistakeFriction(const WrongFrictionParameters& p, double, Disturbance* d) noexcept {
  d->coulomb += p.coulomb;
  d->viscous += p.viscous;
}

void BiasSensor(const SensorBiasParameters& p, double, Disturbance* d) noexcept {
  d->sensor.head<3>() += p.force;
  d->sensor.tail<3>() += p.torque;
}

void DriftSensor(const SensorDriftParameters& p, double elapsed, Disturbance* d) noexcept {
  d->sensor.head<3>() += elapsed * p.force;
  d->sensor.tail<3>() += elapsed * p.torque;
}

}  // namespace

const HazardKind kWrongPayload = HazardKindOf<WrongPayloadParameters, MistakePayload>(
    "wrong_payload", "the controller compensates for a load that does not exist",
    "the controller assumed a wrong payload");

const HazardKind kWrongFriction = HazardKindOf<WrongFrictionParameters, MistakeFriction>(
    "wrong_friction", "the controller compensates for friction that does not exist",
    "the controller assumed wrong friction");

const HazardKind kSensorBias = HazardKindOf<SensorBiasParameters, BiasSensor>(
    "sensor_bias", "the wrist sensor's reading jumps", "the wrist sensor's reading jumped",
    HazardNeeds::kWristSensor);

const HazardKind kSensorDrift = HazardKindOf<SensorDriftParameters, DriftSensor>(
    "sensor_drift", "the wrist sensor's reading drifts", "the wrist sensor began to drift",
    HazardNeeds::kWristSensor);

}  // namespace predictor::hazards
