"""Types, as a checker sees them."""

import subprocess
import sys
from pathlib import Path

import pytest


def test_types_of_calls_are_what_they_return(tmp_path):
    pytest.importorskip("mypy")
    calls = Path(__file__).with_name("typed_calls.py")
    line = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", tmp_path, calls]
    # Elsewhere than here, so that the installed package is checked, not its source.
    done = subprocess.run(line, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
