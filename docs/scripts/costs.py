"""Measures what every verb costs on samples of growing size, and prints a table in Markdown.

Usage: python3 docs/scripts/costs.py MESHLOD [FACES …]

CPU seconds (user and system) on one thread, and seconds per million faces in brackets. A run is given up
after LIMIT seconds of CPU.
"""

import os
import resource
import subprocess
import sys
import tempfile

LIMIT = 60
SAMPLES = ["gyroid", "plate"]
VERBS = {
    "info": ["info", "{in}"],
    "check": ["check", "{in}"],
    "repair": ["repair", "{in}", "{out}.ply"],
    "simplify": ["simplify", "{in}", "{out}.ply", "--ratio", "10%"],
    "simplify, qem": ["simplify", "{in}", "{out}.ply", "--ratio", "10%", "--method", "qem"],
    "lods": ["lods", "{in}", "{out}.glb"],
    "build": ["build", "{in}", "{out}.mlod"],
    "extract": ["extract", "{out}.mlod", "{out}.ply", "--error", "0.1%"],
    "compress, blocks": ["compress", "{in}", "{out}.mlq"],
    "compress, lattice": ["compress", "{in}", "{out}.mlq", "--scheme", "lattice"],
    "compress, parts": ["compress", "{in}", "{out}.mlq", "--scheme", "parts"],
    "compress, mlz": ["compress", "{in}", "{out}.mlz"],
    "measure": ["measure", "{in}", "{in}"],
    "render": ["render", "{in}", "{out}.png"],
}


def seconds(command):
    """CPU seconds of a command; None if it failed or took longer than LIMIT."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    child = subprocess.Popen(
        command, preexec_fn=limit, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    error = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    # check answers 1 where it found something.
    if child.returncode < 0 or child.returncode > 1 or (child.returncode == 1 and error):
        print(" ".join(command), child.returncode, error.strip(), file=sys.stderr)
        return None
    return usage.ru_utime + usage.ru_stime


def main():
    meshlod, *counts = sys.argv[1:]
    counts = [int(count) for count in counts] or [10_000, 100_000, 1_000_000]
    columns = [(sample, count) for sample in SAMPLES for count in counts]
    print("| | " + " | ".join(f"{sample} {count:,}" for sample, count in columns) + " |")
    print("|---|" + "--:|" * len(columns), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for sample, count in columns:
            path = f"{folder}/{sample}{count}.ply"
            subprocess.run([meshlod, "sample", sample, path, "--faces", str(count)], check=True,
                           stdout=subprocess.DEVNULL)
        for verb, arguments in VERBS.items():
            cells = []
            for sample, count in columns:
                name = f"{folder}/{sample}{count}"
                fill = lambda text: text.replace("{in}", name + ".ply").replace("{out}", name + "-out")
                took = seconds([meshlod, *map(fill, arguments), "--threads", "1"])
                million = f" ({took / count * 1e6:.1f})" if took is not None else ""
                cells.append(f"{took:.2f}{million}" if took is not None else f"> {LIMIT}")
            print(f"| {verb} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
