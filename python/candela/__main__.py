"""`python -m candela` is the program `candela`."""

import sys

from candela import _candela


def main() -> int:
    return _candela.run_program(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
