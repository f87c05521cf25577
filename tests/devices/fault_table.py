#!/usr/bin/env python3
"""Creates the table of docs/developer/faults.md from the output of the fault bench.

    ./dev soak faults | tests/devices/fault_table.py > table.md

The numbers are the worst of all seeds, one for each rig in the order of the runs.
"""
import re
import sys

RIG = re.compile(r'(?:\d+: )?([\w ]+): (\d+) runs$')
ROW = re.compile(r'(?:\d+: )? ?(\d+)  (.{50}) (continues|warned|holds|power off|refused|arms stop|ends well)\s*(.*)$')
STOP = re.compile(r'detected after +(-?\d+) of +(\d+) ticks; .* at rest after +(\d+) ms, +([\d.]+) mm; '
                  r'apart ([\d.]+) mm, ([\d.]+) deg[^;]*(?:; power-off requested after (\d+) of)?')

# The names of faults and outcomes begin like this, and the page shows these words. The names
# themselves seed random numbers.
PAGE = {
    "joints that are no numbers any more": "joint positions that are not numbers",
    "the arm's last package for ever": "the arm repeats its last package",
    "the arm's last state for ever": "the arm repeats its last state",
    "sequences come round to zero": "sequence numbers wrap around to zero",
    "sensor's datagrams twice": "sensor's datagrams duplicated",
    "arm's states twice": "arm's states duplicated",
    "sensor's datagrams cut": "sensor's datagrams truncated",
    "a tenth of the sensor's datagrams cut": "a tenth of the sensor's datagrams truncated",
    "a tenth of the arm's states cut": "a tenth of the arm's states truncated",
    "stream cut at every byte": "stream split at every byte",
    "arm silent: no state to answer": "arm silent, so no state to answer",
    "arm's own wrench not a number": "arm's own wrench is not a number",
    "the simulation's state not a number": "the simulation's state is not a number",
    "the solver's solution not a number": "the solver's solution is not a number",
    "the solver comes to its limit of iterations": "the solver reaches its iteration limit",
    "a cobot as stiff as can be written": "a cobot with the greatest permitted stiffness",
    "a cobot that swings more and more (growing cycles)": "a cobot whose oscillation grows",
    "starts with the elbows too near": "the run starts with the elbows too close together",
    "starts beyond a joint's limit": "the run starts beyond a joint limit",
    "60 N on a handle, own estimate": "60 N on a handle, arm's own estimate",
    "60 N on a handle, own sensor": "60 N on a handle, arm's own sensor",
    "a sensor turned, swapped or mirrored: pushes": "a sensor rotated, swapped or mirrored, with push test",
    "both sensors mirrored, pushes not tested": "both sensors mirrored, without push test",
    "an arm that lags by another 10 ms, stopped": "stop of an arm that lags by a further 10 ms",
    "RTDE of another version": "unsupported version of RTDE",
    "FCI of another version": "unsupported version of FCI",
    "each fiftieth deadline missed": "every fiftieth deadline missed",
    "states late by 12 ms: no command comes in time": "states late by 12 ms, so no command is in time",
    "states late by 1 ms: each command is too late": "states late by 1 ms, so every command is too late",
    "ends well": "ends safely",
}


def on_page(name):
    return next((words for beginning, words in PAGE.items() if name.startswith(beginning)), name)


def read(lines):
    rigs, rows = [], {}
    for line in lines:
        rig, row = RIG.match(line.rstrip()), ROW.match(line.rstrip())
        if rig:
            rigs.append(rig.group(1))
        elif row and rigs:
            number, name, follows, rest = row.groups()
            stop = STOP.match(rest)
            key = (int(number), name.strip(), follows)
            rows.setdefault(key, {})[rigs[-1]] = [x or '–' for x in stop.groups()] if stop else []
    return rigs, rows


def cell(values, rigs, i):
    """Returns the values of all rigs, or a single one if they are equal."""
    each = [values[r][i] if values.get(r) else '–' for r in rigs]
    if all(x == '–' for x in each):
        return ''
    return each[0] if len(set(each)) == 1 else ' / '.join(each)


def main():
    rigs, rows = read(sys.stdin)
    if not rows:
        sys.exit('no rows were found: pipe the output of `./dev soak faults` in here')
    print('Rigs: %s.\n' % ' / '.join(rigs))
    print('| # | fault | what follows | detected after [ticks] | at most [ticks] | at rest after [ms] | path [mm] | moved apart [mm] | rotated [°] | power off after [ticks] |')
    print('|---|---|---|---|---|---|---|---|---|---|')
    for (number, name, follows), values in sorted(rows.items(), key=lambda row: row[0][0]):
        cells = [cell(values, rigs, i) for i in range(7)]
        print('| %d | %s | %s | %s |' % (number, on_page(name), on_page(follows), ' | '.join(cells)))


if __name__ == '__main__':
    main()
