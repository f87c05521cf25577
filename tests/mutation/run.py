#!/usr/bin/env python3
"""Builds each mutant of mutants.txt in a copy of the sources and reports the mutants that no test detects.

run.py SOURCE BUILD [PART]: SOURCE is the checkout. BUILD is a folder for the copy, its build and the results,
which are kept so that an interrupted run can be continued. A mutant is tried again if its file has changed, and a
surviving mutant also if any test has changed. PART: only mutants of files whose names contain it.
Exits 1 if fewer than 90 % are detected.
run.py SOURCE: only checks that the original text of each mutant occurs exactly once in its file.
"""
import hashlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
import time

WANTED = 0.9
# The tests that judge a safety condition, by the beginning of the mutated file's name: test
# programs and a selection of their tests, with the quick ones first. Runs of several minutes detect
# no more mutants than short ones.
EMULATOR = ('test_emulator', '-Accuracy*:*Soak*:Verify*:Hands.*:Buttons.*')
JUDGES = {
    'apps/': [('test_machine', 'PushTests*:MachineOption*:ProcessFault.WithoutRealTime*')],
    'apps/predictor/raw_keys': [('test_machine', 'RigsConsole*')],
    'apps/predictor/rig_console': [('test_machine', 'RigsConsole*')],
    'src/commissioning/': [('test_commissioning', 'Push*:Payload*:TestPushes*:*MeasureLoop*:MotionWatch*:SwingFile*:SessionPace*:'
                                               'KinematicsRefusal*:Station*')],
    'src/core/rest_detector': [('test_safety', '*Stop*'), EMULATOR],
    'src/core/held_key': [('test_core', 'HeldKey*')],
    'src/core/': [('test_safety', '*StateMachine*'), ('test_watchdog', '*')],
    'src/devices/franka/': [('test_devices', '*Franka*-*Faults*:*Normal*'), ('test_devices', '*Faults.AreSeen*')],
    'src/devices/net_ft/': [('test_devices', 'Rdt*:NetFt*'), ('test_devices', '*Faults.AreSeen*')],
    'src/devices/ur/': [('test_devices', '*Ur*:Rtde*:DeviceClock*-*Faults*:*Normal*'), ('test_devices', 'Loop*:*Faults.AreSeen*')],
    'src/devices/wire/': [('test_devices', 'Sockets*:DeviceClock*:NetFt*')],
    'src/devices/': [('test_devices', 'Real*:Stop*:Connect*:FaultLatch*'), ('test_devices', '*Enabling*:Taped*:Loop*'),
                     ('test_devices', '*Faults.AreSeen*')],
    'src/emulator/': [('test_emulator', 'Supervisor*:RealSupervisor*'), ('test_devices', '*Enabling*:Taped*'), EMULATOR],
    'src/haptics/': [('test_haptics', 'Recovery*:RelativePose*'), EMULATOR],
    'src/safety/': [('test_safety', '-*Allocation*:Oscillation*:Guard.*'), EMULATOR,
                    ('test_devices', '*Faults.AreSeen*')],
    'src/safety/guard': [('test_safety', 'Guard*'), EMULATOR],
    'src/safety/oscillation': [('test_safety', 'Oscillation*'), EMULATOR],
    'src/safety/vibration': [('test_safety', 'Vibration*'), EMULATOR],
    'src/scenario/': [('test_scenario', 'Machine*:ApplyMachine*'), ('test_commissioning', 'MachineFile*')],
    'src/watchdog/': [('test_watchdog', '*')],
}

# The compiler must not refuse a mutant because it leaves something unused.
UNUSED = ''.join(f'#pragma GCC diagnostic ignored "-Wunused-{what}"\n' for what in (
    'variable', 'const-variable', 'but-set-variable', 'parameter', 'but-set-parameter', 'function'))


def mutants(source):
    for line in (source / 'tests/mutation/mutants.txt').read_text().splitlines():
        if line and not line.startswith('#'):
            file, old, new = (part.strip() for part in (line + ' ').split(' | '))
            yield file, old.replace(' or ', ' || '), new.replace(' or ', ' || ')


def judges(file):
    return next(JUDGES[folder] for folder in sorted(JUDGES, key=len, reverse=True) if file.startswith(folder))


def misplaced(source):
    """Returns an error for each mutant whose original text does not occur exactly once in its file."""
    for file, old, _ in mutants(source):
        count = (source / file).read_text().count(old) if (source / file).exists() else 0
        if count != 1:
            yield f'{file}: "{old}" occurs {count} times instead of once. Correct mutants.txt.'


def hash_of(*texts):
    return hashlib.sha256('\0'.join(texts).encode()).hexdigest()


def copy(source, folder):
    """Copies the changed files, with the present time so that the build sees them, and removes deleted sources."""
    listed = subprocess.run(['git', 'ls-files', '-co', '--exclude-standard'], cwd=source, text=True,
                            capture_output=True, check=True).stdout.split('\n')
    files = [name for name in listed if name and (source / name).is_file()]
    for name in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if not (folder / name).exists() or (folder / name).read_bytes() != (source / name).read_bytes():
            shutil.copy(source / name, folder / name)
    for path in [*(folder / 'src').rglob('*'), *(folder / 'tests').rglob('*')]:
        if path.suffix in ('.cpp', '.h') and str(path.relative_to(folder)) not in files:
            path.unlink()
    for name in ('.deps', 'web/dist'):
        if not (folder / name).exists():
            (folder / name).symlink_to(source / name)


class Copy:
    """A separate copy of the sources with its build."""

    def __init__(self, source, folder):
        self.folder, self.usual = folder, {}  # duration of each program without a mutant [s]
        folder.mkdir(parents=True, exist_ok=True)
        copy(source, folder)
        # The path is the same as in the checkout, so that both share the compiler cache.
        self.built = folder / 'build/release'
        subprocess.run(['cmake', '--preset', 'release'], cwd=folder, check=True, capture_output=True)

    def build(self, *programs):
        return subprocess.run(['ninja', '-C', self.built, *programs], capture_output=True,
                              text=True)

    def run(self, program, tests):
        """Returns whether the tests pass, or None if they do not end. They are distributed over all processors."""
        command = [self.built / 'bin' / program, '--gtest_brief=1', '--gtest_fail_fast',
                   '--gtest_filter=' + tests]
        start, shards = time.monotonic(), os.cpu_count()
        limit = start + 60 + 10 * self.usual.get((program, tests), 60)
        running = [subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                    env={**os.environ, 'GTEST_TOTAL_SHARDS': str(shards),
                                         'GTEST_SHARD_INDEX': str(shard)}) for shard in range(shards)]
        passed = True
        while running and passed:
            time.sleep(0.02)
            passed = not any(process.poll() for process in running)
            running = [process for process in running if process.poll() is None]
            if passed and time.monotonic() > limit:
                passed = None
        for process in running:
            process.kill()
            process.wait()
        if passed:
            self.usual.setdefault((program, tests), time.monotonic() - start)
        return passed

    def detected(self, file):
        """Returns the test program that detects the change of `file`, or None if no test does or the change does
        not compile."""
        for program, tests in judges(file):
            if (built := self.build(program)).returncode != 0:
                print('DOES NOT COMPILE. Correct mutants.txt.\n' + built.stdout[-2000:])
                return None
            passed = self.run(program, tests)
            # the computer may have been busy for once
            if passed is None and (passed := self.run(program, tests)) is None:
                return program + ', which hung'
            if not passed:
                return program
        return None


def check_unchanged(work, files):
    """Checks that the tests build and pass without a mutant; otherwise they would detect every mutant."""
    used = {judge: None for file in files for judge in judges(file)}
    built = work.build(*{program for program, _ in used})
    if built.returncode != 0:
        sys.exit('The tests do not build without any mutant:\n' + built.stdout[-4000:])
    for program, tests in used:
        if not work.run(program, tests):
            sys.exit(f'{program} --gtest_filter={tests} fails without any mutant')


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    if wrong := list(misplaced(source)):
        sys.exit('\n'.join(wrong))
    if len(sys.argv) == 2:
        return 0
    folder = pathlib.Path(sys.argv[2]).resolve()
    part = sys.argv[3] if len(sys.argv) > 3 else ''
    wanted = sorted((m for m in mutants(source) if part in m[0]), key=lambda m: m[0])
    if not wanted:
        sys.exit(f'No mutant changes a file whose name contains "{part}"')
    work = Copy(source, folder)
    tests = hash_of(*(path.read_text() for path in sorted((source / 'tests').rglob('*.cpp'))))
    kept_in = folder / 'results.json'
    kept = json.loads(kept_in.read_text()) if kept_in.exists() else {}
    texts = {file: (source / file).read_text() for file, _, _ in wanted}
    new = []
    for file, old, by in wanted:
        key = hash_of(file, old, by, texts[file])
        result = kept.get(key)
        if result is None or (not result['by'] and result['tests'] != tests):
            new.append(key)
    if new:
        check_unchanged(work, {file for file, _, _ in wanted})
    survivors = []
    for number, (file, old, by) in enumerate(wanted, 1):
        text = texts[file]
        key = hash_of(file, old, by, text)
        if key in new:
            start = time.monotonic()
            (folder / file).write_text(UNUSED + text.replace(old, by))
            kept[key] = {'by': work.detected(file), 'tests': tests}
            (folder / file).write_text(text)
            kept_in.write_text(json.dumps(kept, indent=0))
            print(f'{number:3}  {"detected by " + kept[key]["by"] if kept[key]["by"] else "SURVIVES":30} '
                  f'{time.monotonic() - start:4.0f} s  {file}: {old}  →  {by or "(nothing)"}', flush=True)
        if not kept[key]['by']:
            survivors.append((file, old, by))
    print(f'\n{len(wanted) - len(survivors)} of {len(wanted)} detected '
          f'({100 * (1 - len(survivors) / len(wanted)):.0f} %)')
    for file, old, by in survivors:
        print(f'  survives: {file}: {old}  →  {by or "(nothing)"}')
    return 0 if len(survivors) <= (1 - WANTED) * len(wanted) else 1


if __name__ == '__main__':
    sys.exit(main())
