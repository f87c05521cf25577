"""Tests the fake UR with ur_rtde, a third-party client for robots of Universal Robots.

All times are measured with the fake's clock, so the test passes on a slow machine as well.
Needs FAKE_RIG (the program) and SCENARIO (two arms of six joints) in the environment.
"""

import os
import subprocess
import time
import unittest

import rtde_control
import rtde_receive

HOST = "127.0.0.41"
SPEED = [0.1, -0.05, 0.08, 0.02, -0.1, 0.06]  # rad/s
ACCELERATION = 2.0  # rad/s²
FIELDS = ["timestamp", "actual_q", "actual_qd", "safety_status_bits"]


class Rig:
    """The rig with its fakes, as a separate process."""

    def __init__(self):
        self.process = subprocess.Popen(
            [os.environ["FAKE_RIG"], os.environ["SCENARIO"], f"left=ur:{HOST}"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "ready\n"

    def ask(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        return self.process.stdout.readline().rstrip("\n")

    def log(self):
        lines = [self.ask("log left 0")]
        while lines[-1] != ".":
            lines.append(self.process.stdout.readline().rstrip("\n"))
        return lines[:-1]

    def joints(self):
        """Returns the true joint angles of the left arm."""
        words = self.ask("state").split()
        first = words.index("q", words.index("left")) + 1
        return [float(word) for word in words[first:first + 6]]

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)
        self.process.stdout.close()


def until(condition, seconds=20):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.002)
    return True


class UrRtde(unittest.TestCase):
    def setUp(self):
        self.rig = Rig()
        self.addCleanup(self.rig.close)
        self.control = self.receive = None
        # runs before the rig closes, because the clients would try to reconnect
        self.addCleanup(self.disconnect)

    def connect(self):
        self.control = rtde_control.RTDEControlInterface(HOST)
        self.receive = rtde_receive.RTDEReceiveInterface(HOST, 500.0, FIELDS)

    def disconnect(self):
        for client in (self.receive, self.control):
            if client is not None:
                client.disconnect()
        self.control = self.receive = None

    def sample(self):
        """Returns time and joints from the same package, even if the calls are slow."""
        while True:
            stamp, q = self.receive.getTimestamp(), self.receive.getActualQ()
            if self.receive.getTimestamp() == stamp:
                return stamp, q

    def move(self, seconds):
        """Commands SPEED repeatedly for this time on the controller's clock [s]."""
        end = self.receive.getTimestamp() + seconds
        def moved():
            self.assertTrue(self.control.speedJ(SPEED, ACCELERATION, 0.002))
            return self.receive.getTimestamp() >= end
        self.assertTrue(until(moved))

    def assertNearly(self, values, expected, tolerance):
        for value, wanted in zip(values, expected, strict=True):
            self.assertAlmostEqual(value, wanted, delta=tolerance)

    def test_moves_as_asked_and_stops(self):
        self.connect()
        self.assertTrue(self.control.isConnected())
        self.assertTrue(self.control.isProgramRunning())
        start = self.rig.joints()
        self.assertNearly(self.receive.getActualQ(), start, 1e-3)

        self.move(0.5)
        self.assertNearly(self.receive.getActualQd(), SPEED, 2e-3)
        time_before, q_before = self.sample()
        self.move(1.0)
        time_after, q_after = self.sample()
        mean = [(b - a) / (time_after - time_before) for a, b in zip(q_before, q_after)]
        self.assertNearly(mean, SPEED, 4e-3)

        self.assertTrue(self.control.speedStop(ACCELERATION))
        self.assertTrue(until(lambda: max(map(abs, self.receive.getActualQd())) < 2e-3))
        stopped = self.rig.joints()
        end = self.receive.getTimestamp() + 0.3
        self.assertTrue(until(lambda: self.receive.getTimestamp() >= end))
        self.assertNearly(self.rig.joints(), stopped, 1e-4)
        self.assertNearly(self.receive.getActualQ(), stopped, 1e-4)
        moved = [b - a for a, b in zip(start, stopped)]
        for joint, speed in zip(moved, SPEED, strict=True):
            self.assertGreater(joint * speed, 0)

        self.control.stopScript()
        self.assertTrue(until(lambda: not self.control.isProgramRunning()))
        self.assertEqual(self.rig.log(), ["program rtde_control", "program ended: by itself"])

    def test_protective_stop_is_seen_and_nothing_moves_on(self):
        self.connect()
        self.move(0.3)
        self.assertEqual(self.rig.ask("do left 0 protective stop"), "ok")
        self.assertTrue(until(self.receive.isProtectiveStopped))
        self.assertTrue(until(lambda: max(map(abs, self.receive.getActualQd())) < 2e-3))
        stopped = self.rig.joints()
        self.control.speedJ(SPEED, ACCELERATION, 0.002)
        end = self.receive.getTimestamp() + 0.3
        self.assertTrue(until(lambda: self.receive.getTimestamp() >= end))
        self.assertNearly(self.rig.joints(), stopped, 1e-4)

    def test_connects_again(self):
        for _ in range(2):
            self.connect()
            self.move(0.2)
            self.assertTrue(self.control.speedStop(ACCELERATION))
            self.control.stopScript()
            self.disconnect()


if __name__ == "__main__":
    unittest.main(verbosity=2)
