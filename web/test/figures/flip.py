"""Prints the bytes after which a stream looks as in the end: flip.py FOLDER [MOST].

The folder has pictures NUMBER-BYTES.png; FLIP of those from there on is at most MOST, .05 by default.
"""

import pathlib
import sys

import flip_evaluator
import numpy as np
from PIL import Image


def picture(path):
    """Returns a picture as numbers up to 1."""
    return np.asarray(Image.open(path).convert("RGB"), np.float32) / 255


paths = sorted(pathlib.Path(sys.argv[1]).glob("*.png"))
most = float(sys.argv[2]) if len(sys.argv) > 2 else 0.05
last = picture(paths[-1])
answer = None
for path in paths:
    flip = float(flip_evaluator.evaluate(last, picture(path), "LDR")[1])
    size = int(path.stem.split("-")[1])
    print(f"{size} bytes: {flip:.4f}", file=sys.stderr)
    answer = None if flip > most else size if answer is None else answer
print(answer)
