"""The command: deploy/test-cluster has its help."""

import pathlib
import sys

from hold.suite import Suite, main

SCENARIOS = ("keys", "kills", "drains", "proxy", "stalled", "start", "store")

if __name__ == "__main__":
    sys.exit(main(Suite("test-cluster", SCENARIOS, pathlib.Path(__file__).parent), sys.argv[1:]))
