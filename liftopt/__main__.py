"""``python -m liftopt`` is the command ``liftopt``."""

import sys

from liftopt.commands.cli import main

sys.exit(main())
