"""Runs a fake Franka arm as a separate process, and the tests that every client must pass."""

import math
import os
import pathlib
import subprocess

SCENARIO = pathlib.Path(__file__).parents[4] / "scenarios" / "single_arm.yaml"
SPEED = [0.2, -0.1, 0.15, 0.1, -0.2, 0.1, 0.3]  # peak [rad/s]
DURATION = 1.0  # [s]


class FrankaRig:
    """A fake arm whose time waits for commands, so that a client on a busy computer loses none."""

    def __init__(self, host, *words):
        self.process = subprocess.Popen(
            [os.environ["FAKE_RIG"], str(SCENARIO), ",".join([f"left=franka:{host}", "patient", *words])],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n"

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().rstrip("\n")

    def do(self, what):
        assert self.ask("do left 0 " + what) == "ok", what

    def log(self):
        lines = [self.ask("log left 0")]
        while lines[-1] != ".":
            lines.append(self.process.stdout.readline().rstrip("\n"))
        return lines[:-1]

    def joints(self):
        """Returns the true joint angles of the arm."""
        words = self.ask("state").split()
        first = words.index("q", words.index("left")) + 1
        return [float(word) for word in words[first:first + 7]]

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)
        self.process.stdout.close()


def speed_at(time):
    """Returns velocities that rise from rest to SPEED and return to rest within DURATION."""
    share = (1 - math.cos(2 * math.pi * min(time, DURATION) / DURATION)) / 2
    return [share * speed for speed in SPEED]


class FrankaCases:
    """The required behaviour of a client, as a mix-in for a TestCase.

    move(velocity_at, duration) commands velocity_at(time [s]). It calls saw(state, sent) with each state of the motion
    and the answer that was sent to the previous state.
    """

    WORDS = ()

    def saw(self, state, sent):
        self.states += 1
        if sent is None:
            self.last = [0.0] * 7
            return
        self.assertEqual(state.control_command_success_rate, 1.0)
        for has, asked, acceleration, last in zip(state.dq_d, sent, state.ddq_d, self.last, strict=True):
            self.assertAlmostEqual(has, asked, delta=1e-6)
            self.assertAlmostEqual(acceleration, (asked - last) / 1e-3, delta=1e-3)
        self.last = sent

    def setUp(self):
        self.rig = FrankaRig(self.HOST, *self.WORDS)
        self.addCleanup(self.rig.close)
        self.states = 0
        self.connect()

    def test_reads_the_joints(self):
        for read, true in zip(self.read().q, self.rig.joints(), strict=True):
            self.assertAlmostEqual(read, true, delta=1e-3)

    def test_reads_frames_and_the_wrench(self):
        state = self.read()
        turn = math.sqrt(0.5)
        hand = [turn, -turn, 0, 0, turn, turn, 0, 0, 0, 0, 1, 0, 0, 0, 0.1034, 1]
        cos, sin = math.cos(0.3), math.sin(0.3)
        stiffness = [1, 0, 0, 0, 0, cos, sin, 0, 0, -sin, cos, 0, 0.01, -0.02, 0.05, 1]
        for frame, expected in ((state.F_T_EE, hand), (state.EE_T_K, stiffness)):
            for read, true in zip(frame, expected, strict=True):
                self.assertAlmostEqual(read, true, delta=1e-6)
        self.assertTrue(any(state.K_F_ext_hat_K))
        self.assertEqual(state.m_total, 0)
        self.assertIn("Idle", str(state.robot_mode))

    def test_moves_as_asked_and_finishes(self):
        for _ in range(2):
            start = self.read().q
            self.move(lambda time: speed_at(time), DURATION)
            self.assertEqual(self.rig.log()[-1], "motion ended with status 0")
            self.assertGreaterEqual(self.states, 1000)
            end = self.read()
            self.assertIn("Idle", str(end.robot_mode))
            for before, after, speed in zip(start, end.q, SPEED, strict=True):
                self.assertAlmostEqual(after - before, speed * DURATION / 2, delta=3e-3)
            for read, true in zip(end.q, self.rig.joints(), strict=True):
                self.assertAlmostEqual(read, true, delta=3e-3)

    def test_a_jump_is_named(self):
        with self.assertRaises(Exception) as caught:
            self.move(lambda time: [0.5 if time > 0.05 else 0.0] * 7, DURATION)
        self.assertIn("motion aborted by reflex", str(caught.exception))
        self.assertIn("joint_motion_generator_velocity_discontinuity", str(caught.exception))
        self.assertIn("joint_motion_generator_acceleration_discontinuity", str(caught.exception))
        self.assertIn("Reflex", str(self.read().robot_mode))
        with self.assertRaises(Exception):
            self.move(lambda time: speed_at(time), DURATION)
        self.recover()
        self.move(lambda time: speed_at(time), DURATION)

    def test_a_slow_rise_beyond_the_limit_is_named(self):
        # The velocity limit of joint 1 is 2.175 rad/s (Panda) or 2.62 rad/s (Research 3).
        with self.assertRaises(Exception) as caught:
            self.move(lambda time: [3.0 * time, 0, 0, 0, 0, 0, 0], 2.0)
        self.assertIn("joint_motion_generator_velocity_limits_violation", str(caught.exception))

    def test_a_user_stop_is_seen(self):
        def velocity(time):
            if abs(time - 0.3) < 1e-6:
                self.rig.do("user stop")
            return speed_at(time)
        with self.assertRaises(Exception) as caught:
            self.move(velocity, DURATION)
        self.assertIn("User Stop pressed", str(caught.exception))
        self.assertIn("UserStopped", str(self.read().robot_mode))

    def test_errors_have_the_client_s_names(self):
        name = ""
        for place in range(self.ERRORS):
            self.rig.do(f"reflex {place}")
            before = name
            # The client first reads states that it has not read yet.
            for _ in range(5000):
                name = str(self.read().current_errors).strip('[]"')
                if name != before:
                    break
            self.assertEqual(self.rig.log()[-1], "reflex " + name.replace("_", " "))
