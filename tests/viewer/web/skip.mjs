// Skips a single test of a file.

let skipped = false;

// Use this instead of t.skip. Although the other tests of the file ran, ctest then reports that the
// file was skipped (exit code 77), so that the last line of ./dev test counts it. If another test of
// the file fails, the file fails.
export function skipPart(t, reason) {
  if (!skipped) process.on('exit', (code) => { if (code === 0) process.exitCode = 77; });
  skipped = true;
  return t.skip(reason);
}
