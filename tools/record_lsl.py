#!/usr/bin/env python3
"""Records streams of the Lab Streaming Layer (head, elbows, EMG, heart rate, ...) as tables for `predictor evaluate`.

For each stream it writes NAME.csv and the mapping NAME.yaml, which `predictor evaluate RECORDING --track NAME.yaml`
takes. Times are seconds since 1970 by this computer's clock: LSL relates the clocks of the senders to it, and a
recording of the emulator on the same computer has the same clock. Channels of irregular streams keep their own times.

Needs the package pylsl (deps/tracks.txt). Ends after --seconds, or at Ctrl+C.
"""

import argparse
import csv
import re
import sys
import time
from pathlib import Path

import pylsl

RESOLVE = 5.0  # time for which it looks for a stream [s]
UNITS = {"microvolts": "µV", "millivolts": "mV", "volts": "V", "meters": "m", "millimeters": "mm"}


def labels_of(info):
    """Returns the names and units of a stream's channels from its description."""
    labels = []
    channel = info.desc().child("channels").child("channel")
    for i in range(info.channel_count()):
        label = channel.child_value("label") or f"{info.name()}{i + 1}"
        unit = channel.child_value("unit")
        labels.append((label, UNITS.get(unit, unit)))
        channel = channel.next_sibling()
    return labels


def unix_minus_lsl():
    """Returns the difference of the clocks [s], from the closest of several pairs of readings."""
    pairs = []
    for _ in range(20):
        before = pylsl.local_clock()
        now = time.time()
        after = pylsl.local_clock()
        pairs.append((after - before, now - (before + after) / 2))
    return min(pairs)[1]


class Recorded:
    """A stream and its files."""

    def __init__(self, name, folder):
        found = pylsl.resolve_byprop("name", name, timeout=RESOLVE) or pylsl.resolve_byprop("type", name, timeout=RESOLVE)
        if not found:
            sys.exit(f"record_lsl: no stream has the name or type {name!r}. Start it first, in the same network.")
        if len(found) > 1:
            sys.exit(f"record_lsl: {len(found)} streams match {name!r}. Give the name of one.")
        self.inlet = pylsl.StreamInlet(found[0], max_buflen=60,
                                       processing_flags=pylsl.proc_clocksync | pylsl.proc_monotonize)
        info = self.inlet.info(timeout=RESOLVE)
        if info.channel_format() == pylsl.cf_string:
            sys.exit(f"record_lsl: {name!r} has words, not numbers.")
        self.stem = folder / re.sub(r"[^A-Za-z0-9_-]+", "_", info.name())
        self.labels = labels_of(info)
        self.type = info.type()
        self.samples = 0
        self.corrections = [self.inlet.time_correction(timeout=RESOLVE)]
        self.file = open(self.stem.with_suffix(".csv"), "w", newline="", encoding="utf-8")
        self.rows = csv.writer(self.file)
        self.rows.writerow(["time [s]"] + [f"{label} [{unit}]" if unit else label for label, unit in self.labels])
        self.inlet.open_stream(timeout=RESOLVE)

    def take(self, offset):
        values, stamps = self.inlet.pull_chunk(timeout=0.0, max_samples=4096)
        for row, stamp in zip(values, stamps):
            self.rows.writerow([f"{stamp + offset:.6f}"] + [f"{x:.9g}" for x in row])
        self.samples += len(stamps)

    def close(self):
        self.corrections.append(self.inlet.time_correction(timeout=RESOLVE))
        self.inlet.close_stream()
        self.file.close()
        parts = {label.rsplit(".", 2)[0] for label, _ in self.labels if label.endswith((".p.x", ".p.y", ".p.z"))}
        lines = [f"file: {self.stem.name}.csv", "clock: unix"]
        for part in sorted(parts & {"head", "left_elbow", "right_elbow", "left_hand", "right_hand"}):
            lines += [f"{part}:", f"  position: [{part}.p]"]
            if any(label == f"{part}.q.w" for label, _ in self.labels):
                lines.append(f"  rotation: [{part}.q]")
        if self.type.upper() == "EMG":
            lines += ["# Name the muscles, give the envelope of a maximum voluntary contraction, and remove the signs #:",
                      "# emg:"]
            lines += [f"#   - {{channel: \"{label}\", arm: right, muscles: [], mvc: }}" for label, _ in self.labels]
        others = [label for label, _ in self.labels if label.split(".")[0] not in parts]
        if others:
            lines.append("series:")
            lines += [f"  - {{name: \"{label}\", channel: \"{label}\"}}" for label in others]
        self.stem.with_suffix(".yaml").write_text("\n".join(lines) + "\n", encoding="utf-8")
        drift = 1e3 * (self.corrections[-1] - self.corrections[0])
        print(f"{self.stem}.csv: {self.samples} samples; the sender's clock drifted by {drift:+.2f} ms.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("streams", nargs="+", help="names or types of streams, for example EMG")
    parser.add_argument("-o", "--output", type=Path, default=Path("."), help="folder to write to")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="how long to record")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    streams = [Recorded(name, options.output) for name in options.streams]
    offset, end = unix_minus_lsl(), time.monotonic() + options.seconds
    print("Recording. Ctrl+C ends it.", flush=True)
    try:
        while time.monotonic() < end:
            for stream in streams:
                stream.take(offset)
            time.sleep(0.02)
    except KeyboardInterrupt:
        pass
    for stream in streams:
        stream.take(offset)
        stream.close()
    drift = 1e3 * (unix_minus_lsl() - offset)
    if abs(drift) > 1:
        print(f"This computer's clock of the day was changed by {drift:+.1f} ms meanwhile. The times keep the start's.")


if __name__ == "__main__":
    main()
