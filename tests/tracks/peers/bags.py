"""Imports and evaluates ROS 2 bags that the package rosbags wrote, in both storage formats."""

import csv
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

PREDICTOR = os.environ["PREDICTOR_BINARY"]
TYPES = get_typestore(Stores.ROS2_HUMBLE)
START = 1_700_000_000.25  # [s]



def mapping():
    text = ("name: Lift with two hands\nobject_mass: 8\noperator:\n"
            "  body: {height: 1.75, mass: 75, sex: male}\n"
            "  stance: {ground: [0.95, 0, -0.85], facing: 180 deg}\n")
    for hand in ("left", "right"):
        text += (f"{hand}_hand:\n  position: [/{hand}/pose.pose.position]\n"
                 f"  rotation: [/{hand}/pose.pose.orientation]\n"
                 f"  force: [/{hand}/wrench.wrench.force]\n  torque: [/{hand}/wrench.wrench.torque]\n"
                 "  axes: hand\n")
    return text


def position(hand, t):
    return np.array([0.5, -0.15 if hand == "left" else 0.15, 0.1 + 0.05 * math.sin(2 * t)])


def force(t):
    return np.array([3 * math.sin(t), 0, 40.0])


def header(t):
    stamp = TYPES.types["builtin_interfaces/msg/Time"](sec=int(t), nanosec=round((t - int(t)) * 1e9))
    return TYPES.types["std_msgs/msg/Header"](stamp=stamp, frame_id="base")


def pose(hand, t):
    make = TYPES.types
    p = position(hand, t - START)
    return make["geometry_msgs/msg/PoseStamped"](
        header=header(t),
        pose=make["geometry_msgs/msg/Pose"](
            position=make["geometry_msgs/msg/Point"](x=p[0], y=p[1], z=p[2]),
            orientation=make["geometry_msgs/msg/Quaternion"](x=0.0, y=0.0, z=math.sqrt(0.5), w=math.sqrt(0.5))))


def wrench(t):
    make = TYPES.types
    f = force(t - START)
    vector = make["geometry_msgs/msg/Vector3"]
    return make["geometry_msgs/msg/WrenchStamped"](
        header=header(t),
        wrench=make["geometry_msgs/msg/Wrench"](force=vector(x=f[0], y=f[1], z=f[2]),
                                                torque=vector(x=0.0, y=0.0, z=0.5)))


def odometry(hand, t):
    make = TYPES.types
    still = make["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    return make["nav_msgs/msg/Odometry"](
        header=header(t), child_frame_id=hand,
        pose=make["geometry_msgs/msg/PoseWithCovariance"](pose=pose(hand, t).pose, covariance=np.zeros(36)),
        twist=make["geometry_msgs/msg/TwistWithCovariance"](
            twist=make["geometry_msgs/msg/Twist"](linear=still, angular=still), covariance=np.zeros(36)))


def transforms(hand, t):
    """Places the hand between two frames whose names differ in length, so that the bytes after them move."""
    make = TYPES.types

    def transform(frame, p, q):
        return make["geometry_msgs/msg/TransformStamped"](
            header=header(t), child_frame_id=frame,
            transform=make["geometry_msgs/msg/Transform"](
                translation=make["geometry_msgs/msg/Vector3"](x=p[0], y=p[1], z=p[2]), rotation=q))

    q = pose(hand, t).pose.orientation
    frames = [transform("camera_link", [9.0, 9.0, 9.0], q), transform(hand, position(hand, t - START), q),
              transform("x", [8.0, 8.0, 8.0], q)]
    return make["tf2_msgs/msg/TFMessage"](transforms=frames)


def write_other_poses(folder):
    """Sends the left pose as odometry and the right one as a transform."""
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for hand, name, msgtype, make in (("left", "/left/odom", "nav_msgs/msg/Odometry", odometry),
                                          ("right", "/tf", "tf2_msgs/msg/TFMessage", transforms)):
            topic = writer.add_connection(name, msgtype, typestore=TYPES)
            for i in range(3 * 125):
                t = START + i / 125
                writer.write(topic, round((t + 0.02) * 1e9), TYPES.serialize_cdr(make(hand, t), msgtype))
            msgtype = "geometry_msgs/msg/WrenchStamped"
            topic = writer.add_connection(f"/{hand}/wrench", msgtype, typestore=TYPES)
            for i in range(3 * 500):
                t = START + i / 500
                writer.write(topic, round((t + 0.02) * 1e9), TYPES.serialize_cdr(wrench(t), msgtype))


def write_bag(folder, storage):
    with Writer(folder, version=9, storage_plugin=storage) as writer:
        for hand in ("left", "right"):
            for what, kind, rate in (("pose", "PoseStamped", 125), ("wrench", "WrenchStamped", 500)):
                msgtype = f"geometry_msgs/msg/{kind}"
                topic = writer.add_connection(f"/{hand}/{what}", msgtype, typestore=TYPES)
                for i in range(3 * rate):
                    t = START + i / rate
                    message = pose(hand, t) if what == "pose" else wrench(t)
                    # The message was received 20 ms late, and its stamp counts.
                    writer.write(topic, round((t + 0.02) * 1e9), TYPES.serialize_cdr(message, msgtype))


def run(*arguments):
    return subprocess.run([PREDICTOR, *map(str, arguments)], capture_output=True, text=True, check=False)


class Bags(unittest.TestCase):
    def imported(self, write, text):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        write(folder / "bag")
        (folder / "map.yaml").write_text(text)
        done = run("import", folder / "bag", "--map", folder / "map.yaml", "-o", folder / "lift.person.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        return folder / "lift.person.csv"

    def check(self, write, text):
        file = self.imported(write, text)
        with open(file) as lines:
            rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        self.assertGreater(len(rows), 290)
        for row in rows[10:280:10]:
            t = float(row["time [s]"])
            for hand in ("left", "right"):
                p = [float(row[f"{hand}_hand.p.{axis} [m]"]) for axis in "xyz"]
                np.testing.assert_allclose(p, position(hand, t), atol=2e-5)  # interpolated at 125 Hz
                f = [float(row[f"{hand}_hand.force.{axis} [N]"]) for axis in "xyz"]
                x, y, z = force(t)  # in the handle's axes, which are rotated by 90° about z
                np.testing.assert_allclose(f, [-y, x, z], atol=0.02)
        done = run("evaluate", file, "--json", "-", "--no-intervals", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual(result["person"]["operator"], "imported")
        self.assertFalse(result["person"]["simulated"])
        self.assertAlmostEqual(result["quantities"]["hands.left.force_n"]["mean"], 40.05, delta=0.1)
        self.assertGreater(result["quantities"]["lower_back.compression_n"]["mean"], 800)

    def test_sqlite(self):
        self.check(lambda folder: write_bag(folder, StoragePlugin.SQLITE3), mapping())

    def test_mcap(self):
        self.check(lambda folder: write_bag(folder, StoragePlugin.MCAP), mapping())

    def test_odometry_and_transforms(self):
        text = mapping()
        for old, new in (("/left/pose.pose.", "/left/odom.pose.pose."),
                         ("/right/pose.pose.position", "/tf[right].transform.translation"),
                         ("/right/pose.pose.orientation", "/tf[right].transform.rotation")):
            text = text.replace(old, new)
        self.check(write_other_poses, text.replace("position: [/tf[right].transform.translation]",
                                                   'position: ["/tf[right].transform.translation"]')
                   .replace("rotation: [/tf[right].transform.rotation]", 'rotation: ["/tf[right].transform.rotation"]'))


if __name__ == "__main__":
    unittest.main(verbosity=2)
