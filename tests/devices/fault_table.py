#!/usr/bin/env python3
"""Creates the table of docs/developer/faults.md from the output of the fault bench.

    ./dev soak faults | tests/devices/fault_table.py > table.md

The numbers are the worst of all seeds, one for each rig in the order of the runs.
"""
import re
import sys

RIG = re.compile(r'(?:\d+: )?([\w ]+): (\d+) runs$')
ROW = re.compile(r'(?:\d+: )? ?(\d+)  (.{50}) (goes on|warned|holds|power off|refused|arms stop|ends well)\s*(.*)$')
STOP = re.compile(r'seen after +(-?\d+) of +(\d+) ticks; .* at rest after +(\d+) ms, +([\d.]+) mm; '
                  r'apart ([\d.]+) mm, ([\d.]+) deg[^;]*(?:; power off asked for after (\d+) of)?')


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
    """The values of all rigs, or a single one if they are equal."""
    each = [values[r][i] if values.get(r) else '–' for r in rigs]
    if all(x == '–' for x in each):
        return ''
    return each[0] if len(set(each)) == 1 else ' / '.join(each)


def main():
    rigs, rows = read(sys.stdin)
    if not rows:
        sys.exit('no rows were found: pipe the output of `./dev soak faults` in here')
    print('Rigs: %s.\n' % ' / '.join(rigs))
    print('| # | fault | what follows | seen after [ticks] | at most | at rest after [ms] | way [mm] | apart [mm] | turned [°] | power off after [ticks] |')
    print('|---|---|---|---|---|---|---|---|---|---|')
    for (number, name, follows), values in sorted(rows.items(), key=lambda row: row[0][0]):
        cells = [cell(values, rigs, i) for i in range(7)]
        print('| %d | %s | %s | %s |' % (number, name, follows, ' | '.join(cells)))


if __name__ == '__main__':
    main()
