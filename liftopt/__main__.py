"""``python -m liftopt`` is the command ``liftopt``."""

import sys

from liftopt.cli import main

sys.exit(main())
