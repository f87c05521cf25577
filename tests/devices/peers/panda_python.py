"""Tests the fake Panda (interface version 5) with panda-python, which contains libfranka 0.9.2.

Needs FAKE_RIG (the program) in the environment.
"""

import pathlib
import sys
import unittest

sys.path.append(str(pathlib.Path(__file__).parent / "support"))

from franka_rig import FrankaCases  # noqa: E402
from panda_py import libfranka  # noqa: E402


class PandaPython(FrankaCases, unittest.TestCase):
    HOST = "127.0.0.52"
    WORDS = ("panda",)
    ERRORS = 37  # panda-python has no names for the others

    def connect(self):
        self.robot = libfranka.Robot(self.HOST, libfranka.RealtimeConfig.kIgnore)
        self.assertEqual(self.robot.server_version(), 5)

    def read(self):
        return self.robot.read_once()

    def recover(self):
        self.robot.automatic_error_recovery()

    def move(self, velocity_at, duration):
        time, sent = 0.0, None

        def command(state, period):
            nonlocal time, sent
            self.saw(state, sent)
            time += period.to_sec()
            sent = velocity_at(time)
            velocities = libfranka.JointVelocities(sent)
            velocities.motion_finished = time >= duration
            return velocities

        # Disables libfranka's own rate limiter and filter.
        self.robot.control_joint_velocity(command, libfranka.ControllerMode.kJointImpedance, False, 1000.0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
