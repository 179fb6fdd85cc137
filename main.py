"""Morpho Studio from a checkout: `python main.py` opens the window, `python main.py VERB` works headless."""

import sys

from studio.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
