#!/usr/bin/env python3
"""Audits the commands to the arms with independent information: the bytes, the robot descriptions, and the documented
limits. It shares no code with the program that wrote the commands.

    audit_commands.py FILE...     prints a line for each violation; the exit code is then 1

A file contains runs one after the other (tests/devices/audit.h): the data about a run as JSON, then all bytes that were
written to an arm, with their times. For each arm, the audit checks:
  numbers      all finite, one for each joint of the arm
  velocity     of each joint: at most 80 % of the description's limit, and at most the scenario's limit
  acceleration of each joint, from one command to the next
  jerk         of each joint of a Franka, because Franka publishes a limit
  the handles  not faster in translation or rotation than the state permits (ALIGN, RUN, RECOVERY). The kinematics come
               from the description, at the joint angles at which the arm will obey: the last measured angles plus the
               commands since then, and those before that within the arm's lag
  rest         every command is zero in states without motion
  a stop       no handle accelerates (except while the jerk limit reverses an acceleration), and none exceeds the promised
               deceleration or jerk; afterwards every command is zero, as for rest
"""
import collections
import json
import math
import statistics
import struct
import sys
import xml.etree.ElementTree as Xml

SHARE_OF_VENDOR = 0.8          # of a joint's velocity in the robot's description
ROUNDING = 1e-6                # relative to a limit
OVERSHOOT = 1.25               # factor by which a stop may accelerate before it decelerates
# Tolerances of a handle's speed limit: a factor for the change of the kinematics until the arm obeys, and an offset [m/s], [rad/s].
POSTURE, NEARLY = 1.02, 0.001
COARSE = 0.005                 # motion of the joints after which the kinematics are computed again [rad]
FLUTTER = 0.5e-3               # change of a handle's speed between commands that is due to the posture [m/s]
TICK = 0.001                   # period of the program [s]
# If a motion already has a high jerk when a stop begins (for example because the emulated object
# shakes), the stop continues its acceleration. Within TAKING_OVER after that, the jerk must not
# exceed that of the time JUST_BEFORE [s].
TAKING_OVER, JUST_BEFORE = 0.005, 0.020
# One profile stops both handles and continues the acceleration of the faster one. The other one may start to decelerate
# immediately, with this fraction of the stop's acceleration.
ONSET = 0.5
# After lost commands, a Franka has deviated from the requested motion; it is led back within this time [s].
LED_BACK = 0.020
# The limits are from Franka's "Robot and interface specifications" (Research 3) [rad/s²], [rad/s³].
FRANKA_ACCELERATION, FRANKA_JERK = 10.0, 5000.0
# Our driver of a Franka permits this fraction of the limits and never passes a requested velocity. The requested velocity is
# therefore the one that a joint reaches once its acceleration has decayed to zero; the audit judges a stop by it. While the driver
# limits a joint, the joint lags behind, by up to 2a²/j after a change from −a to a. The audit then checks only the limits, both at
# the beginning of a stop and, for a few milliseconds, instead of a handle's speed.
LET_THROUGH = 0.95
FRANKA_A, FRANKA_J = LET_THROUGH * FRANKA_ACCELERATION, LET_THROUGH * FRANKA_JERK
AT_LIMIT = 0.999               # fraction of the permitted value
HELD_ON = 0.003                # time that a joint needs to catch up afterwards [s]
BEHIND, BRIEFLY, LATELY = 0.015, 0.010, 0.050  # additional speed of a handle [m/s]; its longest duration within the last LATELY [s]
FRANKA_COMMANDS = (370, 371)   # bytes, by version
RTDE_COMMAND = 3 + 1 + 6 * 8 + 2 * 4
MOVING = ('ALIGN', 'RUN', 'STOPPING', 'RECOVERY')  # from docs/concepts/states.md: all other states have no motion
STAND = (0.0,) * 6             # command to a UR's program to stop; the program then brakes on its own


# ---- a robot's kinematics, from its description -------------------------------------------------

def multiply(a, b):
    """Returns the product of two transforms. It is written out, because the audit spends most of its time here."""
    (b00, b01, b02, b03), (b10, b11, b12, b13), (b20, b21, b22, b23), last = b
    return [[x * b00 + y * b10 + z * b20, x * b01 + y * b11 + z * b21, x * b02 + y * b12 + z * b22,
             x * b03 + y * b13 + z * b23 + w] for x, y, z, w in a[:3]] + [last]


def transform(xyz, rpy):
    (r, p, y) = rpy
    cr, sr, cp, sp, cy, sy = (f(x) for x in (r, p, y) for f in (math.cos, math.sin))
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, xyz[0]],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr, xyz[1]],
            [-sp, cp * sr, cp * cr, xyz[2]],
            [0, 0, 0, 1]]


def rotation(axis, angle):
    (x, y, z), c, s = axis, math.cos(angle), math.sin(angle)
    d = 1 - c
    return [[c + x * x * d, x * y * d - z * s, x * z * d + y * s, 0],
            [y * x * d + z * s, c + y * y * d, y * z * d - x * s, 0],
            [z * x * d - y * s, z * y * d + x * s, c + z * z * d, 0],
            [0, 0, 0, 1]]


def numbers(text):
    return [float(x) for x in text.split()]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def total(columns, rates):
    """Returns the sum of the columns, each multiplied by its rate."""
    x = y = z = 0.0
    for c, rate in zip(columns, rates):
        x, y, z = x + c[0] * rate, y + c[1] * rate, z + c[2] * rate
    return (x, y, z)


class Arm:
    """The kinematic chain from a robot's base to its handle."""

    def __init__(self, known):
        root = Xml.parse(known['urdf']).getroot()
        by_child = {j.find('child').get('link'): j for j in root.findall('joint')}
        self.base = transform(**known['base'])
        self.handle = transform(**known['handle'])
        self.chain, self.velocity = [], []
        link = known['end_effector']
        while link in by_child:
            joint = by_child[link]
            origin = joint.find('origin')
            X = transform(numbers(origin.get('xyz', '0 0 0')), numbers(origin.get('rpy', '0 0 0'))) \
                if origin is not None else transform((0, 0, 0), (0, 0, 0))
            moves = joint.get('type') != 'fixed'
            axis = numbers(joint.find('axis').get('xyz')) if moves else None
            self.chain.insert(0, (X, axis))
            if moves:
                self.velocity.insert(0, float(joint.find('limit').get('velocity')))
            link = joint.find('parent').get('link')
        self.dof = len(self.velocity)
        limits = [SHARE_OF_VENDOR * v for v in self.velocity]
        if known['velocity_limit']:
            limits = [min(a, b) for a, b in zip(limits, known['velocity_limit'])]
        self.velocity = limits
        loop = known['loop']  # the mean lag of the loop, which is of second order plus a delay [s]
        self.lag = loop['delay'] + 2 * loop['damping_ratio'] / (2 * math.pi * loop['bandwidth'])
        a = known['acceleration_limit']
        self.acceleration = a if len(a) > 1 else a * self.dof

    def columns(self, q):
        """Returns for each joint the velocity of the handle's origin at 1 rad/s, and the joint's axis."""
        X, axes, k = self.base, [], 0
        for fixed, axis in self.chain:
            X = multiply(X, fixed)
            if axis is None:
                continue
            (x, y, z) = axis
            axes.append(([row[0] * x + row[1] * y + row[2] * z for row in X[:3]], [row[3] for row in X[:3]]))
            X = multiply(X, rotation(axis, q[k]))
            k += 1
        X = multiply(X, self.handle)
        p = [X[i][3] for i in range(3)]
        return [(cross(axis, [p[i] - at[i] for i in range(3)]), axis) for axis, at in axes]

    def handle_velocity(self, q, v):
        """Returns the velocity of the handle's origin [m/s]."""
        return total((c[0] for c in self.columns(q)), v)


# ---- the commands -------------------------------------------------------------------------------

def rtde_command(data):
    """Returns the joint velocities of an RTDE package of inputs, or STAND, or None for any other data."""
    if len(data) != RTDE_COMMAND or struct.unpack('>H', data[:2])[0] != len(data) or data[2:3] != b'U':
        return None
    v = struct.unpack('>6d', data[4:52])
    counter, follow = struct.unpack('>2i', data[52:])
    return v if follow == 1 or any(x != 0 for x in v) else STAND


def franka_command(data):
    """Returns the state number (negative before it wraps around) and the joint velocities of an FCI command, or None for any
    other data."""
    if len(data) not in FRANKA_COMMANDS:
        return None
    return struct.unpack('<q', data[:8])[0], struct.unpack('<7d', data[64:120])


def read(file):
    """Returns the runs: the data on each, and the commands to each arm (time [s], velocities)."""
    runs, clock = [], {}
    with open(file, 'rb') as source:
        data = source.read()
    at = 0
    while at + 16 <= len(data):
        time, hand, size = struct.unpack('<QII', data[at:at + 16])
        payload = data[at + 16:at + 16 + size]
        at += 16 + size
        if hand == 2:
            runs.append((json.loads(payload), ([], [])))
            clock = {}
            continue
        known, commands = runs[-1]
        if known['arms'][hand]['make'] == 'ur':
            v = rtde_command(payload)
            if v is not None:
                commands[hand].append((1e-9 * time, v))
        else:
            command = franka_command(payload)
            if command is None:
                continue
            # Times are in the robot's milliseconds, counted from the earliest command. The robot ignores a command that arrives in
            # a later millisecond.
            number, v = command
            now = 1e-9 * time - 1e-3 * number
            clock[hand] = min(clock.get(hand, now), now)
            if now - clock[hand] < TICK - 1e-9:
                commands[hand].append((clock[hand] + 1e-3 * number, v))
    if at != len(data):
        raise ValueError(file + ' ends in the middle of a piece')
    return runs


# ---- the limits ---------------------------------------------------------------------------------

# A handle's speed along its path, its commanded velocity, and its requested velocity [m/s]; the change of its acceleration between
# two commands that a driver's limits on the joints may cause [m/s²].
Speed = collections.namedtuple('Speed', 'time along sent asked limits')
Rate = collections.namedtuple('Rate', 'time sent asked limits')  # commanded and requested acceleration [m/s²]


def difference(a, b, dt=1.0):
    return tuple((y - x) / dt for x, y in zip(a, b))


class Judge:
    def __init__(self, known):
        self.known, self.wrong = known, []
        self.arms = [Arm(a) for a in known['arms']]

    def fail(self, hand, time, text):
        if len(self.wrong) < 5:
            self.wrong.append('%s, %s arm at %.4f s: %s' %
                              (self.known['name'], ('left', 'right')[hand], time, text))

    def joints(self, hand, commands):
        arm, franka = self.arms[hand], self.known['arms'][hand]['make'] == 'franka'
        before, rates, last_dt = None, None, 0
        for time, v in commands:
            if len(v) != arm.dof or not all(math.isfinite(x) for x in v):
                self.fail(hand, time, 'not %d finite numbers' % arm.dof)
                return
            for j in range(arm.dof):
                if abs(v[j]) > arm.velocity[j] * (1 + ROUNDING):
                    self.fail(hand, time, 'joint %d at %.4f rad/s' % (j, v[j]))
            if v is STAND:
                # Only a stop may leave a moving arm to its own deceleration.
                if before is not None and any(x != 0 for x in before[1]) and \
                        not 0 < self.known['stop'] <= 1e9 * (time + 3 * TICK):
                    self.fail(hand, time, 'is commanded to hold still while it moves')
                before, rates = None, None
                continue
            if before is not None and time <= before[0] and tuple(v) != tuple(before[1]):
                self.fail(hand, time, 'two commands at once')
            if before is not None and time > before[0]:
                # A package for a controller with a cycle of 2 ms may follow the last one after a millisecond.
                dt = max(time - before[0], TICK)
                now = [(a - b) / dt for a, b in zip(v, before[1])]
                for j in range(arm.dof):
                    most = min(arm.acceleration[j], FRANKA_ACCELERATION) if franka else arm.acceleration[j]
                    if abs(now[j]) > most * (1 + ROUNDING) + 1e-9:
                        self.fail(hand, time, 'joint %d accelerates by %.3f rad/s²' % (j, now[j]))
                    # The change is between the middles of the two intervals. In an interval without
                    # a command, the robot extrapolates.
                    if franka and rates is not None and dt < 1.5 * TICK and last_dt < 1.5 * TICK and \
                            abs(now[j] - rates[j]) > FRANKA_JERK * dt * (1 + ROUNDING) + 1e-6:
                        self.fail(hand, time, 'joint %d jerks by %.0f rad/s³' % (j, (now[j] - rates[j]) / dt))
                rates, last_dt = now, dt
            before = (time, v)

    def held(self, hand, commands):
        """The joints that a Franka's driver limits: first the jerk, then the acceleration as long as it is at its limit. For the time of
        each command, returns the joints that were limited within HELD_ON, each with its largest acceleration since then [rad/s²]
        and the time of its last limitation [s]."""
        times, holds = {}, {}
        if self.known['arms'][hand]['make'] != 'franka':
            return times
        rates, at_limit = None, set()
        for (t0, v0), (t1, v1) in zip(commands, commands[1:]):
            if not TICK / 2 < t1 - t0 < 1.5 * TICK or len(v0) != self.arms[hand].dof or len(v1) != len(v0):
                rates = None
                continue
            now = [(b - a) / (t1 - t0) for a, b in zip(v0, v1)]
            holds = {j: held for j, held in holds.items() if t1 <= held[1] + HELD_ON}
            for j, rate in enumerate(now):
                jerks = rates is not None and abs(rate - rates[j]) > AT_LIMIT * FRANKA_J * (t1 - t0)
                if jerks or (j in at_limit and abs(rate) > AT_LIMIT * FRANKA_A):
                    at_limit.add(j)
                    worst = max(abs(rate), abs(rates[j]) if rates else 0, holds[j][0] if j in holds else 0)
                    holds[j] = (worst, t1)
                else:
                    at_limit.discard(j)
            times[t1] = holds
            rates = now
        return times

    def handles(self, hand, commands):
        """Checks the handles with the state in which a command was computed and the posture in which the arm will obey it."""
        arm, stages = self.arms[hand], self.known['stages']
        at, q, seen, columns, last = -1, None, None, None, None
        held, fast = self.held(hand, commands), []
        for i, (time, v) in enumerate(commands):
            while at + 1 < len(stages) and 1e-9 * stages[at + 1]['time'] <= time + TICK / 2:
                at += 1
                q, seen, last = self.to_be_obeyed(stages[at]['q'][hand], commands[max(0, i - 99):i + 1], arm.lag), None, time
            if at < 0 or stages[at]['speed'] is None or len(q) != arm.dof or len(v) != arm.dof:
                continue
            q = [a + b * (time - last) for a, b in zip(q, v)]
            last = time
            if v is STAND or not any(v) or not all(math.isfinite(x) for x in v):
                continue
            if seen is None or any(abs(a - b) > COARSE for a, b in zip(q, seen)):
                columns, seen = arm.columns(q), list(q)
            speed = math.hypot(*total((c[0] for c in columns), v))
            turn = math.hypot(*total((c[1] for c in columns), v))
            most = stages[at]['speed'] * POSTURE + NEARLY
            behind = sum(2 * worst ** 2 / FRANKA_J * math.hypot(*columns[j][0]) for j, (worst, _) in held.get(time, {}).items())
            fast = [t for t in fast if t > time - LATELY] + [time] * (speed > most)
            if speed > most + min(behind, BEHIND) or len(fast) > BRIEFLY / TICK:
                self.fail(hand, time, 'a handle at %.4f m/s where %.4f are allowed' % (speed, stages[at]['speed']))
            if turn > stages[at]['rotation'] * POSTURE + NEARLY:
                self.fail(hand, time, 'a handle turns by %.4f rad/s where %.4f are allowed' %
                          (turn, stages[at]['rotation']))

    @staticmethod
    def to_be_obeyed(q, commands, lag):
        """Returns the joint angles to which an arm at q will move with the commands of the last `lag` [s], which it has not obeyed yet."""
        q, begin = list(q), commands[-1][0] - lag
        for (t0, v), (t1, _) in zip(commands, commands[1:]):
            if t1 > begin and len(v) == len(q):
                q = [a + b * (t1 - max(t0, begin)) for a, b in zip(q, v)]
        return q

    def rest(self, hand, commands):
        """In states without motion, every command must be zero."""
        stages, at = self.known['stages'], -1
        for time, v in commands:
            while at + 1 < len(stages) and 1e-9 * stages[at + 1]['time'] <= time + TICK / 2:
                at += 1
            if at >= 0 and stages[at]['state'] not in MOVING and any(x != 0 for x in v):
                self.fail(hand, time, 'is sent %s in %s' % (v, stages[at]['state']))
                return

    def stop(self, hand, commands):
        stop, rest = 1e-9 * self.known['stop'], 1e-9 * self.known['rest']
        if stop == 0:
            return
        for time, v in commands:
            if rest and time > rest + TICK / 2 and any(x != 0 for x in v):
                self.fail(hand, time, 'is sent %s after the stop' % (v,))
                return
        before = [c for c in commands if c[0] < stop - TICK / 2]
        before = before[-max(3, sum(c[0] > stop - JUST_BEFORE for c in before)):]
        after = [c for c in commands if c[0] >= stop - TICK / 2 and (not rest or c[0] <= rest)]
        # After a command to stand, the arm determines its own motion.
        after = after[:next((k for k, c in enumerate(after) if c[1] is STAND), len(after))]
        before = before[max((k + 1 for k, c in enumerate(before) if c[1] is STAND), default=0):]
        if not before or not after or len(self.known['arms'][hand]['q']) != self.arms[hand].dof:
            return
        speeds, at = self.along_the_way(hand, before, after), len(before)
        gaps = [y.time - x.time for x, y in zip(speeds, speeds[1:]) if y.time > x.time]
        nominal = statistics.median_low(gaps) if gaps else TICK
        self.speeding_up(hand, speeds, at, nominal)
        rates = [Rate(y.time, difference(x.sent, y.sent, y.time - x.time), difference(x.asked, y.asked, y.time - x.time), y.limits)
                 for x, y in zip(speeds, speeds[1:]) if y.time > x.time]
        for x, y in zip(speeds[at:], speeds[at + 1:]):
            braking = (x.along - y.along if x.along > 0 else y.along - x.along) / max(y.time - x.time, TICK)
            if braking > self.known['stop_acceleration'] * 1.1 + 0.1:
                self.fail(hand, y.time, 'a handle brakes by %.2f m/s²' % braking)
        self.jerking(hand, rates, speeds[at], nominal)

    def along_the_way(self, hand, before, after):
        """Returns the speeds of the handle. A speed is negative while the handle moves back along its path."""
        arm, q = self.arms[hand], list(self.known['arms'][hand]['q'])
        for (t0, _), (t1, v) in zip(before, before[1:]):  # back to the posture in which the first was obeyed
            q = [a - b * (t1 - t0) for a, b in zip(q, v)]
        franka, held = self.known['arms'][hand]['make'] == 'franka', self.held(hand, before + after)
        bound = self.bound_for(before + after) if franka else [v for _, v in before + after]
        speeds, last, way, sign = [], before[0][0], (0.0, 0.0, 0.0), 1
        for (time, v), asked in zip(before + after, bound):
            if time > last:
                q = [a + b * (time - last) for a, b in zip(q, v)]
                last = time
            columns = arm.columns(q)
            V = total((c[0] for c in columns), v)
            if sum(a * b for a, b in zip(V, way)) < 0:
                sign = -sign
            way = V if any(V) else way
            limits = sum(math.hypot(*columns[j][0]) * FRANKA_J * TICK
                         for j, (_, at) in held.get(time, {}).items() if time - at < 2.5 * TICK)
            speeds.append(Speed(time, sign * math.hypot(*V), V, total((c[0] for c in columns), asked), limits))
        return speeds

    @staticmethod
    def bound_for(commands):
        """Returns the velocities that a Franka's joints reach once their accelerations have decayed to zero with the permitted jerk."""
        bound = [list(v) for _, v in commands]
        for k, ((t0, v0), (t1, v1)) in enumerate(zip(commands, commands[1:]), 1):
            for j, (a, b) in enumerate(zip(v0, v1)):
                rate = abs(b - a) / max(t1 - t0, TICK) - FRANKA_J * TICK
                while rate > 0:
                    bound[k][j] += math.copysign(rate * TICK, b - a)
                    rate -= FRANKA_J * TICK
        return bound

    def speeding_up(self, hand, speeds, at, nominal):
        """Checks that no handle accelerates. speeds[at] is the first of the stop."""
        most = max(abs(x.along) for x in speeds[max(0, at - 3):at])
        if nominal > 1.5 * TICK or speeds[at].limits > 0:
            # The stop continues a velocity that was not sent to a controller with a cycle of 2 ms, or that a driver had not reached.
            most = max(most, min(abs(speeds[at].along), most + BEHIND))
        most = min(most * OVERSHOOT + 0.005, self.known['handle_speed'] * 1.02 + 0.005)
        for x in speeds[at:]:
            if abs(x.along) > most:
                self.fail(hand, x.time, 'a handle at %.4f m/s while stopping' % x.along)
            if x.time > speeds[at].time + TAKING_OVER:  # a speed that has decreased must not increase again
                most = min(most, abs(x.along) * OVERSHOOT + 0.005 + BEHIND)

    def jerking(self, hand, rates, first, nominal):
        """Checks the jerk between commands at the ends of their intervals. first: the first speed of the stop. A motion that shook before
        the stop may end with similar jerks."""
        slow, before, led_back = nominal > 1.5 * TICK, rates[0].time - nominal if rates else 0, -math.inf
        shook = max((math.dist(x.sent, y.sent) for x, y in zip(rates, rates[1:])
                     if y.time < first.time - TICK / 2 and y.time - x.time < 1.5 * nominal), default=0)
        usual = self.known['stop_jerk'] * nominal * 1.1 + FLUTTER / nominal
        for x, y in zip(rates, rates[1:]):
            # this is the first of its three commands
            early = x.time - nominal < first.time + TAKING_OVER - TICK / 2
            allowed = usual + max(shook - usual, y.limits if first.limits > 0 else 0, 0) * (1 + ROUNDING) if early else usual
            # If a command was late, the arm kept the previous one; the resulting jerk is not the program's.
            late = max(y.time - x.time, x.time - before) > 1.5 * nominal
            before = x.time
            led_back = y.time + LED_BACK if late else led_back
            if late or y.time < first.time - TICK / 2:
                continue
            jerk = math.dist(x.asked, y.asked)
            if early or y.time < led_back:  # the requested motion is unknown
                jerk = min(jerk, math.dist(x.sent, y.sent))
            if (x if slow else y).time < first.time + TICK / 2:
                # With a cycle of 2 ms, the first interval begins with a velocity that was not sent, so the second one is used.
                jerk = min(self.onset(x.sent, y.sent, first), self.onset(x.asked, y.asked, first))
                allowed += ONSET * self.known['stop_acceleration']
            if jerk > allowed:
                self.fail(hand, y.time, 'a handle jerks by %.0f m/s³ while stopping' % (jerk / nominal))

    @staticmethod
    def onset(before, after, first):
        """Returns the increase of the deceleration [m/s²]. An acceleration may end immediately."""
        along = lambda rate: sum(a * b for a, b in zip(rate, first.sent)) / max(math.hypot(*first.sent), 1e-9)
        return min(along(before), 0) - along(after)

    def run(self, commands):
        for hand in range(2):
            self.joints(hand, commands[hand])
            self.handles(hand, commands[hand])
            self.rest(hand, commands[hand])
            self.stop(hand, commands[hand])
        return self.wrong


def audit(files):
    wrong, judged = [], 0
    for file in files:
        for known, commands in read(file):
            wrong += Judge(known).run(commands)
            judged += sum(len(c) for c in commands)
    return wrong, judged


def main():
    wrong, judged = audit(sys.argv[1:])
    for line in wrong[:20]:
        print(line)
    if judged == 0:
        print('no commands were found: nothing was judged')
    return 1 if wrong or judged == 0 else 0


if __name__ == '__main__':
    sys.exit(main())
