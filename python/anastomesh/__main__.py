"""``python -m anastomesh`` is the program ``anastomesh``."""

import os
import sys

from ._binary import binary

if __name__ == "__main__":
    program = binary()
    os.execv(program, [program, *sys.argv[1:]])
