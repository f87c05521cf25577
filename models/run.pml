// The run: one tick, as src/emulator (emulator, requests, transitions, run_loop) does it. Between two ticks anybody
// may do anything; a tick is one step.

// What a tick finds in the world, chosen before it.
hidden byte fault;      // that the monitor finds: NONE, HOLD or POWER_OFF
hidden byte rejected;   // what the arms answer to a command
hidden byte blind;      // a headset shows no new frames
hidden byte loaded;     // somebody presses on a handle
hidden byte beyond;     // a joint is beyond its limit, or links are too near
hidden byte progress;   // aligned, at rest, nothing left to undo: whatever the state waits for
hidden byte slow;       // the handles are led so slowly that they can rest within a tick
hidden byte tared;      // the self-test passes, if it ends

// Within a tick only.
hidden byte from, to, was, before, stop;
hidden short bits, far;  // events asked for; those of them that came from afar
hidden byte room;
hidden byte done_early, stopped_by, key_held;
hidden mtype input;

// ---- the state machine ------------------------------------------------------------------------

// Faults of the table itself, for a model that must be found wrong.
inline spoil(event) {
#if DEFECT == 1
  if :: from == STOPPING_OFF && event == STOP_REQUESTED -> to = STOPPING :: else fi;
#elif DEFECT == 2
  if :: from == RECOVERY_HELD && event == RECOVERED -> to = IDLE :: else fi;
#elif DEFECT == 3
  if :: from == HELD && event == START_REQUESTED -> to = RUN :: else fi;
#elif DEFECT == 4
  if :: from == UNPOWERED && event == RESET -> to = ARMED :: else fi;
#endif
  skip
}

inline owe() {
  if
  :: STOPS(to) || STOPPED(to) -> owed = OWES_RESET | OWES_IDLE | OWES_ARMED
  :: to == IDLE && !(owed & OWES_RESET) -> owed = owed & ~OWES_IDLE
  :: to == ARMED && !(owed & OWES_IDLE) -> owed = owed & ~OWES_ARMED
  :: else
  fi
}

// StateMachine::Handle. `from` and `to` say afterwards whether anything changed.
inline handle(what) {
  from = condition;
  to = NEXT(from, what);
  spoil(what);
  printf("TRACE %d %d %d\n", from, what, to);
  MUST(P_SEVERITY, what == RESET || SEVERITY(to) >= SEVERITY(from));
  if :: what == RESET && to != from -> owed = owed & ~OWES_RESET :: else fi;
  owe();
  condition = to
}

// ---- stops ------------------------------------------------------------------------------------

// StopController::Begin: a profile from what was last sent to rest; one under way goes on.
inline begin_profile() {
  if
  :: stop_begun && DEFECT != 5
  :: else ->
     stop_begun = true;
     if :: sent == REST -> braking_left = 0 :: else -> braking_left = BRAKING fi
  fi
}

inline begin_stop(event) {
  handle(event);
  if
  :: STOPS(condition) ->
     begin_profile();
     MUST(P_PLAN, sent == REST || braking_left > 0)
  :: else
  fi
}

// A stop under way is not begun again; its level may rise.
inline judge(level) {
  if
  :: level == NONE
#if DEFECT == 6
  :: level != NONE && latched && RECOVERS(condition)
#endif
#if DEFECT == 7
  :: level != NONE && latched && !FOLLOWS_TASK(condition)
#else
  :: level != NONE && latched && !FOLLOWS_TASK(condition) ->
     if
     :: level == POWER_OFF && SEVERITY(condition) == HOLD -> handle(STOP_AND_POWER_OFF)
     :: else
     fi
#endif
  :: else ->
     if
     :: condition == INIT || condition == UNPOWERED
#if DEFECT == 30
     :: condition == HELD
#else
     :: condition == HELD && level != POWER_OFF
#endif
     :: else ->
        latched = true;
        stop = (level == POWER_OFF -> STOP_AND_POWER_OFF : STOP_REQUESTED);
        begin_stop(stop)
     fi
  fi
}

// A fault that somebody finds: Judge, and what it must lead to. At rest after a run that ended
// without a cause (HELD, nothing latched), what could be held waits for the next reset to be asked
// for.
inline find(level) {
  was = condition;
  before = latched;
  judge(level);
  MUST(P_FAULT, level == NONE || was == INIT || was == UNPOWERED ||
                (was == HELD && !before && level == HOLD) ||
                ((STOPS(condition) || STOPPED(condition)) && SEVERITY(condition) >= level))
}

inline stop_on_request(event) {
  if :: !STOPPED(condition) -> latched = true :: else fi;
  begin_stop(event)
}

// ---- requests ---------------------------------------------------------------------------------

#if DEFECT == 8
#define REFUSED_RESET (STOPPED(condition) && well < ABSENT)
#elif DEFECT == 9
#define REFUSED_RESET (STOPPED(condition) && loaded)
#elif DEFECT == 31
#define REFUSED_RESET (condition == HELD && (loaded || well < ABSENT))
#else
#define REFUSED_RESET (STOPPED(condition) && (loaded || well < ABSENT))
#endif
#if DEFECT == 10
#define ENABLED true
#elif DEFECT == 11
#define ENABLED (!real_arms || silent <= SILENCE || event == START_REQUESTED)
#else
#define ENABLED key_held
#endif

// Emulator::Impl::Obey, if the event was asked for and nothing stands in its way (WhyNot).
inline obey(event) {
  if
  :: !(bits & BIT(event)) || (event == RESET && REFUSED_RESET) || (event != RESET && !ENABLED) ||
     (event == ALIGN_REQUESTED && condition == IDLE && beyond)
  :: else ->
     was = condition;
     handle(event);
     MUST(P_REMOTE, !real_arms || was == condition || (asked & BIT(event)) || STOPS(condition));
     MUST(P_GRANTED, !real_arms || event == RESET || was == condition || STOPS(condition) ||
                     unheld <= SILENCE);
     MUST(P_RESET, event != RESET || !STOPPED(was) || (!loaded && well >= ABSENT));
     if
     :: was == condition
     :: was != condition && STOPS(condition) ->
        latched = true;
        begin_stop(STOP_AND_POWER_OFF)
     :: was != condition && event == RESET ->
        latched = false;
        well = 0;
        stop_begun = false;
        MUST(P_MOVES, sent == REST)  // a reset never moves
     :: was != condition && RECOVERS(condition) ->
#if DEFECT != 12
        stop_begun = false
#else
        skip
#endif
     :: else
     fi
  fi
}

// Stops first, the more severe before the other; whatever else was asked for in that tick is not
// done.
inline take_requests() {
  done_early = true;
  if
  :: bits & BIT(STOP_AND_POWER_OFF) -> stop_on_request(STOP_AND_POWER_OFF)
  :: else ->
     if :: blind -> find(HOLD) :: else fi;
     if
     :: bits & BIT(STOP_REQUESTED) -> stop_on_request(STOP_REQUESTED)
     :: !(bits & BIT(STOP_REQUESTED)) && (bits & BIT(END)) && FOLLOWS_TASK(condition) ->
        begin_stop(STOP_REQUESTED)
     :: else -> done_early = false
     fi
  fi;
  if
  :: done_early && DEFECT != 13
  :: else ->
     obey(RESET);
     obey(RECOVER_REQUESTED);
     obey(ALIGN_REQUESTED);
     obey(START_REQUESTED)
  fi
}

// What was asked for is gone with the tick, done or not.
inline forget_requests() {
#if DEFECT == 14
  asked = (done_early -> asked & (BIT(RESET) | BIT(ALIGN_REQUESTED) | BIT(START_REQUESTED)) : 0);
#else
  asked = 0;
#endif
  MUST(P_LEFTOVER, asked == 0);
  presses = 0
}

// Emulator::Impl::Take: with real arms align, start and reset are a person's at the rig; a
// parameter's value is held to what the scenario allows.
inline take(what) {
  if
#if DEFECT == 15
  :: what == ASK_RESET -> far = far | BIT(RESET)
#else
  :: what == ASK_RESET && !real_arms -> far = far | BIT(RESET)
#endif
#if DEFECT == 16
  :: what == ASK_START -> far = far | BIT(START_REQUESTED)
#else
  :: what == ASK_START && !real_arms -> far = far | BIT(START_REQUESTED)
#endif
  :: what == ASK_ALIGN && !real_arms -> far = far | BIT(ALIGN_REQUESTED)
  :: what == ASK_STOP -> far = far | BIT(STOP_REQUESTED)
  :: what == ASK_PARAMETER ->
#if DEFECT == 17
     MUST(P_LIMITS, !beyond)  // `beyond` stands for the value here
#else
     if :: beyond :: else -> MUST(P_LIMITS, !beyond) fi
#endif
#if DEFECT == 18
  :: what == ASK_ENABLE -> silent = 0
#endif
  :: else
  fi
}

// RunRealTime: TakeEnabling, then TakeInputs. A stop never waits.
inline take_inputs() {
  if
  :: key == HELD_DOWN -> silent = 0; unheld = 0
  :: key == LET_GO -> silent = SILENCE + 1; unheld = (unheld > SILENCE -> unheld : SILENCE + 1)
  :: else -> unheld = (unheld < SILENCE + 3 -> unheld + 1 : unheld)
  fi;
  key = 0;
  far = 0;
  room = ROOM;
  stopped_by = mail_stop || (asked & (BIT(STOP_REQUESTED) | BIT(STOP_AND_POWER_OFF)));
#if DEFECT != 19
  if :: mail_stop -> far = BIT(STOP_REQUESTED); room-- :: else fi;
  mail_stop = false;
#endif
  do
  :: room > 0 && len(mail) > 0 ->
     mail?input;
#if DEFECT == 19
     if :: input == ASK_STOP -> mail_stop = false :: else fi;
#endif
     take(input);
     room--
  :: else -> break
  od;
  bits = asked | far;
  key_held = !real_arms || silent <= SILENCE
}

// ---- the rest of the tick -----------------------------------------------------------------------

inline monitor() {
  // Counted where it is asked for only: in a stop, which takes a tick at least.
  well = (fault != NONE || SEVERITY(condition) == NONE -> 0 : (well < ABSENT -> well + 1 : well));
  find(fault);
  if
#if DEFECT == 20
  :: real_arms && !key_held && condition == ALIGN -> find(HOLD)
#elif DEFECT == 21
  :: real_arms && !key_held && condition == RUN -> find(HOLD)
#else
  :: real_arms && !key_held && (condition == RUN || condition == ALIGN) -> find(HOLD)
#endif
  :: else
  fi;
  MUST(P_STOP, !stopped_by || STOPS(condition) || STOPPED(condition));
  MUST(P_ENABLING, !real_arms || unheld <= SILENCE || (condition != RUN && condition != ALIGN))
}

// The guard lets no velocity go to zero at once: MOVES, SLOW, REST.
#define SLOWER (sent > SLOW -> SLOW : REST)

inline command() {
  if
  :: condition == RUN -> sent = MOVES
  :: condition == ALIGN -> sent = (slow -> SLOW : MOVES)
  :: STOPS(condition) ->
#if DEFECT != 23
     if :: braking_left > 0 -> braking_left-- :: else fi;
#endif
     if :: progress -> braking_left = 0 :: else fi;
     sent = (sent == REST || braking_left == 0 -> REST : BRAKES)
#if DEFECT == 24
  :: RECOVERS(condition) -> sent = (!progress -> MOVES : SLOWER)
#else
  :: RECOVERS(condition) -> sent = (key_held && !progress -> MOVES : SLOWER)
#endif
  :: else -> sent = SLOWER
  fi;
  MUST(P_MOVES, sent == REST || MAY_MOVE(condition));
  MUST(P_RECOVERY, !real_arms || !RECOVERS(condition) || unheld <= SILENCE + 1 || sent == REST)
}

// What follows by itself: time, and the steps between states that need no person.
inline advance() {
  silent = (silent <= SILENCE -> silent + 1 : silent);
  if
  :: condition == INIT && progress -> handle(STARTED)
  :: condition == SELFTEST && progress && tared -> handle(SELF_TEST_PASSED)
  :: condition == SELFTEST && progress && !tared -> find(HOLD)
#if DEFECT == 22
  :: condition == ALIGN && progress -> handle(ALIGNED)
#else
  :: condition == ALIGN && progress && sent <= SLOW -> handle(ALIGNED)
#endif
  :: STOPS(condition) && braking_left == 0 -> handle(STANDSTILL)
  :: RECOVERS(condition) && sent == REST && !(real_arms && key_held) &&
     (condition == RECOVERY_HELD || !beyond) -> handle(RECOVERED)
  :: else
  fi
}

// StartByItself: with the simulated rig nobody is there to press buttons, until RUN was reached.
inline start_by_itself() {
  if
  :: !real_arms && !began && condition == IDLE -> asked = BIT(ALIGN_REQUESTED)
  :: !real_arms && !began && condition == ARMED -> asked = BIT(START_REQUESTED)
  :: !real_arms && condition == RUN -> began = true
  :: else
  fi
}

#ifdef TRACES  // random runs get nowhere if every other tick finds a fault
#define SELDOM(x, y) :: x = y :: x = y :: x = y :: x = y :: x = y :: x = y :: x = y :: x = y
#else
#define SELDOM(x, y)
#endif

#define ASKED_FOR(event) ((asked & BIT(event)) || len(mail) > 0)
#define WAITS(c) (c == INIT || c == SELFTEST || c == ALIGN || RECOVERS(c) || STOPS(c))

// Choices that cannot matter are not made: they would only multiply the search. At most two things
// go wrong in a tick.
inline look_at_the_world() {
  if
  :: fault = NONE
  SELDOM(fault, NONE)
  :: condition != INIT -> fault = HOLD
  :: condition != INIT && condition != UNPOWERED -> fault = POWER_OFF
  fi;
  if
  :: rejected = NONE
  SELDOM(rejected, NONE)
  :: fault == NONE && condition != INIT && condition != UNPOWERED -> rejected = HOLD
  :: fault != POWER_OFF && condition != INIT && condition != UNPOWERED -> rejected = POWER_OFF
  fi;
  if
  :: blind = false
  SELDOM(blind, false)
  :: real_arms && MAY_MOVE(condition) && (fault == NONE || rejected == NONE) -> blind = true
  fi;
  if
  :: loaded = false
  :: STOPPED(condition) && ASKED_FOR(RESET) -> loaded = true
  fi;
  if
  :: beyond = false
  :: ASKED_FOR(ALIGN_REQUESTED) || RECOVERS(condition) -> beyond = true
  fi;
  if
  :: progress = false
  :: WAITS(condition) || asked != 0 || len(mail) > 0 -> progress = true
  fi;
  if
  :: slow = progress
  :: condition == ALIGN -> slow = !progress
  fi;
  if
  :: tared = true
  :: condition == SELFTEST && progress -> tared = false
  fi
}

proctype Tick() {
  do
  :: atomic {
       look_at_the_world();
       d_step {
         take_inputs();
         take_requests();
         forget_requests();
         monitor();
         command();
         find(rejected);
         advance();
         start_by_itself()
       }
     }
  od
}
