/* The interface of a controller of the virtual cobot that is not part of PREDICTOR: as a shared
 * library (cobot.controller.type: plugin) or as a process of its own (type: process).
 *
 * Plain C11, self-contained. docs/how-to/write-a-controller-plugin.md explains it by example.
 *
 * Conventions: SI units. W is the world (z upwards), E the end-effector, cobot.end_effector of the
 * scenario. Twists are linear, then angular [m/s, rad/s]; wrenches are force, then torque [N, N·m].
 * Quaternions are w, x, y, z. Matrices are stored column by column, without gaps:
 * M[row + dof * column], J[row + 6 * column].
 */
#ifndef PREDICTOR_CONTROLLER_H
#define PREDICTOR_CONTROLLER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface. PREDICTOR refuses a controller of another version. */
#define PREDICTOR_CONTROLLER_VERSION 3u

enum {
  PREDICTOR_MAX_JOINTS = 16,
  PREDICTOR_MAX_MEMORY = 128 /* numbers in the memory of a controller */
};

/* What a controller may use: values that the controller of a real cobot can measure or compute.
 * Only the first `dof` elements of an array per joint are used (dof * dof of M, 6 * dof of J).
 * Each comment begins with the member's offset in bytes, for languages without C headers. */
typedef struct PredictorControllerInput {
  double time;                         /*    0: simulated time [s] */
  double dt;                           /*    8: period of the controller [s] */
  int32_t dof;                         /*   16: number of joints */
  int32_t reserved;                    /*   20: 0 */
  double q[PREDICTOR_MAX_JOINTS];      /*   24: joint positions [rad], of a prismatic joint [m] */
  double v[PREDICTOR_MAX_JOINTS];      /*  152: joint velocities [rad/s], likewise [m/s] */
  double g[PREDICTOR_MAX_JOINTS];      /*  280: torques that carry the cobot's own weight [N·m] */
  double h[PREDICTOR_MAX_JOINTS];      /*  408: Coriolis and centrifugal torques, plus g [N·m] */
  double torque[PREDICTOR_MAX_JOINTS]; /*  536: joint torques that act at present [N·m] */
  double X_WE[7];                      /*  664: pose of E in W: position [m], then quaternion */
  double V_WE[6];                      /*  720: twist of E in W, about E's origin, axes of W */
  double F_E_W[6]; /*  768: reading of the wrist sensor: wrench of the load on E, about E's origin,
                           axes of W. Zero unless the controller uses the sensor. */
  double J[6 * PREDICTOR_MAX_JOINTS];                    /*  816: Jacobian, V_WE = J v */
  double M[PREDICTOR_MAX_JOINTS * PREDICTOR_MAX_JOINTS]; /* 1584: mass matrix [kg·m²], symmetric.
                                                              Excludes the load. */
  double X_WO[7]; /* 3632: pose of the object in W, as X_WE. Exact: a camera that measures it would
                           add noise and delay, which the controller may model. */
} PredictorControllerInput; /* 3688 bytes */

/* The members of the input that take time to compute. The function `reads` of a library states
 * which of them the controller reads. */
enum {
  PREDICTOR_READS_H = 1, /* h */
  PREDICTOR_READS_J = 2, /* J */
  PREDICTOR_READS_M = 4, /* M */
  PREDICTOR_READS_ALL = 7
};

/* A word of cobot.controller.parameters, "key=value". */
typedef struct PredictorParameter {
  const char* key;
  const char* value;
} PredictorParameter;

/* What `create` makes a controller from. The pointers are valid during `create` only. */
typedef struct PredictorControllerConfig {
  int32_t dof; /* number of joints, at most 16 */
  int32_t parameter_count;
  const char* const* joint_names;       /* dof names, in the order of q */
  const PredictorParameter* parameters; /* as in the scenario, in its order */
  double posture[PREDICTOR_MAX_JOINTS]; /* cobot.posture, where the cobot starts [rad] */
  double X_WE_start[7];                 /* pose of E there, in W */
  double gravity;                       /* along -z of W [m/s²] */
  double dt;                            /* period of the controller [s] */
} PredictorControllerConfig;

/* ---- a controller as a shared library -------------------------------------------------------- */

/* The functions of a controller. PREDICTOR calls them from one thread at a time. `self` is what
 * `create` returned. Functions marked "may be NULL" are optional.
 *
 * All functions except `create` and `destroy` run in the control loop, once per millisecond: they
 * must not allocate, lock, wait, read or write files, print, or throw C++ exceptions, and must
 * return within a few microseconds. If one does not return, PREDICTOR ends with a message. If one
 * allocates or frees heap memory after the run has been prepared, PREDICTOR stops the run. */
typedef struct PredictorController {
  uint32_t version;    /* PREDICTOR_CONTROLLER_VERSION */
  uint32_t input_size; /* sizeof(PredictorControllerInput) */

  /* Makes a controller. Returns NULL if it cannot, with the reason as a full sentence in `error`
   * (a buffer of `error_size` bytes; end it with 0): a wrong number of joints, an unknown
   * parameter. */
  void* (*create)(const PredictorControllerConfig* config, char* error, size_t error_size);
  void (*destroy)(void* self);

  /* Writes dof joint torques [N·m]. PREDICTOR then limits them to cobot.effort_limit. They may
   * depend only on the input and the memory; the call must leave no trace in `self`, because the
   * search for the start, a reset and the linearisation also make it, each with other states. A
   * torque that is not finite stops the run. */
  void (*compute)(void* self, const PredictorControllerInput* input, double* torque);

  /* The memory: everything that `advance` changes, as numbers that vary smoothly (an integrator, a
   * filter, a reference that moves). PREDICTOR saves and restores them. Returns their address and
   * writes their number, at most PREDICTOR_MAX_MEMORY; neither ever changes. May be NULL: none. */
  double* (*memory)(void* self, int32_t* size);
  /* Sets the memory for a cobot that has rested at `input` for a long time. May be NULL. */
  void (*start)(void* self, const PredictorControllerInput* input);
  /* Advances the memory by one period, input->dt, after the step of the simulation. May be NULL. */
  void (*advance)(void* self, const PredictorControllerInput* input);

  /* 1 if the input must contain the wrist sensor's reading. May be NULL: 0. */
  int32_t (*uses_wrist_sensor)(void* self);
  /* Which of h, J and M the controller reads, as a sum of PREDICTOR_READS_*, the same in each call.
   * PREDICTOR does not compute the others, and they are 0. May be NULL: PREDICTOR_READS_ALL. */
  uint32_t (*reads)(void* self);
  /* Energy in the controller's springs [J], part of the recorded energy. May be NULL: 0. */
  double (*stored_energy)(void* self, const PredictorControllerInput* input);
} PredictorController;

#if defined(__GNUC__)
#define PREDICTOR_EXPORT __attribute__((visibility("default")))
#else
#define PREDICTOR_EXPORT
#endif

/* The only symbol that the library must export. The table must live as long as the library. */
PREDICTOR_EXPORT const PredictorController* predictor_controller(void);
typedef const PredictorController* (*PredictorControllerEntry)(void);

/* ---- a controller as a process ----------------------------------------------------------------
 *
 * PREDICTOR starts the program with this memory as file descriptor 3, and asks by counting
 * `request` up. The program computes, writes its answer and sets `answer` to the same number. It
 * reads `request` before all else and writes `answer` after all else (acquire and release order).
 * The numbers wrap around. It must keep no state besides `memory`, which each request contains,
 * and must end when `request_kind` is PREDICTOR_END or when its parent process changes. */

enum {
  PREDICTOR_CREATE = 1,  /* check the configuration; answer `memory_size` and `uses_wrist_sensor` */
  PREDICTOR_START = 2,   /* answer the memory at rest */
  PREDICTOR_COMPUTE = 3, /* answer torque and stored energy */
  PREDICTOR_ADVANCE = 4, /* answer the memory one period later; asked only if there is any */
  PREDICTOR_END = 5      /* end; needs no answer */
};

enum { PREDICTOR_TEXT_SIZE = 4096 };

typedef struct PredictorControllerMemory {
  uint32_t version;                     /*     0: PREDICTOR_CONTROLLER_VERSION */
  uint32_t size;                        /*     4: of this struct [bytes] */
  volatile uint32_t request;            /*     8: counted up by PREDICTOR */
  volatile uint32_t answer;             /*    12: set to `request` by the controller */
  int32_t request_kind;                 /*    16 */
  int32_t refused;                      /*    20: 1: the answer is a reason why not, in `text` */
  int32_t memory_size;                  /*    24: answered once, to PREDICTOR_CREATE */
  int32_t uses_wrist_sensor;            /*    28: likewise; 0 or 1 */
  double torque[PREDICTOR_MAX_JOINTS];  /*    32: the answer [N·m] */
  double stored_energy;                 /*   160: of the springs, at the input of the torque [J] */
  double memory[PREDICTOR_MAX_MEMORY];  /*   168: with the request and with the answer */
  PredictorControllerInput input;       /*  1192: START, COMPUTE and ADVANCE */
  double posture[PREDICTOR_MAX_JOINTS]; /*  4880: CREATE: cobot.posture [rad] */
  double X_WE_start[7];                 /*  5008: CREATE: pose of E at the start */
  double gravity;                       /*  5064: CREATE [m/s²] */
  char text[PREDICTOR_TEXT_SIZE];       /*  5072: CREATE: cobot.controller.parameters, a line, then
                                                   the names of the joints, a line each. UTF-8, ends
                                                   with 0. */
} PredictorControllerMemory;            /* 9168 bytes */

#ifdef __cplusplus
}
#endif

#endif
