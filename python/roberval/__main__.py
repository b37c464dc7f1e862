"""`python -m roberval` is the `roberval` command."""

import sys

from .command import main

sys.exit(main())
