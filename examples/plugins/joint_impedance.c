/* Springs and dampers in the joints, tau = g + K (posture - q) - D v, as a plug-in in C.
 *
 * Parameters, each for all joints: joint_stiffness [N·m/rad], joint_damping [N·m·s/rad].
 * Build: cc -std=c11 -O2 -shared -fPIC -I include joint_impedance.c -o joint_impedance.so */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "predictor/controller.h"

typedef struct {
  int dof;
  double posture[PREDICTOR_MAX_JOINTS]; /* [rad] */
  double stiffness;                     /* [N·m/rad] */
  double damping;                       /* [N·m·s/rad] */
} JointImpedance;

static int read_parameter(JointImpedance* self, const PredictorParameter* parameter) {
  double* to = strcmp(parameter->key, "joint_stiffness") == 0 ? &self->stiffness
               : strcmp(parameter->key, "joint_damping") == 0 ? &self->damping
                                                              : NULL;
  char* end = NULL;
  if (to == NULL) return 0;
  *to = strtod(parameter->value, &end);
  return end != parameter->value && *end == '\0' && *to >= 0;
}

static void* create(const PredictorControllerConfig* config, char* error, size_t error_size) {
  JointImpedance* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  self->dof = config->dof;
  self->stiffness = 100;
  self->damping = 5;
  memcpy(self->posture, config->posture, sizeof self->posture);
  for (int i = 0; i < config->parameter_count; ++i) {
    const PredictorParameter* parameter = &config->parameters[i];
    if (read_parameter(self, parameter)) continue;
    snprintf(error, error_size,
             "\"%s=%s\" is not one of its parameters: joint_stiffness and joint_damping, numbers "
             "from 0.",
             parameter->key, parameter->value);
    free(self);
    return NULL;
  }
  return self;
}

static void compute(void* self_, const PredictorControllerInput* input, double* torque) {
  const JointImpedance* self = self_;
  for (int j = 0; j < self->dof; ++j)
    torque[j] = input->g[j] + self->stiffness * (self->posture[j] - input->q[j]) -
                self->damping * input->v[j];
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
      .stored_energy = stored_energy,
  };
  return &functions;
}
