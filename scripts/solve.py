"""Solve one lift: ``python scripts/solve.py ARGS`` is ``liftopt solve ARGS``."""

import sys

from liftopt.commands.cli import main

if __name__ == "__main__":
    sys.exit(main(["solve", *sys.argv[1:]]))
