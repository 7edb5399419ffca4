"""The command line: ``python -m meshlod``."""

import sys

from . import _native


def main() -> int:
    """Runs the command with the arguments of the process, and returns its exit code."""
    return _native.run_command(["meshlod", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
