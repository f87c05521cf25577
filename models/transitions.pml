// What the run does with every event in every condition: the state machine of the model, one row a
// condition, one column an event. tests/safety/model_test.cpp compares every number, name and entry
// of it with src/safety/state_machine.h, so that what is checked is what runs.

#define INIT 0
#define SELFTEST 1
#define IDLE 2
#define ALIGN 3
#define ARMED 4
#define RUN 5
#define RECOVERY 6
#define RECOVERY_HELD 7
#define STOPPING 8
#define STOPPING_OFF 9
#define HELD 10
#define UNPOWERED 11

#define STARTED 0
#define SELF_TEST_PASSED 1
#define ALIGN_REQUESTED 2
#define ALIGNED 3
#define START_REQUESTED 4
#define STOP_REQUESTED 5
#define STOP_AND_POWER_OFF 6
#define STANDSTILL 7
#define RESET 8
#define RECOVER_REQUESTED 9
#define RECOVERED 10

// Names that fit a column. AFTER: RECOVERY out of a stop, OFF: STOPPING that ends without power.
#define AFTER RECOVERY_HELD
#define OFF STOPPING_OFF
#define UNPOW UNPOWERED
#define STOPP STOPPING
#define RECOV RECOVERY
#define SELFT SELFTEST

#define EVENTS 11

// The same in every state, so that it is not stored with them.
hidden byte table[132];
#define NEXT(from, event) table[(from) * EVENTS + (event)]

#define ROW(at, e0, e1, e2, e3, e4, e5, e6, e7, e8, e9, e10) \
  NEXT(at, STARTED) = e0;                                    \
  NEXT(at, SELF_TEST_PASSED) = e1;                           \
  NEXT(at, ALIGN_REQUESTED) = e2;                            \
  NEXT(at, ALIGNED) = e3;                                    \
  NEXT(at, START_REQUESTED) = e4;                            \
  NEXT(at, STOP_REQUESTED) = e5;                             \
  NEXT(at, STOP_AND_POWER_OFF) = e6;                         \
  NEXT(at, STANDSTILL) = e7;                                 \
  NEXT(at, RESET) = e8;                                      \
  NEXT(at, RECOVER_REQUESTED) = e9;                          \
  NEXT(at, RECOVERED) = e10;

inline fill_table() {
  //                 started passed align  alignd start  stop   pow.off still  reset  recov. recovered
  ROW(INIT,          SELFT,  INIT,  INIT,  INIT,  INIT,  OFF,   OFF,    INIT,  INIT,  INIT,  INIT)
  ROW(SELFTEST,      SELFT,  IDLE,  SELFT, SELFT, SELFT, OFF,   OFF,    SELFT, SELFT, SELFT, SELFT)
  ROW(IDLE,          IDLE,   IDLE,  ALIGN, IDLE,  IDLE,  STOPP, OFF,    IDLE,  IDLE,  RECOV, IDLE)
  ROW(ALIGN,         OFF,    OFF,   ALIGN, ARMED, OFF,   STOPP, OFF,    OFF,   OFF,   OFF,   OFF)
  ROW(ARMED,         ARMED,  ARMED, ARMED, ARMED, RUN,   STOPP, OFF,    ARMED, ARMED, ARMED, ARMED)
  ROW(RUN,           OFF,    OFF,   OFF,   OFF,   RUN,   STOPP, OFF,    OFF,   OFF,   OFF,   OFF)
  ROW(RECOVERY,      OFF,    OFF,   OFF,   OFF,   OFF,   STOPP, OFF,    OFF,   OFF,   RECOV, IDLE)
  ROW(RECOVERY_HELD, OFF,    OFF,   OFF,   OFF,   OFF,   STOPP, OFF,    OFF,   OFF,   AFTER, HELD)
  ROW(STOPPING,      STOPP,  STOPP, STOPP, STOPP, STOPP, STOPP, OFF,    HELD,  STOPP, STOPP, STOPP)
  ROW(STOPPING_OFF,  OFF,    OFF,   OFF,   OFF,   OFF,   OFF,   OFF,    UNPOW, OFF,   OFF,   OFF)
  ROW(HELD,          HELD,   HELD,  HELD,  HELD,  HELD,  HELD,  UNPOW,  HELD,  IDLE,  AFTER, HELD)
  ROW(UNPOWERED,     UNPOW,  UNPOW, UNPOW, UNPOW, UNPOW, UNPOW, UNPOW,  UNPOW, SELFT, UNPOW, UNPOW)
}
