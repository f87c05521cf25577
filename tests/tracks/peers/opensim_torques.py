"""OpenSim loads an exported person and computes the joint torques in two ways: its solver uses our postures,
velocities and accelerations, and its tool uses the exported files alone."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import opensim

PREDICTOR = os.environ["PREDICTOR_BINARY"]


def table(file):
    """Returns the columns of a storage file by name."""
    lines = Path(file).read_text().splitlines()
    begin = lines.index("endheader") + 1
    names = lines[begin].split("\t")
    rows = np.array([[float(x) for x in line.split("\t")] for line in lines[begin + 1:] if line])
    return dict(zip(names, rows.T))


class OpenSim(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        cls.folder = folder / "person"
        recording = folder / "run.mcap"
        simulated = subprocess.run([PREDICTOR, "simulate", os.environ["SCENARIO"], "--quiet", "--duration", "4",
                                    "--record", recording], capture_output=True, text=True, check=False)
        assert simulated.returncode <= 1, simulated.stderr
        done = subprocess.run([PREDICTOR, "export", "person", recording, "-o", cls.folder, "--quiet"],
                              capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr

    def test_model_is_that_body(self):
        model = opensim.Model(str(self.folder / "person.osim"))
        state = model.initSystem()
        self.assertEqual(model.getNumCoordinates(), 26)
        # These are De Leva's shares of a man of 75 kg without the legs: 2 (0.1416 + 0.0433 +
        # 0.0137).
        self.assertAlmostEqual(model.getTotalMass(state), 75 * (1 - 2 * 0.1986), delta=0.02 * 75)

    # The tolerance is 1 % of the largest torque of each joint, in the middle of the record, because
    # splines and differences disagree at its ends. The entries of the pelvis are what the legs
    # exert. For them, the tolerance refers to the largest force or torque among them.
    def test_tool_reproduces_torques(self):
        tool = opensim.InverseDynamicsTool(str(self.folder / "inverse_dynamics.xml"))
        tool.setResultsDir(str(self.folder))
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            self.assertTrue(tool.run())
        finally:
            os.chdir(before)
        ours, theirs = table(self.folder / "torques.sto"), table(self.folder / "opensim_torques.sto")
        self.assertEqual(set(ours), set(theirs))
        pelvis = {kind: max(np.max(np.abs(values)) for name, values in ours.items()
                            if name.startswith("pelvis") and name.endswith(kind)) for kind in ("force", "moment")}
        worst = {}
        for name, values in ours.items():
            if name == "time":
                continue
            again = np.interp(ours["time"], theirs["time"], theirs[name])
            middle = slice(len(values) // 10, -len(values) // 10)
            scale = pelvis[name.rsplit("_", 1)[1]] if name.startswith("pelvis") else max(np.max(np.abs(values)), 0.1)
            worst[name] = np.max(np.abs(values - again)[middle]) / scale
        print("\n".join(f"{name}: {100 * share:.3f} %" for name, share in worst.items()))
        self.assertLess(max(worst.values()), 0.01)


if __name__ == "__main__":
    unittest.main(verbosity=2)
