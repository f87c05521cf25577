// Whoever may ask the run for something: the person at the console, two pages over a network that
// loses, repeats and reorders, and the viewer's process between them, which keeps the lease.

// ---- the lease -----------------------------------------------------------------------------------

#define HOLDS(page) (holder == page + 1)
#define CLOSED (HOLDS(me) && holder_left)  // of this connection nothing comes any more

inline free() {
  holder = 0;
  life = 0;
  holder_left = false;
  since_beat = 0;
  granted[0] = false;
  granted[1] = false
}

inline grant(page) {
  MUST(P_PASSED, holder == 0 || HOLDS(page) || holder_left);
  holder = page + 1;
  life = LIFE;
  holder_left = false;
  since_beat = 0;
  granted[page] = true
}

inline on_take() {
  if
#if DEFECT == 25
  :: true -> grant(me)
#else
  :: holder == 0 || HOLDS(me) -> grant(me)
  :: else
#endif
  fi
}

inline on_release() {
  if
#if DEFECT == 26
  :: holder != 0 -> MUST(P_PASSED, HOLDS(me)); free()
#else
  :: HOLDS(me) -> free()
#endif
  :: else
  fi
}

inline on_heartbeat() {
  if
#if DEFECT == 27
  :: holder != 0 -> life = LIFE; if :: HOLDS(me) -> since_beat = 0 :: else fi
#else
  :: HOLDS(me) -> life = LIFE; since_beat = 0
#endif
  :: else
  fi
}

// With real arms the viewer refuses as well; what it would let through the run refuses again.
inline on_command(what) {
  if
#if DEFECT == 28
  :: !real_arms && len(mail) < MAIL ->
#else
  :: HOLDS(me) && !real_arms && len(mail) < MAIL ->
#endif
     MUST(P_HOLDER, granted[me]);
     mail!what
  :: else
  fi
}

inline on_stop() {
#if DEFECT == 19
  if :: len(mail) < MAIL -> mail!ASK_STOP :: else fi;
#endif
  mail_stop = true
}

inline on(what) {
  if
  :: CLOSED
  :: else ->
     if
     :: what == TAKE -> on_take()
     :: what == RELEASE -> on_release()
     :: what == HEARTBEAT -> on_heartbeat()
     :: what == ASK_STOP -> on_stop()
     :: else -> on_command(what)
     fi
  fi
}

// ---- the person at the console, and the program itself --------------------------------------------

#define PRESS(event) presses < PRESSES && !(asked & BIT(event)) -> \
                     asked = asked | BIT(event); presses++

proctype Console() {
  do
  :: atomic { real_arms && key != HELD_DOWN -> key = HELD_DOWN }
  :: atomic { real_arms && key != LET_GO -> key = LET_GO }
  :: atomic { real_arms && PRESS(ALIGN_REQUESTED) }
  :: atomic { real_arms && PRESS(START_REQUESTED) }
  :: atomic { real_arms && PRESS(RESET) }
  :: atomic { real_arms && PRESS(RECOVER_REQUESTED) }
  :: atomic { PRESS(STOP_REQUESTED) }
  :: atomic { PRESS(STOP_AND_POWER_OFF) }
  :: atomic { PRESS(END) }
  :: d_step { holder != 0 -> free() }
  od
}

// ---- a page, the network, and the viewer's side of its connection -----------------------------------

// Sorted, since their order on the wire means nothing.
proctype Page(bit me) {
  do
  :: wire!!me, TAKE
  :: wire!!me, RELEASE
  :: wire!!me, HEARTBEAT
  :: wire!!me, ASK_STOP
  :: wire!!me, ASK_ALIGN
  :: wire!!me, ASK_START
  :: wire!!me, ASK_RESET
  od
}

// Any message under way may arrive next, arrive while a copy of it stays under way, or be lost.
#define ARRIVES(what)                                          \
  :: d_step { wire??eval(me), what -> on(what) }               \
  :: d_step { wire??[eval(me), what] -> on(what) }             \
  :: wire??eval(me), what

proctype Session(bit me) {
  do
  ARRIVES(TAKE)
  ARRIVES(RELEASE)
  ARRIVES(HEARTBEAT)
  ARRIVES(ASK_STOP)
  ARRIVES(ASK_ALIGN)
  ARRIVES(ASK_START)
  ARRIVES(ASK_RESET)
  // The connection closes; whoever shows the same token gets back what it held.
  :: d_step { HOLDS(me) && !holder_left -> holder_left = true }
  :: d_step { holder_left -> granted[holder - 1] = false; grant(me) }
#if DEFECT == 29
  :: d_step { holder != 0 && !HOLDS(me) -> granted[holder - 1] = false; grant(me) }
#endif
  od
}

proctype Clock() {
  do
  :: d_step {
       holder != 0 ->
       life--;
       since_beat++;
       if :: life == 0 -> free() :: else fi
     }
  od
}

// A viewer that somebody has taken over. What it may send is more than what one that works sends.
proctype Liar() {
  do
  :: mail!ASK_ALIGN
  :: mail!ASK_START
  :: mail!ASK_RESET
  :: mail!ASK_PARAMETER
  :: mail!ASK_ENABLE
  :: mail!ASK_STOP
  :: atomic { !mail_stop -> mail_stop = true }
  od
}
