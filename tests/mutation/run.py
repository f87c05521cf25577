#!/usr/bin/env python3
"""Builds each mutant of mutants.txt in a copy of the sources and says which ones no test notices.

run.py SOURCE BUILD: SOURCE is the checkout, BUILD a folder for the copy and its build, kept from one
time to the next. Exits 1 if fewer than 90 % are noticed.
run.py SOURCE: only looks whether what each mutant changes still stands there, once.
"""
import pathlib
import shutil
import subprocess
import sys
import time

# Where a safety condition is judged; the quick ones first.
TESTS = ['test_safety', 'test_haptics', 'test_scenario', 'test_watchdog', 'test_emulator']
WANTED = 0.9
# Whole runs of minutes say nothing more of a condition than the short ones do.
FILTER = {'test_emulator': '-Accuracy*:*Soak*:Verify*', 'test_scenario': 'Machine*:ApplyMachine*',
          'test_haptics': 'Recovery*:RelativePose*', 'test_safety': '-*Allocation*'}


def mutants(source):
    for line in (source / 'tests/mutation/mutants.txt').read_text().splitlines():
        if line and not line.startswith('#'):
            file, old, new = (part.strip() for part in (line + ' ').split(' | '))
            yield file, old.replace(' or ', ' || '), new.replace(' or ', ' || ')


def misplaced(source):
    """A line for each mutant whose text does not stand in its file once."""
    for file, old, _ in mutants(source):
        count = (source / file).read_text().count(old)
        if count != 1:
            yield f'{file}: "{old}" stands there {count} times, not once. Mend mutants.txt.'


def build(folder):
    return subprocess.run(['ninja', '-C', folder / 'build', *TESTS], capture_output=True).returncode == 0


def noticed(folder):
    """The first test program that fails, or None."""
    for test in TESTS:
        command = [folder / 'build/bin' / test, '--gtest_brief=1', '--gtest_fail_fast']
        if test in FILTER:
            command.append('--gtest_filter=' + FILTER[test])
        try:
            if subprocess.run(command, capture_output=True, timeout=600).returncode != 0:
                return test
        except subprocess.TimeoutExpired:
            return test + ' (for ever)'
    return None


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    if wrong := list(misplaced(source)):
        sys.exit('\n'.join(wrong))
    if len(sys.argv) == 2:
        return 0
    folder = pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    files = subprocess.run(['git', 'ls-files', '-co', '--exclude-standard'], cwd=source, text=True,
                           capture_output=True, check=True).stdout.split()
    for name in files:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if not (folder / name).exists() or (folder / name).read_bytes() != (source / name).read_bytes():
            shutil.copy2(source / name, folder / name)
    if not (folder / '.deps').exists():
        (folder / '.deps').symlink_to(source / '.deps')
    subprocess.run(['cmake', '--preset', 'dev', '-B', folder / 'build'], cwd=folder, check=True,
                   capture_output=True)
    if not build(folder) or (failed := noticed(folder)):
        sys.exit(f'The tests fail without any mutant: {failed}')
    survivors, total = [], 0
    for file, old, new in mutants(source):
        path = folder / file
        text = path.read_text()
        total += 1
        start = time.monotonic()
        path.write_text(text.replace(old, new))
        by = noticed(folder) if build(folder) else 'compiler'
        path.write_text(text)
        print(f'{total:3}  {"noticed by " + by if by else "SURVIVES":28} {time.monotonic() - start:4.0f} s  '
              f'{file}: {old}  →  {new or "(nothing)"}', flush=True)
        if not by:
            survivors.append((file, old, new))
    print(f'\n{total - len(survivors)} of {total} noticed ({100 * (1 - len(survivors) / total):.0f} %)')
    for file, old, new in survivors:
        print(f'  survives: {file}: {old}  →  {new or "(nothing)"}')
    return 0 if len(survivors) <= (1 - WANTED) * total else 1


if __name__ == '__main__':
    sys.exit(main())
