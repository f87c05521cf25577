#!/usr/bin/env python3
"""Appends the long runs of `./dev soak` to the record that the documentation shows.

  record.py RECORD COMMIT JUNIT   adds a row for each test in ctest's JUnit file

A row contains the date, the commit (with a + if the sources differ from it), the test, the count, the
seconds and the result. Counts are the lines "soak: count=N" that tests/support/soak.h prints in full runs.
"""
import csv
import datetime
import pathlib
import re
import sys
import xml.etree.ElementTree as xml

COLUMNS = ['date', 'commit', 'test', 'count', 'seconds', 'result']
RESULTS = {'run': 'passed', 'fail': 'failed', 'notrun': 'skipped', 'disabled': 'skipped'}


def rows(junit, commit, date):
    """Returns one row for each test case."""
    for case in xml.parse(junit).getroot().iter('testcase'):
        output = case.findtext('system-out') or ''
        counts = dict.fromkeys(re.findall(r'^soak: count=(\d+)', output, re.MULTILINE))
        result = RESULTS.get(case.get('status'), case.get('status'))
        if case.find('skipped') is not None:
            result = 'skipped'
        yield [date, commit, case.get('name'), ' '.join(counts) or '-',
               str(round(float(case.get('time') or 0))), result]


def main(record, commit, junit):
    path = pathlib.Path(record)
    new = not path.exists()
    with path.open('a', newline='') as file:
        writer = csv.writer(file, lineterminator='\n')
        if new:
            writer.writerow(COLUMNS)
        writer.writerows(rows(junit, commit, datetime.date.today().isoformat()))


if __name__ == '__main__':
    main(*sys.argv[1:])
