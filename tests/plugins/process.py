"""A controller as a process. It carries the cobot's weight with springs until a given time and then performs the action
in its argument: crash, hang, nan, late, shorten, object (returns the object's pose), or priority (returns its scheduling
policy and priority). It can also refuse to start or end immediately."""

import mmap
import os
import struct
import sys
import time

fault, at = sys.argv[1], float(sys.argv[2])
memory = mmap.mmap(3, 0)
words = memoryview(memory).cast("I")
if fault == "ends":
    sys.exit(7)
parent, answered, broken = os.getppid(), 0, False
while os.getppid() == parent:
    request = words[2]
    if request == answered:
        time.sleep(0.00002)
        continue
    kind = words[4]
    if kind == 5:
        break
    if kind == 1 and fault == "refuses":
        struct.pack_into("<i", memory, 20, 1)
        memory[5072:5086] = b"Not for today\0"
    if kind == 3:
        (now,) = struct.unpack_from("<d", memory, 1192)
        (dof,) = struct.unpack_from("<i", memory, 1208)
        read = struct.Struct(f"<{dof}d").unpack_from
        q, v, g, posture = (read(memory, at_) for at_ in (1216, 1344, 1472, 4880))
        torque = [gj + 400 * (p - qj) - 10 * vj for gj, qj, vj, p in zip(g, q, v, posture)]
        if now >= at:
            if fault == "crash":
                os.abort()
            if fault == "shorten":
                try:
                    os.ftruncate(3, 0)
                except OSError:
                    # the program refuses this torque, so the test sees it at its limit
                    torque[0] = 1e3
            if fault == "hang":
                while os.getppid() == parent:
                    time.sleep(0.01)
            if fault == "object":
                torque = read(memory, 4824)  # X_WO
            if fault == "priority":
                torque[:2] = os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK, os.sched_getparam(0).sched_priority
            if fault == "nan":
                torque[0] = float("nan")
            if fault == "late" and not broken:
                broken = True
                time.sleep(0.02)
        struct.pack_into(f"<{dof}d", memory, 32, *torque)
    answered = request
    words[3] = request
