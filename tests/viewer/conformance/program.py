"""Starts `predictor run` as in a terminal and requests Foxglove's address at its console.

As a program, program.py PREDICTOR COMMAND... also runs COMMAND, with FOXGLOVE_URL in its environment.
"""

import os
import pathlib
import pty
import re
import signal
import subprocess
import sys
import threading

SCENARIO = pathlib.Path(__file__).resolve().parents[3] / "scenarios" / "box_9kg.yaml"
PATIENCE = 60  # limit until a line appears [s]; generous, because these tests do not check speed


class Predictor:
    """A run, with `foxglove_url` as the address for a Foxglove client."""

    def __init__(self, binary, *options):
        self._terminal, slave = pty.openpty()
        self._process = subprocess.Popen(
            [binary, "run", str(SCENARIO), "--port", "0", "--no-record", *options],
            stdin=slave, stdout=slave, stderr=slave, start_new_session=True)
        os.close(slave)
        self._text = ""
        self._ended = False
        self._more = threading.Condition()
        threading.Thread(target=self._read, daemon=True).start()
        try:
            self._await(r"Viewer: (http\S+)")
            self._await(r"\bRUN\b")
            os.write(self._terminal, b"foxglove\n")
            self.foxglove_url = self._await(r"Foxglove: (ws\S+)")
        except BaseException:
            self.close()
            raise

    def _read(self):
        while True:
            try:
                part = os.read(self._terminal, 4096)
            except OSError:  # the other end has closed
                part = b""
            with self._more:
                self._text += part.decode(errors="replace")
                self._ended = not part
                self._more.notify_all()
            if not part:
                return

    def _await(self, pattern):
        found = None

        def there():
            nonlocal found
            found = re.search(pattern, self._text)
            return found or self._ended

        with self._more:
            self._more.wait_for(there, PATIENCE)
        if not found:
            raise RuntimeError(f"predictor did not print {pattern}, but:\n{self._text}")
        return found.group(found.lastindex or 0)

    def close(self):
        """Ends it as Ctrl-C does and returns its exit code."""
        self._process.send_signal(signal.SIGINT)
        try:
            return self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


if __name__ == "__main__":
    with Predictor(sys.argv[1]) as predictor:
        code = subprocess.call(sys.argv[2:], env=os.environ | {"FOXGLOVE_URL": predictor.foxglove_url})
    sys.exit(code)
