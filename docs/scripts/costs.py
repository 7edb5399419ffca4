"""Measures what every verb costs on samples of growing size, and prints tables in Markdown.

Usage: python3 docs/scripts/costs.py MESHLOD [FACES …] [--verbs NAME …] [--threads N …]

The first table has CPU seconds (user and system) on one thread, and seconds per million faces in
brackets, by verb and size. With --threads, a second table has wall and CPU seconds of the largest size
for each number of threads. A run is given up after LIMIT seconds of CPU.
"""

import argparse
import os
import resource
import struct
import subprocess
import sys
import tempfile
import time

LIMIT = 120
SAMPLES = ["gyroid", "plate"]
VERBS = {
    "info": ["info", "{in}"],
    "check": ["check", "{in}"],
    "repair": ["repair", "{in}", "{out}.ply"],
    "repair --fuse": ["repair", "{two}", "{out}.ply", "--fuse"],
    "simplify": ["simplify", "{in}", "{tenth}", "--ratio", "10%"],
    "simplify, qem": ["simplify", "{in}", "{out}.ply", "--ratio", "10%", "--method", "qem"],
    "lods": ["lods", "{in}", "{out}.glb"],
    "compare": ["compare", "{in}", "--out", "{out}-page", "--ratio", "10%", "--methods",
                "lindstrom-turk,qem"],
    "build": ["build", "{in}", "{out}.mlod"],
    "extract": ["extract", "{out}.mlod", "{out}.ply", "--error", "0.1%"],
    "strip": ["strip", "{in}"],
    "compress, blocks": ["compress", "{in}", "{out}.mlq"],
    "decompress, blocks": ["decompress", "{out}.mlq", "{out}.ply"],
    "compress, lattice": ["compress", "{in}", "{out}.mlq", "--scheme", "lattice"],
    "decompress, lattice": ["decompress", "{out}.mlq", "{out}.ply"],
    "compress, parts": ["compress", "{in}", "{out}.mlq", "--scheme", "parts"],
    "decompress, parts": ["decompress", "{out}.mlq", "{out}.ply"],
    "compress, mlz": ["compress", "{in}", "{out}.mlz"],
    "decompress, mlz": ["decompress", "{out}.mlz", "{out}.ply"],
    "measure": ["measure", "{in}", "{tenth}"],
    "render": ["render", "{in}", "{out}.png"],
}


def run(command):
    """Wall and CPU seconds of a command; None if it failed or took longer than LIMIT."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT))
    start = time.monotonic()
    child = subprocess.Popen(
        command, preexec_fn=limit, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    error = child.stderr.read()
    _, status, usage = os.wait4(child.pid, 0)
    wall = time.monotonic() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    # check answers 1 where it found something.
    if child.returncode < 0 or child.returncode > 1 or (child.returncode == 1 and error):
        print(" ".join(command), child.returncode, error.strip(), file=sys.stderr)
        return None
    return wall, usage.ru_utime + usage.ru_stime


def write_two(path, out):
    """Writes two copies of a sample, the second shifted so that they intersect."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    words = data[:end].split()
    vertices, faces = (int(words[words.index(what) + 1]) for what in (b"vertex", b"face"))
    split = end + 12 * vertices
    floats = list(struct.unpack(f"<{3 * vertices}f", data[end:split]))
    corners = [corner for corner in struct.iter_unpack("<Biii", data[split:split + 13 * faces])]
    floats += [x + (0.31, 0.17, 0.07)[k % 3] for k, x in enumerate(floats)]
    corners += [(n, a + vertices, b + vertices, c + vertices) for n, a, b, c in corners]
    header = data[:end].replace(b"vertex %d" % vertices, b"vertex %d" % (2 * vertices))
    header = header.replace(b"face %d" % faces, b"face %d" % (2 * faces))
    with open(out, "wb") as file:
        file.write(header + struct.pack(f"<{len(floats)}f", *floats))
        file.write(b"".join(struct.pack("<Biii", *corner) for corner in corners))


def prepare(meshlod, name, sample, count, verbs):
    """Writes a sample, and two of half the size that intersect where they are needed."""
    write = lambda path, faces: subprocess.run(
        [meshlod, "sample", sample, path, "--faces", str(faces)], check=True,
        stdout=subprocess.DEVNULL)
    write(f"{name}.ply", count)
    if "repair --fuse" in verbs:
        write(f"{name}-half.ply", count // 2)
        write_two(f"{name}-half.ply", f"{name}-two.ply")


def command_for(meshlod, verb, name, threads):
    fill = {"{in}": f"{name}.ply", "{two}": f"{name}-two.ply", "{out}": f"{name}-out",
            "{tenth}": f"{name}-tenth.ply"}
    arguments = VERBS[verb]
    for mark, path in fill.items():
        arguments = [argument.replace(mark, path) for argument in arguments]
    return [meshlod, *arguments, "--threads", str(threads)]


def print_head(columns):
    print("| | " + " | ".join(columns) + " |")
    print("|---|" + "--:|" * len(columns), flush=True)


def print_costs(meshlod, folder, verbs, columns):
    print_head([f"{sample} {count:,}" for sample, count in columns])
    for verb in verbs:
        cells = []
        for sample, count in columns:
            took = run(command_for(meshlod, verb, f"{folder}/{sample}{count}", 1))
            cells.append(f"{took[1]:.2f} ({took[1] / count * 1e6:.1f})" if took else f"> {LIMIT}")
        print(f"| {verb} | " + " | ".join(cells) + " |", flush=True)


def print_threads(meshlod, folder, verbs, count, threads):
    columns = [(sample, number) for sample in SAMPLES for number in threads]
    print()
    print_head([f"{sample} {count:,}, {number} threads" for sample, number in columns])
    for verb in verbs:
        cells = []
        for sample, number in columns:
            took = run(command_for(meshlod, verb, f"{folder}/{sample}{count}", number))
            cells.append(f"{took[0]:.2f} / {took[1]:.2f}" if took else f"> {LIMIT}")
        print(f"| {verb} | " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("meshlod")
    parser.add_argument("faces", type=int, nargs="*", default=[10_000, 100_000, 1_000_000])
    parser.add_argument("--verbs", nargs="+", choices=VERBS, default=list(VERBS))
    parser.add_argument("--threads", type=int, nargs="+", default=[])
    options = parser.parse_args()
    columns = [(sample, count) for sample in SAMPLES for count in options.faces]
    with tempfile.TemporaryDirectory() as folder:
        for sample, count in columns:
            prepare(options.meshlod, f"{folder}/{sample}{count}", sample, count, options.verbs)
        print_costs(options.meshlod, folder, options.verbs, columns)
        if options.threads:
            count = max(options.faces)
            print_threads(options.meshlod, folder, options.verbs, count, options.threads)


if __name__ == "__main__":
    main()
