// Model of the safety state machine and of whoever may ask it for something, for Spin:
//   models/check.sh             checks every property below, and that every seeded defect is found
//   docs/developer/state-model.md        says in words what is modelled, and what is not
//
//   transitions.pml             what follows what
//   run.pml                     the tick: src/emulator/emulator.cpp, requests.cpp, transitions.cpp and run_loop.cpp
//   viewer.pml                  pages, network, leases: src/viewer/hub.cpp and leases.cpp
//
// Times are counted in ticks, and shortened: what matters is what can come before and after their
// end, in any number of ticks.

#ifndef SILENCE
#define SILENCE 1  // ticks without a sign for which the enabling key counts as held (100)
#endif
#ifndef BRAKING
#define BRAKING 2  // ticks that a stop takes at most (90)
#endif
#ifndef ABSENT
#define ABSENT 1   // ticks for which a cause must be gone before a reset (500)
#endif
#ifndef LIFE
#define LIFE 2     // steps of the viewer's clock by which a lease outlives its last heartbeat (3 s)
#endif
#ifndef WIRE
#define WIRE 1     // messages under way between pages and viewer
#endif
#ifndef MAIL
#define MAIL 1     // inputs that wait between viewer and run
#endif
#ifndef ROOM
#define ROOM 1     // inputs that a tick takes
#endif
#ifndef PRESSES
#define PRESSES 1  // keys pressed at the console between two ticks
#endif
#ifndef DEFECT
#define DEFECT 0   // defects.txt: one that is built in on purpose
#endif

#include "transitions.pml"

// Severity of a fault, and of a stop in progress or done.
#define NONE 0
#define HOLD 1
#define POWER_OFF 2

// Of what is sent to the arms: nothing; little enough to rest after the next tick; braking by the
// stop's profile; anything.
#define REST 0
#define SLOW 1
#define BRAKES 2
#define MOVES 3

#define BIT(event) (1 << (event))
#define END 11  // beside the events: Ctrl-C, or the run's duration is over

mtype = {TAKE, RELEASE, HEARTBEAT, ASK_STOP, ASK_ALIGN, ASK_START, ASK_RESET, ASK_PARAMETER,
         ASK_ENABLE};

// ---- what stays as it is through a run
bool real_arms;
bool viewer_lies;  // the viewer's process has been taken over: it may send anything (-DLIES)

// ---- the run, between two ticks
byte condition = INIT;
byte sent = REST;             // to the arms, in the last tick
byte braking_left;            // ticks by which a stop's profile is at rest at the latest
bool stop_begun;              // StopController::active
bool latched;                 // a cause of the stop is known
byte silent = SILENCE + 1;    // ticks since the enabling key was known to be held
byte well;                    // ticks since anything was wrong
bool began;                   // RUN was reached: from then on the simulated rig waits for people

// ---- on its way to the run
#define HELD_DOWN 1
#define LET_GO 2
byte key;                     // a sign of the enabling key that came since the last tick
short asked;                  // events asked for at the console (simulated rig: by the program)
byte presses;
bool mail_stop;               // the mailbox: stops are counted apart from the queue of inputs
chan mail = [MAIL] of {mtype};

// ---- pages, and who of them may command
chan wire = [WIRE] of {bit, mtype};  // from a page to the viewer
byte holder;                  // of the lease: 0 nobody, 1 the first page, 2 the second
byte life;                    // until it runs out
bool holder_left;             // its connection is closed; whoever shows its token takes it up

// ---- what only the properties look at
int broken;                   // properties that a step has found violated, a bit each
byte unheld = SILENCE + 3;    // ticks since the person at the console last gave a sign
byte owed;                    // what must come before RUN after a stop
bool granted[2];              // a page was told that it holds the lease, and not yet that it does not
byte since_beat;              // steps of the clock since the holder itself gave a sign of life

#define MUST(property, p) if :: (p) :: else -> broken = broken | BIT(property) fi

// ---- properties, by the invariants of docs/developer/state-model.md
#define P_MOVES 0
#define P_SEVERITY 1
#define P_RESET 2
#define P_FAULT 3
#define P_STOP 4
#define P_PLAN 5
#define P_REMOTE 6
#define P_LIMITS 7
#define P_ENABLING 8
#define P_GRANTED 9
#define P_RECOVERY 10
#define P_LEFTOVER 11
#define P_HOLDER 12
#define P_PASSED 13
#define NEVER(property) [] ((broken & BIT(property)) == 0)

#define SEVERITY(c) \
  ((c == STOPPING_OFF || c == UNPOWERED) -> POWER_OFF : \
   ((c == STOPPING || c == HELD || c == RECOVERY_HELD) -> HOLD : NONE))
#define STOPS(c) (c == STOPPING || c == STOPPING_OFF)
#define STOPPED(c) (c == HELD || c == UNPOWERED)
#define RECOVERS(c) (c == RECOVERY || c == RECOVERY_HELD)
#define FOLLOWS_TASK(c) (c == ALIGN || c == RUN || RECOVERS(c))
#define MAY_MOVE(c) (FOLLOWS_TASK(c) || STOPS(c))
#define OWES_RESET 1
#define OWES_IDLE 2
#define OWES_ARMED 4

#include "run.pml"
#include "viewer.pml"

init {
  atomic {
    fill_table();
    if :: real_arms = false :: real_arms = true fi;
#ifndef LIES
    if :: viewer_lies = false :: viewer_lies = true fi;
#else
    viewer_lies = true;
#endif
    if
    :: viewer_lies -> run Liar()
    :: else -> run Page(0); run Page(1); run Session(0); run Session(1); run Clock()
    fi;
    run Console();
    run Tick()
  }
}

// 1. Velocities other than zero are sent in ALIGN, RUN, RECOVERY and STOPPING only.
ltl moves { NEVER(P_MOVES) }
// 2. Severity never falls without a reset; a reset needs free hands and a cause that is gone.
ltl severity { NEVER(P_SEVERITY) }
ltl reset_granted { NEVER(P_RESET) }
// 3. Every fault, and every stop asked for, leads to STOPPING in its tick; STOPPING brakes by a
// profile made for it, and reaches standstill.
ltl fault_stops { NEVER(P_FAULT) }
ltl stop_obeyed { NEVER(P_STOP) }
ltl leftover { NEVER(P_LEFTOVER) }
ltl plan { NEVER(P_PLAN) }
ltl standstill { [] (STOPS(condition) -> <> !STOPS(condition)) }
// 4. No path from a stop to RUN avoids reset, IDLE and ARMED.
ltl path { [] (condition == RUN -> owed == 0) }
// 5. With real arms no message from afar raises privilege or energy; with none, limits.
ltl remote { NEVER(P_REMOTE) }
ltl limits { NEVER(P_LIMITS) }
// 6. With real arms: enabling released or silent implies neither RUN nor ALIGN, nor motion in
// RECOVERY; and nothing is begun without it. At most one page holds the lease, it alone commands,
// it loses it in silence, and another gets it only by release, by running out, by the console, or
// by the token of one who left.
ltl enabling { NEVER(P_ENABLING) }
ltl begun { NEVER(P_GRANTED) }
ltl recovery_held { NEVER(P_RECOVERY) }
ltl one_holder { [] !(granted[0] && granted[1]) }
ltl holder_commands { NEVER(P_HOLDER) }
ltl runs_out { [] (holder != 0 -> since_beat < LIFE) }
ltl passed_on { NEVER(P_PASSED) }

// All of them but standstill, in one search.
ltl all {
  [] (broken == 0 && (condition == RUN -> owed == 0) && !(granted[0] && granted[1]) &&
      (holder != 0 -> since_beat < LIFE))
}

// ---- what must be possible, or the properties would say nothing: each of these must be violated
ltl can_run { [] !(real_arms && condition == RUN && sent == MOVES) }
ltl can_run_simulated { [] !(!real_arms && condition == RUN && sent == MOVES) }
ltl can_free_a_hand { [] !(condition == RECOVERY_HELD && sent == MOVES) }
ltl can_run_again { [] (real_arms && condition == HELD -> [] !(condition == RUN)) }
ltl can_run_after_power_off {
  [] (real_arms && condition == UNPOWERED -> [] !(condition == RUN))
}
ltl can_hand_over { [] (holder == 1 -> [] !(holder == 2)) }
