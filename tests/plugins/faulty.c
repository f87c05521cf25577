/* Faulty plug-ins for the tests. The macro FAULT selects the fault. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "predictor/controller.h"

#define VERSION 1
#define NO_TABLE 2
#define NO_COMPUTE 3
#define NO_SYMBOL 4
#define LONG_MEMORY 5
#define AT_TIME 6

/* A controller of kind AT_TIME carries the cobot's weight until the time "at" and then fails as
 * "fault" states. With the fault "create", it hangs while it is created. With the fault
 * "allocate_once", it allocates memory in its first call. */
typedef struct {
  double at;
  char fault[16];
  double damping, posture[PREDICTOR_MAX_JOINTS];
  uint32_t reads;
  int was_called;
  volatile int zero;     /* always 0 */
  volatile int* nowhere; /* always NULL */
} Faulty;

static int HasParameter(const PredictorControllerConfig* config, const char* key,
                        const char* value) {
  for (int i = 0; i < config->parameter_count; ++i)
    if (strcmp(config->parameters[i].key, key) == 0 &&
        strcmp(config->parameters[i].value, value) == 0)
      return 1;
  return 0;
}

static void* create(const PredictorControllerConfig* config, char* error, size_t error_size) {
  Faulty* self = calloc(1, sizeof *self);
  if (self == NULL) return NULL;
  if (config->dof != 7) {
    snprintf(error, error_size, "It is for 7 joints, not %d.", (int)config->dof);
    free(self);
    return NULL;
  }
  while (HasParameter(config, "fault", "create")) sleep(1);
  self->at = INFINITY;
  self->damping = 10;
  self->reads = PREDICTOR_READS_ALL;
  memcpy(self->posture, config->posture, sizeof self->posture);
  for (int i = 0; i < config->parameter_count; ++i) {
    if (strcmp(config->parameters[i].key, "at") == 0) self->at = atof(config->parameters[i].value);
    if (strcmp(config->parameters[i].key, "reads") == 0)
      self->reads = (uint32_t)atoi(config->parameters[i].value);
    if (strcmp(config->parameters[i].key, "damping") == 0)
      self->damping = atof(config->parameters[i].value);
    if (strcmp(config->parameters[i].key, "fault") == 0)
      snprintf(self->fault, sizeof self->fault, "%s", config->parameters[i].value);
  }
  return self;
}

static void Allocate(void) {
  static void* volatile taken;
  taken = malloc(64);
  free(taken);
}

static void compute(void* self_, const PredictorControllerInput* input, double* torque) {
  Faulty* self = self_;
  for (int j = 0; j < input->dof; ++j)
    torque[j] = input->g[j] + 400 * (self->posture[j] - input->q[j]) - self->damping * input->v[j];
  if (strcmp(self->fault, "allocate_once") == 0 && !self->was_called) Allocate();
  self->was_called = 1;
  if (input->time < self->at) return;
  if (strcmp(self->fault, "nan") == 0) torque[1] = torque[3] = NAN;
  if (strcmp(self->fault, "h") == 0) memcpy(torque, input->h, sizeof input->X_WO);
  if (strcmp(self->fault, "J") == 0) memcpy(torque, input->J, sizeof input->X_WO);
  if (strcmp(self->fault, "M") == 0) memcpy(torque, input->M, sizeof input->X_WO);
  if (strcmp(self->fault, "object") == 0) memcpy(torque, input->X_WO, sizeof input->X_WO);
  if (strcmp(self->fault, "crash") == 0) abort();
  if (strcmp(self->fault, "access") == 0) *self->nowhere = 1;
  if (strcmp(self->fault, "divide") == 0) torque[0] = 7 / self->zero; /* 1 / x needs no division */
  while (strcmp(self->fault, "hang") == 0) sleep(1);
  if (strcmp(self->fault, "allocate") == 0) Allocate();
}

static uint32_t reads(void* self) { return ((Faulty*)self)->reads; }

static double numbers[PREDICTOR_MAX_MEMORY + 1];
static double* memory(void* self, int32_t* size) {
  (void)self;
  *size = PREDICTOR_MAX_MEMORY + 1;
  return numbers;
}

#if FAULT != NO_SYMBOL
const PredictorController* predictor_controller(void) {
  static PredictorController functions;
  functions.version = PREDICTOR_CONTROLLER_VERSION + (FAULT == VERSION ? 1 : 0);
  functions.input_size = sizeof(PredictorControllerInput);
  functions.create = create;
  functions.destroy = free;
  functions.compute = FAULT == NO_COMPUTE ? NULL : compute;
  functions.reads = reads;
  functions.memory = FAULT == LONG_MEMORY ? memory : NULL;
  return FAULT == NO_TABLE ? NULL : &functions;
}
#else
PREDICTOR_EXPORT void* const unused[] = {(void*)create, (void*)compute, (void*)memory,
                                         (void*)reads};
#endif
