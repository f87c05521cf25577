"""Tests the recorder of the Lab Streaming Layer with a stream that another process sends with liblsl."""

import csv
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]

# This process sends the time of day with each sample, so that the recorder's times can be checked.
SENDER = """
import time, pylsl
info = pylsl.StreamInfo("Head tracker", "MoCap", 4, 100, "double64", "made-up")
channels = info.desc().append_child("channels")
for label, unit in (("head.p.x", "m"), ("head.p.y", "m"), ("head.p.z", "m"), ("sent", "s")):
    channel = channels.append_child("channel")
    channel.append_child_value("label", label)
    channel.append_child_value("unit", unit)
outlet = pylsl.StreamOutlet(info)
print("ready", flush=True)
while True:
    outlet.push_sample([0.5, 0.0, 1.6, time.time() % 1000])
    time.sleep(0.01)
"""


class Lsl(unittest.TestCase):
    def test_recorder(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = Path(temporary.name)
        # The streams stay on this machine.
        (folder / "lsl.cfg").write_text("[multicast]\nResolveScope = machine\n[lab]\nKnownPeers = {127.0.0.1}\n")
        environment = dict(os.environ, LSLAPICFG=str(folder / "lsl.cfg"))
        sender = subprocess.Popen([sys.executable, "-c", SENDER], stdout=subprocess.PIPE, text=True, env=environment)
        self.addCleanup(sender.wait)
        self.addCleanup(sender.kill)
        self.addCleanup(sender.stdout.close)
        self.assertEqual(sender.stdout.readline(), "ready\n")
        done = subprocess.run([sys.executable, ROOT / "tools" / "record_lsl.py", "MoCap", "-o", folder, "--seconds", "2"],
                              capture_output=True, text=True, env=environment, timeout=120, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(folder / "Head_tracker.csv", encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        self.assertGreater(len(rows), 100, done.stdout)
        lags = sorted(abs(math.remainder(float(row["time [s]"]) - float(row["sent [s]"]), 1000)) for row in rows)
        self.assertLess(lags[len(lags) // 2], 0.002, "the median of the differences between the clocks")
        self.assertIn("position: [head.p]", (folder / "Head_tracker.yaml").read_text(encoding="utf-8"))
        self.assertIn('channel: "sent"', (folder / "Head_tracker.yaml").read_text(encoding="utf-8"))

    def test_a_missing_stream_is_named(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        config = Path(temporary.name) / "lsl.cfg"
        config.write_text("[multicast]\nResolveScope = machine\n")
        done = subprocess.run([sys.executable, ROOT / "tools" / "record_lsl.py", "No such stream"],
                              capture_output=True, text=True, env=dict(os.environ, LSLAPICFG=str(config)), check=False,
                              cwd=temporary.name)
        self.assertEqual(done.returncode, 1)
        self.assertIn("No such stream", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
