"""Play a solved lift in the browser: ``python scripts/play.py ARGS`` is ``liftopt view ARGS``."""

import sys

from liftopt.commands.cli import main

if __name__ == "__main__":
    sys.exit(main(["view", *sys.argv[1:]]))
