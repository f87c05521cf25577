"""Evaluates a simulated run with a C3D file that the package ezc3d wrote: markers of a head, with gaps."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import ezc3d
import numpy as np

PREDICTOR = os.environ["PREDICTOR_BINARY"]
RATE, FRAMES = 120, 720


def write_c3d(file):
    """Returns four markers on a resting head, in mm with z up, in a frame 1 m in front of W's origin."""
    head = np.array([-200.0, 50.0, 650.0])  # so in W: [0.8, 0.05, 0.65] m
    looks = {"FRONT": [-100, 0, 60], "BACK": [100, 0, 60], "LEFT": [0, -80, 60], "RIGHT": [0, 80, 60]}
    points = np.ones((4, len(looks), FRAMES))
    for k, offset in enumerate(looks.values()):
        points[:3, k, :] = (head + offset)[:, None]
    points[:3, 0, 240:300] = np.nan  # the front marker was hidden for half a second
    c3d = ezc3d.c3d()
    c3d["parameters"]["POINT"]["RATE"]["value"] = [RATE]
    c3d["parameters"]["POINT"]["UNITS"]["value"] = ["mm"]
    c3d["parameters"]["POINT"]["LABELS"]["value"] = list(looks)
    c3d["data"]["points"] = points
    c3d["parameters"]["ANALOG"]["RATE"]["value"] = [10 * RATE]
    c3d["parameters"]["ANALOG"]["LABELS"]["value"] = ["EMG1"]
    c3d["parameters"]["ANALOG"]["UNITS"]["value"] = ["V"]
    c3d["data"]["analogs"] = np.full((1, 1, 10 * FRAMES), 0.25)
    c3d.write(str(file))


MAP = """
file: head.c3d
frame: {xyz: [1, 0, 0]}
head:
  markers: [LEFT, RIGHT]
  front: [FRONT]
  back: [BACK]
  left: [LEFT]
  right: [RIGHT]
  xyz: [0, 0, -0.06]
series:
  - {name: emg.biceps, channel: EMG1}
"""


class C3d(unittest.TestCase):
    def test_head(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        write_c3d(folder / "head.c3d")
        (folder / "map.yaml").write_text(MAP)
        recording = folder / "box.mcap"
        simulated = subprocess.run([PREDICTOR, "simulate", os.environ["SCENARIO"], "--quiet", "--duration", "3",
                                    "--record", recording], capture_output=True, text=True, check=False)
        self.assertLessEqual(simulated.returncode, 1, simulated.stderr)
        done = subprocess.run([PREDICTOR, "evaluate", recording, "--track", folder / "map.yaml", "--quiet",
                               "--no-intervals", "--json", "-", "--csv", folder / "person.csv"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        measured = json.loads(done.stdout)["measured"]
        parts = {part["what"]: part for part in measured["parts"]}
        # While the marker is hidden, the rotation is unknown, and with it the place of the eyes.
        self.assertLess(parts["head"]["share_of_time"], 0.9)
        self.assertGreater(parts["head"]["share_of_time"], 0.7)
        self.assertEqual(parts["head"]["share_of_time"], parts["head rotation"]["share_of_time"])
        self.assertEqual(measured["signals"][0]["unit"], "V")
        last = (folder / "person.csv").read_text().splitlines()[-1]
        self.assertAlmostEqual(float(last.split(",")[-1]), 0.25, places=6)


if __name__ == "__main__":
    unittest.main(verbosity=2)
