"""The command: deploy/test-hold has its help."""

import pathlib
import sys

from hold.suite import Suite, main

SCENARIOS = ("soak", "stalled", "memory", "descriptors", "kills", "corruption", "disk-full", "authorisation", "hostile")

if __name__ == "__main__":
    sys.exit(main(Suite("test-hold", SCENARIOS, pathlib.Path(__file__).parent, has_hours=True), sys.argv[1:]))
