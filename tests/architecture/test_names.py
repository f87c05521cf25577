"""Checks that test names are readable: every test in a build folder has a name made of words, not of indices or raw bytes.

Usage: test_names.py BUILD
A parameterised test without a name generator is called SUITE.TEST/0; pass one to its INSTANTIATE_TEST_SUITE_P.
"""
import re
import subprocess
import sys

WORDS = re.compile(r"[A-Za-z][\w./-]*(<[\w:, ]+>)?")  # the optional part is a type
INDEX = re.compile(r"/\d+$")


def main():
    listing = subprocess.run(["ctest", "--test-dir", sys.argv[1], "-N"], capture_output=True, text=True, check=True)
    names = re.findall(r"^ *Test +#\d+: (.*?)(?: \(Disabled\))?$", listing.stdout, re.MULTILINE)
    unreadable = [n for n in names if not WORDS.fullmatch(n) or INDEX.search(n)]
    print(f"{len(names)} tests, {len(unreadable)} with an unreadable name", *unreadable, sep="\n  ")
    return 1 if unreadable or not names else 0


if __name__ == "__main__":
    sys.exit(main())
