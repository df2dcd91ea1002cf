#!/usr/bin/env python3
"""Gives each option of each command, and each parameter of each built-in shape, values that make no sense.

    experiments/hostile/parameters.py target/release/surfometry [--seed 1] [--pairs 500]

Commands and options are read from `--help`. Each option gets each odd value alone, then `--pairs` commands have two odd options.
A fault is: an exit status that is none of ours, a panic, more than 20 s or 1 GB, a refusal without words or one that shows neither
what was typed nor its option, numbers that are not finite in a document, or a file that is left half written. Ends with 1
where there is one.
"""

import argparse
import itertools
import json
import os
import pathlib
import random
import re
import resource
import subprocess
import sys
import tempfile

SECONDS = 20
MEMORY_KIB = 1 << 20
STATUSES = (0, 1, 2)
NUMBERS = [
    "", " ", "nan", "NaN", "inf", "-inf", "-1", "0", "-0", "0.0", "1e-320", "1e-12", "1e308", "1e309", "-1e308", "1e6",
    "18446744073709551616", "4294967296", "9223372036854775808", "00001", "0x10", "1_000", "1,5", "1.5.2", "\u0661",
]
WORDS = [
    "auto", "all", "none", "x", "x" * 300, "=", "1=", "=1", "1=1=1", "1=nan", "1=-1", "1=auto,2=auto", ",", ",,,", "1,,2", "1-", "-5-3",
    "3-1", "1-99999999999", "1+", "+1", "1+1", "1+2", "..", "0..", "..0", "5..1", "nan..nan", "inf..", "1:2", "1:2:0", "2:1:3",
    "1:2:1e9", "1:2:-3", "0:0:2", "1/0", "0/1", "2/1", "1/99999999999", "1,2,3", "0,0,0", "1,1,1,1", "-1,1,1", "1e-9,1,1", "1e9,1,1",
    "nan,1,1", "1x1x1:uint8", "0x0x0:uint8", "99999x99999x99999:float64", "8x8x8:uint99", "8x8x8:uint8:big:-1", "x=0", "z=centre",
    "x=-1", "x=99999999999", "q=1", "0mm", "-5px", "1e9px", "nanmm", "85mm", "\n", "\t1", "a\nb", "\u202e", "\U0001f9b4", "'", '"', "`id`",
    "$(id)", "../..", "/", ".", "-", "--", "/dev/null", "/dev/zero", "missing/folder/out.csv", "n" * 300 + ".csv", "out", "out.xyz",
    "out.csv", "out.json", "in.nii", "in.nii/", "in.nii.gz", "table.csv", "https://example.org/a.nii",
]  # fmt: skip
SHAPES = {
    "ball": ["radius"], "ellipsoid": ["radii"], "capsule": ["radius", "length"], "torus": ["major", "minor"],
    "rounded-box": ["radii", "radius"], "shell": ["radius", "inner"], "two-balls": ["radius", "length"],
    "genus": ["genus", "major", "minor"], "gyroid": ["period", "size"], "schwarz-p": ["period", "size"],
    "femur": ["individual"], "vertebra": ["individual", "holes"],
}  # fmt: skip
POSE = ["spacing", "rotate", "shift", "jitter", "flips"]
# A command that does its work on a small image; `{}` is where options go.
COMMANDS = {
    "measure": ["in.nii", "{}", "-o", "result.json"],
    "map": ["in.nii", "{}", "-o", "result.json"],
    "report": ["in.nii", "{}", "-o", "result.html"],
    "embed": ["in.nii", "{}", "-o", "result.nii"],
    "info": ["in.nii", "{}"],
    "phantom": ["ball?radius=3", "{}", "-o", "result.nii"],
    "sweep": ["in.nii", "{}", "--range", "1:2:2", "-o", "result.json"],
    "reference": ["in.nii", "{}", "-o", "result.json"],
    "compare": ["table.csv", "table.csv", "{}"],
    "merge": ["shard.jsonl", "{}"],
    "rerun": ["document.json", "{}"],
    "generate": ["{}"],
}
# What messages call them; what a description of voxels claims is told of the file that it is put before.
SPOKEN_OF = {"--raw": "in.nii", "--size": "picture", "--sigma": "length", "--thickness": "length"}
# A number of these is work that was asked for.
ASKED_FOR = {("compare", "--resamples"), ("sweep", "--range")}


def options_of(program: str, command: str) -> list[str]:
    """Options that take a value."""
    text = subprocess.run([program, command, "--help"], capture_output=True, text=True, check=True).stdout
    return sorted(set(re.findall(r"^\s+(?:-\w, )?(--[a-z-]+) [<\[]", text, re.MULTILINE)))


def cases(program: str, chance: random.Random, pairs: int):
    """Arguments, what was typed, and which names an answer may speak of."""
    odd = NUMBERS + WORDS
    options = {command: options_of(program, command) for command in COMMANDS}
    for command, names in options.items():
        for name in names:
            for value in odd:
                if (command, name) not in ASKED_FOR or not re.search(r"\d{7}|1e[369]", value):
                    yield arguments(command, [f"{name}={value}"]), [value], [name]
    # A word that begins with a hyphen is an option, which there is not.
    for command in COMMANDS:
        for value in (word for word in WORDS if not word.startswith("-")):
            yield arguments(command, [value]), [value], []
    for shape, keys in SHAPES.items():
        for key in keys + POSE:
            # A rod of 10^6 voxels is measured, in half a minute.
            sensible = {"1e6", "00001"} if key == "length" else set()
            for value in [number for number in NUMBERS if number not in sensible] + ["1,2", "1,2,3,4", "0,0,0", "-1,1,1", "1e-9,1,1", "nan,nan,nan", "1e9,1e9,1e9", "xyz"]:
                yield ["measure", f"phantom:{shape}?{key}={value}", "-o", "result.json"], [value], [key, shape]
        yield ["measure", f"phantom:{shape}?nonsense=1", "-o", "result.json"], ["nonsense"], [shape]
    for _ in range(pairs):
        command = chance.choice([command for command, names in options.items() if len(names) > 1])
        names = [name for name in chance.sample(options[command], 2) if (command, name) not in ASKED_FOR]
        values = [chance.choice(odd) for _ in names]
        typed = [f"{name}={value}" for name, value in zip(names, values)]
        yield arguments(command, typed), values, names


def arguments(command: str, typed: list[str]) -> list[str]:
    return [command, *(part for word in COMMANDS[command] for part in (typed if word == "{}" else [word]))]


def numbers(value: object):
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for part in value:
            yield from numbers(part)
    elif isinstance(value, float):
        yield value


def parts_of(value: str) -> list[str]:
    """What of a value a message may show: as much as can be printed, or what stands in front of an equals sign."""
    printable = "".join(c for c in value if c.isprintable()).strip()
    return [part[:40] for part in (printable, printable.split("=")[0]) if part]


def fault_of(program: str, folder: pathlib.Path, given: list[str], values: list[str], names: list[str]) -> str | None:
    before = set(os.listdir(folder))
    kept = {name: (folder / name).read_bytes() for name in before}
    try:
        # Of no use to it: what is typed may be `-`.
        run = subprocess.Popen([program, *given], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    except ValueError:
        return None
    try:
        output, errors = (text.decode(errors="replace") for text in run.communicate(timeout=SECONDS))
    except subprocess.TimeoutExpired:
        run.kill()
        run.communicate()
        for name in set(os.listdir(folder)) - before:
            (folder / name).unlink()
        return f"more than {SECONDS} s"
    left = set(os.listdir(folder)) - before
    try:
        if run.returncode not in STATUSES:
            return f"status {run.returncode}: {errors[-300:]}"
        if "panicked" in errors or "a fault of surfometry itself" in errors:
            return f"panic: {errors[-300:]}"
        # What is named as an output may be written over, unless it is an input.
        written = {value for value, name in zip(values, [*names, "-o"]) if name in ("--output", "--png", "--svg", "-o")} - {"in.nii"}
        if any((folder / name).read_bytes() != bytes_ for name, bytes_ in kept.items() if name not in written):
            return "a file that was there is another one"
        if run.returncode != 0:
            said = " ".join(errors.split())
            shown = [*(name.strip("-") for name in names), *(part for value in values for part in parts_of(value))]
            if len(said) < 20:
                return f"it says only `{said}`"
            if len(errors) > 4000 or re.search(r"\d{40}", said):
                return f"it says too much: {said[:300]}"
            shown += [SPOKEN_OF[name] for name in names if name in SPOKEN_OF]
            if any(value.strip().isprintable() and value.strip() for value in values) and not any(word and word in said for word in shown):
                return f"it tells of neither {shown}: {said[:300]}"
        if any(name.endswith((".partial", ".tmp")) for name in left):
            return f"left over: {left}"
        document = folder / "result.json"
        if run.returncode == 0 and document.exists():
            json.loads(document.read_text(), parse_constant=lambda name: (_ for _ in ()).throw(ValueError(name)))
        return None
    except ValueError as error:
        return f"no document: {error}"
    finally:
        for name in written & before:
            (folder / name).write_bytes(kept[name])
        for name in left:
            path = folder / name
            path.unlink() if path.is_file() or path.is_symlink() else subprocess.run(["rm", "-rf", path], check=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pairs", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, help="how many of them to pass over")
    args = parser.parse_args()
    program = str(args.program.resolve())
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        made = {"cwd": folder, "check": True, "capture_output": True}
        subprocess.run([program, "phantom", "two-balls?radius=4&spacing=0.9,1,1.1", "-o", "in.nii"], **made)
        subprocess.run([program, "measure", "in.nii", "-o", "table.csv"], **made)
        subprocess.run([program, "measure", "in.nii", "-o", "document.json"], **made)
        subprocess.run([program, "measure", "in.nii", "--shard", "1/1", "-o", "shard.jsonl"], **made)
        tried = faults = 0
        for given, values, names in itertools.islice(cases(program, random.Random(args.seed), args.pairs), args.first, None):
            tried += 1
            fault = fault_of(program, folder, given, values, names)
            if fault:
                faults += 1
                print(f"{' '.join(repr(word)[:80] for word in given)}\n    {fault}", flush=True)
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
    print(f"{tried} commands, {faults} faults; no command held more than {most / 1024:.0f} MiB")
    return int(faults > 0 or most > MEMORY_KIB)


if __name__ == "__main__":
    sys.exit(main())
