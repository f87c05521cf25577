#!/usr/bin/env python3
"""Tests that the audit accepts correct streams of commands and finds a single defect in each of them."""
import json
import math
import os
import struct
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
import audit_commands as audit  # noqa: E402

# This is a planar arm whose joints rotate about z, at distances of 0.2 m.
URDF = '<robot name="r"><link name="l0"/>' + ''.join(
    '<link name="l%d"/><joint name="j%d" type="revolute"><parent link="l%d"/><child link="l%d"/>'
    '<origin xyz="0.2 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/>'
    '<limit lower="-3" upper="3" velocity="2.5" effort="1"/></joint>' % (i + 1, i + 1, i, i + 1)
    for i in range(7)) + '</robot>'

STOP, REST, END = 0.3, 0.5, 0.7  # [s]


class Stream:
    skipped = (0, 0)  # interval without commands [s]
    number = 1000     # first state number of a Franka
    stands = twice = early = END  # times: a UR is commanded to stand; a command occurs twice; packages leave 1 ms earlier [s]

    def __init__(self, make, folder, dof):
        self.make, self.dof = make, dof
        urdf = os.path.join(folder, 'r.urdf')
        with open(urdf, 'w') as out:
            out.write(URDF)
        zero = {'xyz': [0, 0, 0], 'rpy': [0, 0, 0]}
        self.known = {
            'name': make, 'stop': int(1e9 * STOP), 'rest': int(1e9 * REST), 'handle_speed': 0.25,
            'stop_acceleration': 5, 'stop_jerk': 250,
            'arms': [{'make': make, 'urdf': urdf, 'remove_links': [], 'end_effector': 'l%d' % dof,
                      'base': zero, 'handle': zero, 'velocity_limit': [], 'acceleration_limit': [10],
                      'loop': {'bandwidth': 15, 'damping_ratio': 0.9, 'delay': 0.004},
                      'q': [0.5] + [0.0] * (dof - 1)}] * 2}
        allowed = {'speed': 0.25, 'rotation': 1.5, 'q': [self.known['arms'][0]['q']] * 2}
        self.known['stages'] = [dict(allowed, time=int(1e9 * t), state='RUN') for t in (0, 0.1, 0.2)]
        no = dict(allowed, speed=None, rotation=None)
        self.known['stages'].append(dict(no, time=int(1e9 * STOP), state='STOPPING'))
        self.known['stages'].append(dict(no, time=int(1e9 * REST), state='HELD'))
        # Only the first joint moves: from rest to 0.1 rad/s, and then in a stop with bounded jerk.
        self.file = os.path.join(folder, 'run')
        self.v = [[0.1 * self.profile(t)] + [0.0] * (dof - 1) for t in self.times()]

    def times(self):
        return [1e-3 * k for k in range(int(1000 * END))]

    @staticmethod
    def profile(t):
        """Returns a velocity that rises within 0.1 s and falls within 0.15 s from the stop on. Each acceleration is half a sine wave."""
        up = 0.5 - 0.5 * math.cos(math.pi * min(1, t / 0.1))
        down = 0.5 - 0.5 * math.cos(math.pi * min(1, max(0, t - STOP) / 0.15))
        return up * (1 - down)

    def write(self):
        with open(self.file, 'wb') as out:
            def put(time, hand, data):
                out.write(struct.pack('<QII', int(round(1e9 * time)), hand, len(data)) + data)
            put(0, 2, json.dumps(self.known).encode())
            for k, (t, v) in enumerate(zip(self.times(), self.v)):
                if self.skipped[0] <= t < self.skipped[1]:
                    continue
                for v in (v, [x + 1e-4 for x in v]) if abs(t - self.twice) < 1e-4 else (v,):
                    if self.make == 'franka':
                        put(t, 0, struct.pack('<Q', self.number + k) + bytes(56) + struct.pack('<7d', *v) + bytes(250))
                    elif (k + (t >= self.early)) % 2 == 0:
                        v, follow = ([0.0] * 6, 0) if t >= self.stands else (v, 1)
                        put(t, 0, struct.pack('>HcB6d2i', 60, b'U', 1, *v, k, follow))

    def wrong(self):
        self.write()
        return audit.audit([self.file])[0]


class AuditTest(unittest.TestCase):
    def each(self, spoil, word, makes=('ur', 'franka')):
        """Expects no finding without the defect, and a finding that contains `word` with it."""
        for make in makes:
            with tempfile.TemporaryDirectory() as folder:
                stream = Stream(make, folder, 6 if make == 'ur' else 7)
                self.assertEqual(stream.wrong(), [], make)
                spoil(stream)
                wrong = stream.wrong()
                self.assertTrue(wrong, make + ' ' + word)
                self.assertIn(word, ' '.join(wrong), make)

    @staticmethod
    def add(stream, begin, end, joint, what):
        for k, t in enumerate(stream.times()):
            if begin <= t < end:
                stream.v[k][joint] += what(t)

    def test_velocity(self):
        def spoil(s):
            for k in range(100, 280):
                s.v[k][5] = 2.01  # the limit is 80 % of 2.5
        self.each(spoil, 'rad/s')

    def test_acceleration(self):
        self.each(lambda s: self.add(s, 0.2, 0.25, 4, lambda t: 0.021), 'accelerates')

    def test_a_step_of_one_command(self):
        self.each(lambda s: self.add(s, 0.2, 0.202, 1, lambda t: 0.05), 'accelerates')

    def test_jerk(self):
        # The acceleration goes from −6 to +6 rad/s² in a millisecond and stays within its limit.
        def spoil(s):
            self.add(s, 0.2, 0.22, 4, lambda t: 0.1 - 6 * abs(t - 0.21) - 0.04)
        self.each(spoil, 'jerks', makes=('franka',))

    def test_not_a_number(self):
        self.each(lambda s: self.add(s, 0.2, 0.202, 0, lambda t: math.nan), 'finite')

    def test_a_handle_that_is_too_fast(self):
        # The arm is at least 1 m long; the velocity rises and falls within the acceleration limit of the joint.
        self.each(lambda s: self.add(s, 0.15, 0.28, 0,
                                     lambda t: 0.25 * math.sin(math.pi * (t - 0.15) / 0.13) ** 2), 'are allowed')

    def test_a_handle_is_judged_where_its_arm_will_obey(self):
        # The third joint folds or unfolds the arm. The measured posture is that of the command 0.1 s earlier.
        lag, turning = 0.1, [1.5, 0, -0.8, 0, 0, 0]
        for begin, allowed, well in ((math.pi / 2 + 0.12, 0.735, True), (math.pi / 2 + 0.12, 0.7245, False),
                                     (-math.pi / 2 + 0.12, 0.735, True), (-math.pi / 2 + 0.12, 0.72, False)):
            with tempfile.TemporaryDirectory() as folder:
                stream = Stream('ur', folder, 6)
                stream.known.update(stop=0, rest=0)
                for arm in stream.known['arms']:
                    arm['loop'] = {'bandwidth': 1e9, 'damping_ratio': 1, 'delay': lag}
                stream.v = [turning for _ in stream.times()]
                stream.known['stages'] = [
                    {'time': int(round(1e9 * t)), 'state': 'RUN', 'rotation': 1.5,
                     'speed': allowed if 0.1 <= t < 0.2 else None,
                     'q': [[a + b * (t - lag) for a, b in zip([0, 0, begin, 0, 0, 0], turning)]] * 2}
                    for t in (0, 0.1, 0.15, 0.2)]
                for stage in stream.known['stages']:
                    if stage['speed'] is None:
                        stage['rotation'] = None
                wrong = stream.wrong()
                self.assertEqual(not wrong, well, (begin, allowed, wrong))
                self.assertTrue(all('are allowed' in w for w in wrong), wrong)

    def test_a_handle_that_is_too_fast_for_its_state(self):
        # The same motion (0.1 rad/s at 1 m) with a lower speed limit between 0.1 and 0.2 s.
        def spoil(s):
            s.known['stages'][1]['speed'] = 0.05
        self.each(spoil, 'm/s where 0.0500 are allowed')

    def test_a_handle_that_turns_too_fast(self):
        def spoil(s):
            s.known['stages'][2]['rotation'] = 0.08
        self.each(spoil, 'rad/s where 0.0800 are allowed')

    def test_a_state_counts_from_its_first_command_to_its_last(self):
        # One command at either end of the stage is too fast.
        for make, step in (('ur', 0.002), ('franka', 0.001)):
            for first, last in ((0.1, 0.1 + step), (0.2 - step, 0.2)):
                with tempfile.TemporaryDirectory() as folder:
                    stream = Stream(make, folder, 6 if make == 'ur' else 7)
                    lowered = dict(stream.known['stages'][0], time=int(round(1e9 * first)), speed=0.05)
                    after = dict(lowered, time=int(round(1e9 * last)), speed=0.25)
                    stages = stream.known['stages']
                    stream.known['stages'] = sorted(
                        [s for s in stages if s['time'] not in (lowered['time'], after['time'])] + [lowered, after],
                        key=lambda s: s['time'])
                    wrong = stream.wrong()
                    self.assertEqual(len(wrong), 1, (make, first, wrong))

    def test_motion_after_a_stop(self):
        self.each(lambda s: self.add(s, 0.6, 0.62, 2, lambda t: 1e-4), 'after the stop')

    def test_motion_where_nothing_may_move(self):
        for state in ('INIT', 'SELFTEST', 'IDLE', 'ARMED', 'HELD', 'UNPOWERED'):
            def spoil(s):
                s.known['stop'] = s.known['rest'] = 0
                s.known['stages'][-1]['state'] = state
                self.add(s, 0.6, 0.62, 2, lambda t: 1e-4)
            self.each(spoil, 'in ' + state)

    def test_motion_before_anything_may_move(self):
        # This is the first known state.
        def spoil(s):
            s.known['stages'][0]['state'] = 'IDLE'
            self.add(s, 0, 0.004, 3, lambda t: 1e-5)
        self.each(spoil, 'in IDLE')

    def test_what_dies_away_when_nothing_may_move_any_more(self):
        # Even a small and short motion must be found.
        def spoil(s):
            s.known['stop'] = s.known['rest'] = 0
            self.add(s, REST - 0.02, REST + 0.004, 5, lambda t: 0.002 * min(1.0, (t - REST + 0.02) / 0.018,
                                                                            (REST + 0.004 - t) / 0.006))
        self.each(spoil, 'in HELD')

    def test_braking_too_hard(self):
        def spoil(s):
            for k, t in enumerate(s.times()):
                if t >= 0.1:
                    s.v[k][0] = max(0.0, 0.18 - max(0.0, t - STOP) * 9.9) if t >= STOP else \
                        0.1 + min(0.08, (t - 0.1))
        self.each(spoil, 'brakes')

    def test_speeding_up_in_a_stop(self):
        self.each(lambda s: self.add(s, STOP + 0.01, STOP + 0.1, 0,
                                     lambda t: 0.12 * math.sin(math.pi * (t - STOP - 0.01) / 0.09) ** 2),
                  'while stopping')

    def test_jerk_in_a_stop(self):
        # The motion is within the acceleration limits of the joints and the handle.
        self.each(lambda s: self.add(s, STOP + 0.08, STOP + 0.084, 0, lambda t: 0.008), 'm/s³',
                  makes=('ur',))

    def test_a_motion_that_jerks_already(self):
        # A motion that shakes before a stop may end with a similar jerk. Without the shaking, or
        # later, this is not permitted.
        shake = lambda begin, end: lambda s: self.add(s, begin, end, 0, lambda t: 0.008)
        with tempfile.TemporaryDirectory() as folder:
            stream = Stream('ur', folder, 6)
            shake(STOP - 0.012, STOP - 0.008)(stream)
            shake(STOP - 0.004, STOP + 0.002)(stream)
            self.assertEqual(stream.wrong(), [])
            shake(STOP + 0.012, STOP + 0.016)(stream)
            self.assertIn('m/s³', ' '.join(stream.wrong()))
        self.each(shake(STOP, STOP + 0.002), 'm/s³', makes=('ur',))

    def test_jerk_of_a_franka_in_a_stop(self):
        # The stop is within the limits of its joints, both during the stop and at its beginning.
        for begin in (STOP + 0.08, STOP):
            self.each(lambda s: self.add(s, begin, begin + 0.004, 0, lambda t: 0.0042), 'm/s³', makes=('franka',))

    def test_what_a_driver_of_a_franka_catches_up_with(self):
        # If the driver limits a joint when the stop begins, its jerk may stay at the limit for a little longer. This is not
        # permitted if the joint was limited only earlier or later, or if the jerk is slightly below the limit.
        def stop(begin, end, much):
            with tempfile.TemporaryDirectory() as folder:
                stream = Stream('franka', folder, 7)
                stream.known['stop_acceleration'] = 10
                stream.v = [[much if begin <= t < end else 0.0] + [0.0] * 6 for t in stream.times()]
                return stream.wrong()
        full = 0.95 * 5 * 0.001
        self.assertEqual(stop(STOP - 0.004, STOP + 0.002, full), [])
        self.assertIn('m/s³', ' '.join(stop(STOP + 0.012, STOP + 0.016, full)))
        self.assertIn('m/s³', ' '.join(stop(STOP - 0.025, STOP + 0.002, 0.99 * full)))

    @staticmethod
    def followed(asked):
        """Returns velocities of a joint that never passes the requested ones and has the permitted jerk."""
        J, v, a, out = 0.95 * 5000, 0.0, 0.0, []
        for target in asked:
            def comes_to(rate):  # velocity once the acceleration has decayed to zero
                end = v + 1e-3 * rate
                while rate > 0:
                    rate -= 1e-3 * J
                    end += 1e-3 * max(0, rate)
                return end
            down = target < v
            if down:
                v, a, target = -v, -a, -target
            low, high = a - 1e-3 * J, a + 1e-3 * J
            for _ in range(60):
                middle = (low + high) / 2
                low, high = (middle, high) if comes_to(middle) <= target else (low, middle)
            v, a = v + 1e-3 * low, low
            if down:
                v, a = -v, -a
            out.append(round(v, 12))
        return out

    def test_a_stop_that_a_driver_of_a_franka_follows(self):
        # The joint decelerates at 9 rad/s² with the permitted jerk. It lags by a²/2j, which is no
        # violation, but a spike is one.
        hardest, ramp = 9.0, 0.008
        def rate(t):
            return hardest * max(0.0, min(1.0, (t - STOP) / ramp, (STOP + 0.04 - t) / ramp))
        with tempfile.TemporaryDirectory() as folder:
            stream = Stream('franka', folder, 7)
            v, asked = 0.0, []
            stop = sum(1e-3 * rate(t) for t in stream.times())
            for t in stream.times():
                v = stop * 0.5 * (1 - math.cos(math.pi * min(1, t / 0.1))) if t < STOP else v - 1e-3 * rate(t)
                asked.append(max(v, 0.0))
            sent = self.followed(asked)
            stream.v = [[0.0] * 5 + [x, 0.0] for x in sent]
            stream.known.update(stop_jerk=hardest / ramp * 0.2, stop_acceleration=hardest * 0.2)
            self.assertGreater(max(b - a for a, b in zip(asked, sent)), 0.003)
            self.assertEqual(stream.wrong(), [])
            for at in (STOP + 0.010, STOP + 0.015, STOP + 0.020, STOP + 0.030):
                stream.v = [[0.0] * 5 + [x, 0.0] for x in sent]
                self.add(stream, at - 1e-4, at + 0.0005, 5, lambda t: -0.0022)
                self.assertIn('m/s³', ' '.join(stream.wrong()), at)

    def test_a_handle_of_a_franka_whose_joint_is_held_back(self):
        # At 0.1 rad/s and 1.2 m, the handle is faster for a few milliseconds in five ways: with the
        # driver's permitted jerk, with slightly less, gently, for longer, and by more than a
        # limited joint can lag behind.
        full = 0.95 * 5 * 0.001
        quick = [full, 0.0085, 0.0085, 0.0085 - full]
        # The joint is shaken at its limit all the time. Excess speed for 12 ms is a violation, even
        # if the driver limits the joint.
        longer = [full, 0.0085] + [0.0085 - full * (k % 2) / 2 for k in range(12)] + [0.0085 - full]
        faster = [full * k for k in (1, 3, 4, 4, 3, 1)]
        for more, well in ((quick, True), ([0.9 * x for x in quick], False),
                           ([0.0008 * min(k, 20 - k) for k in range(20)], False), (longer, False), (faster, False)):
            with tempfile.TemporaryDirectory() as folder:
                stream = Stream('franka', folder, 7)
                stream.known['stages'][2]['speed'] = 0.122
                for k, v in enumerate(more):
                    stream.v[230 + k][0] += v
                wrong = stream.wrong()
                self.assertEqual([w for w in wrong if 'jerks' in w or 'accel' in w], [])
                self.assertEqual(not wrong, well, (more, wrong))

    def test_a_stop_continues_from_the_unsent_command_of_a_2_ms_controller(self):
        # The arm accelerates slowly, so it was faster a millisecond later. This difference is permitted, except for a Franka.
        def stop(make, at):
            with tempfile.TemporaryDirectory() as folder:
                stream = Stream(make, folder, 6 if make == 'ur' else 7)
                stream.known.update(stop_acceleration=20, stop_jerk=1e5)
                for k, t in enumerate(stream.times()):
                    begun = max(0.0, t - STOP + 0.004)
                    v = 6 * begun if t < STOP else max(0.0, at - 2 * (t - STOP))
                    stream.v[k] = [v] + [0.0] * (stream.dof - 1)
                return [w for w in stream.wrong() if 'while stopping' in w]
        # The last commands are 0.012 rad/s at 1 m and 0.018 rad/s at 1.2 m.
        for make, most in (('ur', (0.012 + 0.015) * 1.25 + 0.005), ('franka', (0.018 * 1.2 * 1.25 + 0.005) / 1.2)):
            self.assertEqual(stop(make, most - 1e-5), [], make)
            self.assertTrue(stop(make, most + 1e-4), make)

    @staticmethod
    def at_handle(stream, speed):
        """Moves only the first joint, so that the handle has the given speed [m/s] as a function of time [s]."""
        reach = 1.0 if stream.make == 'ur' else 1.2
        stream.v = [[speed(t) / reach if t < REST else 0.0] + [0.0] * (stream.dof - 1) for t in stream.times()]

    @staticmethod
    def smooth(a, b, part):
        return a + (b - a) * (0.5 - 0.5 * math.cos(math.pi * min(1.0, max(0.0, part))))

    def test_a_stop_that_begins_with_a_jerk(self):
        # The handle decelerates at the limit from the first command on, or after a delay, and ends
        # smoothly.
        for wait in (0.0, 0.004, 0.02):
            def spoil(s):
                hard = lambda t: max(0.2 - 4.5 * max(0.0, t - STOP - wait), 0.2 * math.exp(-(t - STOP - wait) / 0.04))
                self.at_handle(s, lambda t: self.smooth(0, 0.2, t / 0.1) if t < STOP + wait else
                               hard(t) * self.smooth(1, 0, (t - STOP - 0.1) / 0.09))
            self.each(spoil, 'm/s³')

    def test_a_joint_at_its_limit_within_a_stop(self):
        # After a steady motion, there is no lag to recover.
        full = 0.95 * 5 * 0.001
        for at in (STOP + 0.001, STOP + 0.002, STOP + 0.003):
            self.each(lambda s: self.add(s, at, STOP + 0.1, 0, lambda t: -full * min(1, (STOP + 0.1 - t) / 0.02)), 'm/s³',
                      makes=('franka',))

    def test_speeding_up_later_in_a_stop(self):
        # The handle decelerates to rest, accelerates to less than the first speed, and decelerates
        # again.
        def spoil(s):
            self.at_handle(s, lambda t: self.smooth(0, 0.2, t / 0.1) if t < STOP else
                           self.smooth(0.2, 0, (t - STOP) / 0.08) if t < STOP + 0.08 else
                           self.smooth(0, 0.08, (t - STOP - 0.08) / 0.06) if t < STOP + 0.14 else
                           self.smooth(0.08, 0, (t - STOP - 0.14) / 0.05))
        self.each(spoil, 'm/s while stopping')

    def test_a_stop_is_judged_until_the_arm_is_commanded_to_hold_still(self):
        def spoil(s):
            self.add(s, STOP + 0.01, STOP + 0.1, 0, lambda t: 0.12 * math.sin(math.pi * (t - STOP - 0.01) / 0.09) ** 2)
            s.stands = STOP + 0.18
        self.each(spoil, 'm/s while stopping', makes=('ur',))

    def test_a_jerk_into_a_stop_is_no_shaking_before_it(self):
        # The result must not depend on how the state numbers round the times.
        for number in (1000, 1523, 123456):
            def spoil(s):
                s.number = number
                self.add(s, STOP, STOP + 0.001, 0, lambda t: 0.004)
                self.add(s, STOP + 0.001, STOP + 0.1, 0, lambda t: 0.0046 * min(1, (STOP + 0.1 - t) / 0.02))
            self.each(spoil, 'm/s³', makes=('franka',))

    def test_what_one_joint_hides_of_another(self):
        # One joint lags and the other does not. The requested motion has its jerk in one command,
        # the commanded motion in the next.
        def spoil(s):
            step, v, out = 0.95 * 5e-3, [0.0, 0.0], []
            for k in range(700):
                n = k - 300
                first, second = (0.0, -1.1 * max(0, min(1, n / 24, (58 - n) / 25)))
                if 25 <= n <= 32 and (n - 25) // 2 % 2 == 0:
                    first, second = 0.8, -1.1 - 0.48
                v = [v[0] + first * step, v[1] + second * step] if n > 0 else [0.0, 0.25 * self.smooth(0, 1, k / 100)]
                left = self.smooth(1, 0, (n - 60) / 100)
                out.append([v[0] * left, v[1] * left] + [0.0] * 5 if k < 500 else [0.0] * 7)
            s.v = out
        self.each(spoil, 'm/s³', makes=('franka',))

    def test_two_commands_at_once(self):
        def spoil(s):
            s.twice = 0.2
        self.each(spoil, 'at once')

    def test_one_package_that_leaves_early(self):
        # The audit must still judge the other packages.
        def spoil(s):
            s.early = STOP - 0.02
            self.add(s, STOP + 0.08, STOP + 0.084, 0, lambda t: 0.008)
        self.each(spoil, 'm/s³', makes=('ur',))

    def test_a_stop_after_a_pause(self):
        with tempfile.TemporaryDirectory() as folder:
            stream = Stream('ur', folder, 6)
            self.add(stream, STOP + 0.08, STOP + 0.084, 0, lambda t: 0.008)
            stream.skipped = (STOP - 0.04, STOP - 0.001)
            self.assertIn('m/s³', ' '.join(stream.wrong()))

    def test_a_handle_that_turns_back(self):
        # The velocity passes through zero and returns without a jerk. Its magnitude alone would
        # appear to have one.
        back = lambda s: self.add(s, STOP + 0.125, STOP + 0.185, 0,
                                  lambda t: -0.01 * math.sin(math.pi * (t - STOP - 0.125) / 0.06) ** 2)
        with tempfile.TemporaryDirectory() as folder:
            stream = Stream('ur', folder, 6)
            back(stream)
            self.assertLess(min(v[0] for v in stream.v), -0.005)
            self.assertEqual(stream.wrong(), [])

        def spoil(s):
            back(s)
            self.add(s, STOP + 0.160, STOP + 0.164, 0, lambda t: -0.008)
        self.each(spoil, 'm/s³', makes=('ur',))

    def test_commanded_to_hold_still_while_it_moves(self):
        with tempfile.TemporaryDirectory() as folder:
            stream = Stream('ur', folder, 6)
            stream.write()
            with open(stream.file, 'ab') as out:
                for t, v, follow in ((0.72, 0.003, 1), (0.722, 0.0, 0)):
                    data = struct.pack('>HcB6d2i', 60, b'U', 1, v, 0, 0, 0, 0, 0, 7, follow)
                    out.write(struct.pack('<QII', int(1e9 * t), 0, len(data)) + data)
            stream.known['stop'] = stream.known['rest'] = 0
            wrong = []
            for known, commands in audit.read(stream.file):
                known['stop'] = known['rest'] = 0
                wrong += audit.Judge(known).run(commands)
            self.assertIn('commanded to hold still', ' '.join(wrong))

    def test_nothing_to_judge(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, 'empty')
            open(file, 'wb').close()
            sys.argv = ['audit', file]
            self.assertEqual(audit.main(), 1)


if __name__ == '__main__':
    unittest.main()
