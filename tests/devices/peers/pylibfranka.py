"""Tests the fake Research 3 (interface version 10) with pylibfranka, Franka's own client.

Needs FAKE_RIG (the program) in the environment.
"""

import pathlib
import sys
import unittest

# Without this, `import pylibfranka` would find this file.
HERE = str(pathlib.Path(__file__).parent)
sys.path[:] = [folder for folder in sys.path if folder != HERE] + [HERE + "/support"]

from franka_rig import FrankaCases  # noqa: E402
from pylibfranka import ControllerMode, JointVelocities, RealtimeConfig, Robot  # noqa: E402


class Pylibfranka(FrankaCases, unittest.TestCase):
    HOST = "127.0.0.51"
    ERRORS = 41

    def connect(self):
        self.robot = Robot(self.HOST, RealtimeConfig.kIgnore)

    def read(self):
        return self.robot.read_once()

    def recover(self):
        self.robot.automatic_error_recovery()

    def move(self, velocity_at, duration):
        control = self.robot.start_joint_velocity_control(ControllerMode.JointImpedance)
        time, sent = 0.0, None
        while True:
            state, period = control.readOnce()
            self.saw(state, sent)
            time += period.to_sec()
            sent = velocity_at(time)
            command = JointVelocities(sent)
            command.motion_finished = time >= duration
            control.writeOnce(command)
            if command.motion_finished:
                return


if __name__ == "__main__":
    unittest.main(verbosity=2)
