"""Springs and dampers in the joints, tau = g + K (posture - q) - d M v, as a process in Python.

It needs only the standard library. The parameters joint_stiffness K [N·m/rad] and damping_rate d
[1/s] apply to all joints. joint_impedance.c explains why the damping is proportional to the mass
matrix M. A scenario next to this file refers to it like this:

  cobot:
    controller: {type: process, command: [python3, joint_impedance.py]}
"""

import math
import mmap
import os
import struct
import time

CREATE, START, COMPUTE, ADVANCE, END = 1, 2, 3, 4, 5
VERSION = 3

# These are offsets in PredictorControllerMemory (predictor/controller.h).
REQUEST, ANSWER, KIND, REFUSED = 8, 12, 16, 20
TORQUE, ENERGY, INPUT, POSTURE, TEXT = 32, 160, 1192, 4880, 5072
DOF, Q, V, G, M = INPUT + 16, INPUT + 24, INPUT + 152, INPUT + 280, INPUT + 1584

BUSY_TIME = 0.01  # after a request, the next one is awaited without sleeping [s]


def is_number_from_0(text):
    try:
        return 0 <= float(text) < math.inf
    except ValueError:
        return False


class JointImpedance:
    def __init__(self, memory):
        self.memory = memory
        self.numbers, self.matrix = struct.Struct("<7d"), struct.Struct("<49d")
        self.stiffness, self.damping_rate = 100.0, 50.0

    def create(self):
        (dof,) = struct.unpack_from("<i", self.memory, DOF)
        self.dof, self.numbers, self.matrix = dof, struct.Struct(f"<{dof}d"), struct.Struct(f"<{dof * dof}d")
        self.posture = self.numbers.unpack_from(self.memory, POSTURE)
        text = self.memory[TEXT:].split(b"\0")[0].decode()
        for word in text.split("\n")[0].split():
            key, _, value = word.partition("=")
            if key not in ("joint_stiffness", "damping_rate"):
                raise ValueError(
                    f'In cobot.controller.parameters, "{key}" is not one of its parameters. '
                    "Use joint_stiffness or damping_rate."
                )
            if not is_number_from_0(value):
                raise ValueError(
                    f'In cobot.controller.parameters, {key} is "{value}". '
                    f"Give a finite number from 0, such as {key}=100."
                )
            setattr(self, key.removeprefix("joint_"), float(value))

    def compute(self):
        read = self.numbers.unpack_from
        q, v, g = read(self.memory, Q), read(self.memory, V), read(self.memory, G)
        mass = self.matrix.unpack_from(self.memory, M)
        offset = [p - x for p, x in zip(self.posture, q)]
        torque = []
        for j in range(self.dof):
            momentum = 0.0  # of joint j, (M v)_j
            for m, x in zip(mass[j :: self.dof], v):
                momentum += m * x
            torque.append(g[j] + self.stiffness * offset[j] - self.damping_rate * momentum)
        self.numbers.pack_into(self.memory, TORQUE, *torque)
        struct.pack_into("<d", self.memory, ENERGY, 0.5 * self.stiffness * sum(x * x for x in offset))


def main():
    memory = mmap.mmap(3, 0)
    version, size = struct.unpack_from("<II", memory, 0)
    if version != VERSION or size != len(memory):
        raise SystemExit(f"PREDICTOR has version {version} of the interface, but this controller {VERSION}.")
    words = memoryview(memory).cast("I")  # each load and store is a single one
    parent = os.getppid()
    controller = JointImpedance(memory)
    answered, heard = 0, time.monotonic()
    while True:
        request = words[REQUEST // 4]
        if request == answered:
            if time.monotonic() - heard > BUSY_TIME:
                if os.getppid() != parent:
                    return
                time.sleep(0.0002)
            continue
        kind = words[KIND // 4]
        if kind == END:
            return
        if kind == CREATE:
            try:
                controller.create()
            except ValueError as error:
                struct.pack_into("<i", memory, REFUSED, 1)
                memory[TEXT : TEXT + 1001] = str(error).encode()[:1000].ljust(1001, b"\0")
        elif kind == COMPUTE:
            controller.compute()
        answered, heard = request, time.monotonic()
        words[ANSWER // 4] = request


main()
