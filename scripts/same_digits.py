#!/usr/bin/env python3
"""Whether two programs give the same numbers, to the bit. Usage: same_digits.py OLD NEW [INPUT...]

Both run every command that gives numbers on built-in shapes and on the inputs named; numbers are compared as they are
printed, times apart. Names of contract 1 are read as those of contract 2 where OLD still writes them.
"""

import csv
import io
import json
import pathlib
import subprocess
import sys
import tempfile

SHAPES = [
    "phantom:ball?radius=10&shift=0.3,0.2,0.1",
    "phantom:ball?radius=7&spacing=0.8,1,1.5",
    "phantom:ellipsoid?radii=20,14,9&rotate=10,20,30&shift=0.2,0.3,0.4&spacing=0.8,1,1.2",
    "phantom:torus?rotate=-35,10,25&shift=0.3,0.2,0.1&spacing=0.8,0.8,1.2",
    "phantom:capsule?radius=3&length=20&rotate=30,40,50",
    "phantom:rounded-box?rotate=7,0,0",
    "phantom:shell?radius=14&inner=9",
    "phantom:two-balls?radius=9&length=19",
    "phantom:genus?genus=3",
    "phantom:gyroid?period=20&size=40",
    "phantom:schwarz-p?period=24&size=48",
    "phantom:vertebra?individual=3",
]
SETTINGS = [[], ["--paper"], ["--embedding", "corrected", "--sigma", "3"], ["--embedding", "distance"],
            ["--derivatives", "gaussian", "--quadrature", "simpson"], ["--clip", "exclude"], ["--per-component"],
            ["--level", "0.4", "--thickness", "2.5"], ["--explain"]]
NUMBERS = [0]
TIMES = {"seconds", "read_seconds", "version", "schema"}


def run(program, *arguments):
    return subprocess.run([program, "-q", *arguments], capture_output=True, text=True, check=False)


def as_contract_2(record):
    """A record of contract 1 by the names of contract 2, as far as it has them."""
    if "compensated" not in record:
        return record
    names = ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm", "average_mean_curvature_per_mm",
             "total_gaussian_curvature", "euler_characteristic", "total_squared_mean_curvature"]
    plain = {name: record.pop(name) for name in names}
    compensated = record.pop("compensated")
    record["blurred"] = {**plain, "grid_noise": record.pop("grid_noise")}
    record["standard_error"] = compensated.pop("standard_error")
    record.update(compensated)
    sigma = record["parameters"].pop("curvature_sigma_mm", None)
    if sigma is not None:
        record["curvature_sigma_mm"] = sigma
    return record


def differences(old, new, path=""):
    """Where what both have differs. What only the new one has is an addition."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key, value in old.items():
            if key in TIMES or key == "message":
                continue
            if key not in new:
                if value is not None:
                    yield f"{path}.{key} is gone"
                continue
            yield from differences(value, new[key], f"{path}.{key}")
    elif isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            yield f"{path}: {len(old)} and {len(new)} entries"
        for n, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, f"{path}[{n}]")
    else:
        NUMBERS[0] += isinstance(old, (int, float))
        if old != new:
            yield f"{path}: {old!r} and {new!r}"


def compared(title, old, new, told):
    found = list(differences(old, new))
    told[0] += 1
    for line in found[:8]:
        print(f"{title}: {line}", flush=True)
    told[1] += bool(found)


def records(text):
    return [as_contract_2(record) for record in json.loads(text)["results"]] if text.strip() else []


def uncompensated(record):
    """With the paper's settings contract 2 has the blurred numbers in front: they are compared under `blurred`."""
    return {key: value for key, value in record.items()
            if record.get("surface") == "original" or key not in record["blurred"] and key != "standard_error"}


def main():
    old, new, *inputs = sys.argv[1:]
    told = [0, 0]
    for name in [*SHAPES, *inputs]:
        for setting in SETTINGS:
            texts = [run(program, "measure", name, "--format", "json", *setting) for program in (old, new)]
            before, after = (records(done.stdout) for done in texts)
            kept = [set(uncompensated(record)) for record in after]
            before = [{k: v for k, v in r.items() if k in keys} for r, keys in zip(before, kept)] if kept else before
            compared(f"measure {name} {' '.join(setting)}", before, after, told)
        for command in (["reference"], ["sweep", "--range", "1.5:3:3"]):
            before, after = (records(run(program, command[0], name, *command[1:], "--format", "json").stdout)
                             for program in (old, new))
            compared(f"{command[0]} {name}", before, after, told)
        with tempfile.TemporaryDirectory() as folder:
            found = []
            for number, program in enumerate((old, new)):
                stem = pathlib.Path(folder) / str(number)
                files = [f"{stem}.json", f"{stem}.csv", f"{stem}.ply"]
                run(program, "map", name, "--curvature-sigma", "auto", *sum((["-o", f] for f in files), []))
                tables = sorted(pathlib.Path(folder).glob(f"{number}*.csv"))
                meshes = sorted(pathlib.Path(folder).glob(f"{number}*.ply"))
                rows = [list(csv.DictReader(io.StringIO(table.read_text()))) for table in tables]
                document = pathlib.Path(files[0])
                maps = records(document.read_text()) if document.exists() else []
                for record in maps:
                    record.pop("files", None)
                found.append([maps, rows, [mesh.read_bytes() for mesh in meshes]])
            compared(f"map {name}", *found, told)
        before, after = (json.loads(run(program, "info", name, "--json").stdout or "[]") for program in (old, new))
        compared(f"info {name}", before, after, told)
    print(f"{told[0]} comparisons of {NUMBERS[0]} numbers, {told[1]} with differences")
    sys.exit(bool(told[1]))


main()
