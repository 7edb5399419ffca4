"""Writes every mesh of a folder in its own format, whole and at 10 %, and compares what other
programs find in it: kept.py MESHLOD FOLDER. Ends with 1 if anything differs that is not listed.

Needs trimesh and pymeshlab. Meshes that are not there are skipped with a word.
"""

import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from facts import facts_of
from may_differ import is_allowed

FORMATS = [".ply", ".obj", ".off", ".stl", ".smf", ".gltf", ".glb"]


def main():
    # MeshLab changes the working folder while it reads.
    meshlod, folder = [Path(argument).resolve() for argument in sys.argv[1:3]]
    if not folder.is_dir():
        print(f"skipped: {folder} is not there")
        return 0
    places = [folder, *sorted(place for place in folder.iterdir() if place.name == "flight-helmet")]
    paths = sorted(path for place in places for path in place.iterdir() if path.suffix in FORMATS)
    with tempfile.TemporaryDirectory() as out, ThreadPoolExecutor(2) as pool:
        copies = pool.map(lambda path: copies_of(meshlod, path, Path(out)), paths)
        # The other programs are not run side by side: they are not made for it.
        differences = [line for path, pair in zip(paths, copies) for line in compared(path, pair)]
    for line in differences:
        print(line)
    print(f"{len(paths)} files, whole and at 10 %: {len(differences)} unlisted differences")
    return 1 if differences else 0


def copies_of(meshlod, path, out):
    """Writes the whole file and a tenth of it; returns their paths, or the error of the program."""
    copies = []
    for verb, options in [("convert", []), ("simplify", ["--ratio", "10%"])]:
        place = out / f"{path.stem}-{path.suffix[1:]}-{verb}"
        place.mkdir()
        copy = place / path.name
        command = [meshlod, verb, path, copy, *options]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        copies.append(copy if done.returncode == 0 else done.stderr.strip())
    return copies


def compared(path, copies):
    """Yields a line for each fact of a copy that is not that of the file."""
    facts, sizes = facts_of(path)
    for copy, part, expected in zip(copies, ["whole", "10 %"], [facts | sizes, facts]):
        if isinstance(copy, str):
            yield f"{path.name}, {part}: {copy}"
            continue
        found, found_sizes = facts_of(copy)
        found |= found_sizes
        if part == "10 %" and not 0 < found["faces"] <= sizes["faces"]:
            yield f"{path.name}, {part}: {found['faces']} faces of {sizes['faces']}"
        for fact, value in expected.items():
            if not is_allowed(path.name, part, fact, value, found.get(fact)):
                yield f"{path.name}, {part}: {fact}: {shown(value)} became {shown(found.get(fact))}"


def shown(value):
    text = str(value)
    return text if len(text) < 200 else f"{text[:200]}… ({len(text)} characters)"


if __name__ == "__main__":
    sys.exit(main())
