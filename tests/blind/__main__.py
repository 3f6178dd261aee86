"""`python -m tests.blind`: runs the blind set and writes docs/reference/blind-results.md."""

import sys

from tests.blind.run import main

if __name__ == "__main__":
    sys.exit(main())
