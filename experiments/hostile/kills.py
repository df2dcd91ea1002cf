#!/usr/bin/env python3
"""Kills runs at random moments, and looks at what is left.

    experiments/hostile/kills.py target/release/surfometry [--kills 200] [--seed 1]

A command over built-in shapes is killed (SIGKILL, SIGTERM or SIGINT by turns) at a moment drawn from its whole run.
Then: a file that was there before has its bytes, or is the finished one; beside it lies at most `NAME.partial` or a
journal; what a document holds so far is a whole document; the same command run again ends as if nothing had been, and
leaves no other file. Ends with 1 where anything else is found.
"""

import argparse
import collections
import csv
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

SHAPES = [
    f"phantom:torus?major={9 + n}&minor=4&rotate=20,{n},40&spacing=0.7,0.9,1.1" for n in range(6)
] + ["phantom:two-balls?radius=9"]
SIGNALS = [signal.SIGKILL, signal.SIGTERM, signal.SIGINT]
EARLIER = b"what was there before"


def commands():
    """Name of the case, arguments, and the outputs that it writes."""
    for ending in ("csv", "json", "jsonl"):
        yield f"measure {ending}", ["measure", *SHAPES, "-o", f"out.{ending}"], [f"out.{ending}"]
    yield "measure --resume", ["measure", *SHAPES, "--resume", "-o", "out.csv"], ["out.csv"]
    yield "measure --shard", ["measure", *SHAPES, "--shard", "1/2", "-o", "out.jsonl"], ["out.jsonl"]
    for ending in ("ply", "vtp", "json", "png"):
        yield f"map {ending}", ["map", SHAPES[0], "-o", f"out.{ending}"], [f"out.{ending}"]
    yield "report", ["report", SHAPES[0], "-o", "out.html"], ["out.html"]
    yield "embed", ["embed", SHAPES[0], "-o", "out.nii.gz"], ["out.nii.gz"]
    yield "cohort", ["cohort", "--femurs", "1", "--vertebrae", "0", "-o", "out"], []


def whole(path: pathlib.Path, ending: str) -> None:
    """Fails where a document that is there so far is not one."""
    text = path.read_text()
    if not text:
        return
    if ending == "json":
        json.loads(text)
    elif ending == "jsonl":
        for line in text.splitlines()[: text.count("\n")]:
            json.loads(line)
    elif ending == "csv":
        rows = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))
        if len({len(row) for row in rows}) > 1:
            raise ValueError("rows of different lengths")


def timeless(path: pathlib.Path) -> object:
    """A result without what no two runs have alike."""
    if path.suffix in (".png", ".ply", ".vtp", ".gz"):
        return path.read_bytes()
    if path.suffix == ".csv":
        rows = list(csv.DictReader(path.read_text().splitlines()))
        return [{k: v for k, v in row.items() if not k.endswith("seconds")} for row in rows]
    return None


def kill_one(program: str, number: int, chance: random.Random, durations: dict[str, float]) -> list[str]:
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        cases = list(commands())
        case, arguments, outputs = cases[number % len(cases)]
        run = [program, "--quiet", *arguments]
        if case not in durations:
            with tempfile.TemporaryDirectory() as other:
                start = time.perf_counter()
                subprocess.run(run, cwd=other, capture_output=True, check=True)
                durations[case] = time.perf_counter() - start
        for output in outputs:
            (folder / output).write_bytes(EARLIER)
        with_what = SIGNALS[number // len(cases) % len(SIGNALS)]
        process = subprocess.Popen(run, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(chance.random() * durations[case])
        process.send_signal(with_what)
        try:
            process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            faults.append(f"{case}: lives on 20 s after {with_what.name}")
        ended = process.returncode == 0
        for output in outputs:
            content = (folder / output).read_bytes()
            if not ended and content != EARLIER:
                # It may have been finished before the signal came.
                if (folder / f"{output}.partial").exists():
                    faults.append(f"{case}: the earlier file was changed before the run had ended")
            partial = folder / f"{output}.partial"
            if partial.exists() and case.startswith("measure"):
                try:
                    whole(partial, output.rsplit(".", 1)[1])
                except (ValueError, UnicodeDecodeError) as error:
                    faults.append(f"{case}: {partial.name} is no whole document: {error}")
        allowed = set(outputs) | {f"{o}.partial" for o in outputs} | {f"{o}.journal" for o in outputs}
        allowed |= {f"{o}.journal.partial" for o in outputs}
        stray = [p.name for p in folder.iterdir() if p.is_file() and p.name not in allowed]
        faults += [f"{case}: {name} is left" for name in stray]
        again = subprocess.run(run, cwd=folder, capture_output=True, text=True)
        if again.returncode != 0:
            faults.append(f"{case}: run again it ends with {again.returncode}: {again.stderr.strip()[-300:]}")
        left = [str(p.relative_to(folder)) for p in folder.rglob("*") if ".partial" in p.name or ".tmp" in p.name]
        faults += [f"{case}: {name} is left after the second run" for name in left]
        for output in outputs:
            result = timeless(folder / output)
            with tempfile.TemporaryDirectory() as other:
                if result is not None:
                    subprocess.run(run, cwd=other, capture_output=True, check=True)
                    if timeless(pathlib.Path(other) / output) != result:
                        faults.append(f"{case}: run again it gives something else")
    return faults


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    chance, durations = random.Random(options.seed), {}
    faults: collections.Counter[str] = collections.Counter()
    for number in range(options.kills):
        faults.update(kill_one(program, number, chance, durations))
    for fault, times in faults.most_common():
        print(f"{times} x {fault}")
    print(f"{options.kills} kills of {len(durations)} commands: {sum(faults.values())} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
