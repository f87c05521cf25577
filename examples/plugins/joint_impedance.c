/* Springs and dampers in the joints, tau = g + K (posture - q) - d M v, as a plug-in in C.
 *
 * The damping is proportional to the mass matrix M, because the controller computes only once per
 * period dt. A damper D turns unstable at a joint of inertia m if D dt / m > 2, so a D that suits
 * the first joint lets a light last joint chatter. With D = d M, d dt decides for all joints alike.
 * A spring turns unstable if K dt^2 / m > 4; `predictor check` names the joint.
 *
 * Parameters, each for all joints: joint_stiffness K [N·m/rad], damping_rate d [1/s].
 * Build, in the root of the repository:
 *   cc -std=c11 -O2 -shared -fPIC -I include examples/plugins/joint_impedance.c -o
 * joint_impedance.so
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "predictor/controller.h"

typedef struct {
  int dof;
  double posture[PREDICTOR_MAX_JOINTS]; /* [rad] */
  double stiffness;                     /* K [N·m/rad] */
  double damping_rate;                  /* d [1/s] */
} JointImpedance;

/* Returns 0 for a wrong parameter, and writes the mistake, its place and the remedy to `error`. */
static int read_parameter(JointImpedance* self, const PredictorParameter* parameter, char* error,
                          size_t error_size) {
  double* to = strcmp(parameter->key, "joint_stiffness") == 0 ? &self->stiffness
               : strcmp(parameter->key, "damping_rate") == 0  ? &self->damping_rate
                                                              : NULL;
  char* end = NULL;
  if (to == NULL) {
    snprintf(error, error_size,
             "In cobot.controller.parameters, \"%s\" is not one of its parameters. Use "
             "joint_stiffness or damping_rate.",
             parameter->key);
    return 0;
  }
  *to = strtod(parameter->value, &end);
  if (end != parameter->value && *end == '\0' && *to >= 0 && isfinite(*to)) return 1;
  snprintf(error, error_size,
           "In cobot.controller.parameters, %s is \"%s\". Give a finite number from 0, such as "
           "%s=100.",
           parameter->key, parameter->value, parameter->key);
  return 0;
}

static void* create(const PredictorControllerConfig* config, char* error, size_t error_size) {
  JointImpedance* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->dof = config->dof;
  self->stiffness = 100;
  self->damping_rate = 50;
  memcpy(self->posture, config->posture, sizeof self->posture);
  for (int i = 0; i < config->parameter_count; ++i) {
    if (read_parameter(self, &config->parameters[i], error, error_size)) continue;
    free(self);
    return NULL;
  }
  return self;
}

static void compute(void* self_, const PredictorControllerInput* input, double* torque) {
  const JointImpedance* self = self_;
  for (int j = 0; j < self->dof; ++j) {
    double momentum = 0; /* of joint j, (M v)_j; M is symmetric */
    for (int k = 0; k < self->dof; ++k) momentum += input->M[k + self->dof * j] * input->v[k];
    torque[j] = input->g[j] + self->stiffness * (self->posture[j] - input->q[j]) -
                self->damping_rate * momentum;
  }
}

static uint32_t reads(void* self) {
  (void)self;
  return PREDICTOR_READS_M;
}

static double stored_energy(void* self_, const PredictorControllerInput* input) {
  const JointImpedance* self = self_;
  double sum = 0;
  for (int j = 0; j < self->dof; ++j) {
    const double x = self->posture[j] - input->q[j];
    sum += self->stiffness * (x * x);
  }
  return 0.5 * sum;
}

const PredictorController* predictor_controller(void) {
  static const PredictorController functions = {
      .version = PREDICTOR_CONTROLLER_VERSION,
      .input_size = sizeof(PredictorControllerInput),
      .create = create,
      .destroy = free,
      .compute = compute,
      .reads = reads,
      .stored_energy = stored_energy,
  };
  return &functions;
}
