"""Many files to one table: the rows of the command line, whatever dies on the way; and the recipes of docs/clusters.md."""

import csv
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from conftest import BINARY, ROOT, command_line

import surfometry

CLUSTERS = (ROOT / "docs" / "clusters.md").read_text(encoding="utf-8")


def shapes(count):
    """Turned shapes on lattices of three spacings; sizes differ."""
    return [
        f"phantom:torus?major={8 + n % 9}&minor=4&rotate=20,{n},40&shift=0.3,0.1,0.2&spacing=0.7,0.9,1.1" for n in range(count)
    ]


def rows(path):
    """Of a table, without times."""
    with open(path, newline="", encoding="utf-8") as table:
        return [{name: cell for name, cell in row.items() if "seconds" not in name} for row in csv.DictReader(table)]


def measured_by_the_command_line(folder, inputs):
    whole = folder / "whole.csv"
    subprocess.run([BINARY, "measure", "--quiet", *inputs, "-o", whole], check=False, cwd=folder)
    return rows(whole)


def test_the_rows_are_the_command_lines(tmp_path):
    (tmp_path / "broken.nii").write_bytes(b"no image")
    inputs = [*shapes(6), str(tmp_path / "broken.nii"), "missing.nii", "phantom:two-balls?radius=6"]
    heard = []
    found = surfometry.cohort(inputs, tmp_path / "all.csv", progress=lambda *said: heard.append(said))
    assert rows(tmp_path / "all.csv") == measured_by_the_command_line(tmp_path, inputs)
    assert found.rows == 7 and list(found.failures) == inputs[6:8] and found.out == tmp_path / "all.csv"
    assert all(of == len(inputs) for text, _, of in heard if text == "inputs")
    # A failed one is tried again, and what is there is not measured again: its times are the same.
    before = (tmp_path / "all.csv").read_text(encoding="utf-8").splitlines()
    command_line("phantom", "ball?radius=7", "-o", tmp_path / "broken.nii")
    again = surfometry.cohort(inputs, tmp_path / "all.csv")
    after = (tmp_path / "all.csv").read_text(encoding="utf-8").splitlines()
    assert list(again.failures) == ["missing.nii"] and again.rows == 8
    assert [a == b for a, b in zip(before, after, strict=True)] == [name != inputs[6] for name in ["header", *inputs]]


KILLED = """
import sys, surfometry
surfometry.cohort(sys.argv[2:], sys.argv[1], threads=2)
"""


def test_a_killed_run_loses_what_was_in_flight(tmp_path):
    inputs, out = shapes(60), tmp_path / "all.json"
    journal = tmp_path / "all.json.journal.partial"
    known, kills = 0, 0
    for wait in np.arange(0.8, 40, 0.7):
        run = subprocess.Popen([sys.executable, "-c", KILLED, out, *inputs], cwd=tmp_path)
        time.sleep(wait)
        if run.poll() is not None:
            break
        run.send_signal(signal.SIGKILL)
        run.wait()
        kills += 1
        finished = journal.read_text(encoding="utf-8").count('{"result"') if journal.exists() else 0
        assert finished >= known
        known = finished
    assert run.returncode == 0 and kills > 1 and known > 10
    written = (tmp_path / "all.json.journal").read_text(encoding="utf-8")
    names = [json.loads(line)["result"]["input"] for line in written.splitlines() if line.startswith('{"result"')]
    # Each was measured once and written once, whenever the run was killed; half lines were taken away.
    assert sorted(names) == sorted(inputs)
    document = json.loads(out.read_text(encoding="utf-8"))
    assert [record["input"] for record in document["results"]] == inputs


def test_parquet_has_the_numbers_of_csv(tmp_path):
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    inputs = [*shapes(3), "missing.nii"]
    surfometry.cohort(inputs, tmp_path / "all.parquet")
    surfometry.cohort(inputs, tmp_path / "all.csv")
    frame = pandas.read_parquet(tmp_path / "all.parquet")
    for row, (_, stored) in zip(rows(tmp_path / "all.csv"), frame.iterrows(), strict=True):
        for name, cell in row.items():
            value = stored[name]
            assert (pandas.isna(value) if cell == "" else type(value)(cell) == value), name
    assert {str(kind) for kind in frame.dtypes} <= {"float64", "string", "str"}
    assert sorted(path.name for path in tmp_path.iterdir() if "parquet" in path.name) == [
        "all.parquet", "all.parquet.csv.journal",
    ]  # fmt: skip


def test_what_makes_no_sense_is_told_before_anything_is_measured(tmp_path):
    ball = ["phantom:ball?radius=6"]
    for wrong, words in [
        (lambda: surfometry.cohort("scans/*.nii", tmp_path / "a.csv"), "glob"),
        (lambda: surfometry.cohort([], tmp_path / "a.csv"), "no file"),
        (lambda: surfometry.cohort(ball, tmp_path / "a.xlsx"), r"\.parquet"),
        (lambda: surfometry.cohort(ball * 2, tmp_path / "a.csv"), "named twice"),
        (lambda: surfometry.cohort(ball, tmp_path / "a.csv", sigma={1: 1.5}), "labels of their own"),
        (lambda: surfometry.cohort(ball, tmp_path / "a.csv", sigma=-1), "sigma"),
    ]:
        with pytest.raises(ValueError, match=words):
            wrong()
    with pytest.raises(OSError, match="nowhere"):
        surfometry.cohort(ball, tmp_path / "nowhere" / "a.csv")
    assert list(tmp_path.iterdir()) == []
    scan = tmp_path / "scan.csv"
    scan.write_text("a,b\n")
    with pytest.raises(surfometry.ParameterError, match="replace an input"):
        surfometry.cohort([scan], scan)
    surfometry.cohort(ball, tmp_path / "a.csv")
    with pytest.raises(surfometry.InputError, match="another run.*sigma"):
        surfometry.cohort(ball, tmp_path / "a.csv", sigma=1.5)
    assert surfometry.cohort(ball, tmp_path / "a.csv", sigma=1.5, resume=False).rows == 1


@pytest.fixture
def scans(tmp_path):
    """A folder of scans, one of which is broken."""
    (tmp_path / "scans").mkdir()
    for number, shape in enumerate(shapes(10)):
        command_line("phantom", shape, "-o", tmp_path / "scans" / f"{number}.nii.gz")
    for truth in (tmp_path / "scans").glob("*.json"):
        truth.unlink()
    (tmp_path / "scans" / "bad.nii.gz").write_bytes(b"no image")
    return tmp_path


def environment(**more):
    return {**os.environ, "PATH": f"{BINARY.parent}:{os.environ['PATH']}", **more}


def blocks_of(language, after):
    return re.findall(rf"```{language}\n(.*?)```", CLUSTERS[CLUSTERS.index(after) :], re.DOTALL)


def test_the_slurm_recipe(scans):
    script = blocks_of("bash", "### Slurm")[0]
    first, last = map(int, re.search(r"--array=(\d+)-(\d+)", script).groups())
    # The third is submitted again, by itself.
    for index, count in [*((index, last) for index in range(first, last + 1)), (3, 1)]:
        slurm = {"SLURM_ARRAY_TASK_ID": index, "SLURM_ARRAY_TASK_COUNT": count, "SLURM_CPUS_PER_TASK": 2}
        variables = environment(**{name: str(value) for name, value in slurm.items()})
        assert subprocess.run(["bash", "-c", script], cwd=scans, env=variables, check=False).returncode in (0, 1)
    merge = re.search(r'--wrap "(.*)"', blocks_of("console", "### Slurm")[0]).group(1)
    assert subprocess.run(["bash", "-c", merge], cwd=scans, env=environment(), check=False).returncode == 1
    files = sorted(str(pathlib.Path("scans") / path.name) for path in (scans / "scans").iterdir())
    assert rows(scans / "results.csv") == measured_by_the_command_line(scans, files)


def test_the_snakemake_recipe(scans):
    """Its lines by hand, as Snakemake fills them in; and by Snakemake, where it is installed."""
    text = blocks_of("python", "### Snakemake")[0]
    count = int(re.search(r"SHARDS = (\d+)", text).group(1))
    shard, merge = re.findall(r'shell: "(.*)"', text)
    strict = "set -euo pipefail; "
    (scans / "shards").mkdir()
    names = [f"shards/{number}.jsonl" for number in range(1, count + 1)]
    for number, name in enumerate(names, 1):
        line = shard.replace("{wildcards.number}", str(number)).replace("{SHARDS}", str(count))
        line = line.replace("{threads}", "2").replace("{output}", name)
        subprocess.run(["bash", "-c", strict + line], cwd=scans, env=environment(), check=True)
    line = merge.replace("{input}", " ".join(names)).replace("{output}", "results.csv")
    subprocess.run(["bash", "-c", strict + line], cwd=scans, env=environment(), check=True)
    files = sorted(str(pathlib.Path("scans") / path.name) for path in (scans / "scans").iterdir())
    truth = measured_by_the_command_line(scans, files)
    assert rows(scans / "results.csv") == truth
    snakemake = shutil.which("snakemake")
    if snakemake:
        shutil.rmtree(scans / "shards")
        (scans / "results.csv").unlink()
        (scans / "Snakefile").write_text(text, encoding="utf-8")
        subprocess.run([snakemake, "--cores", "2", "--quiet"], cwd=scans, env=environment(), check=True)
        assert rows(scans / "results.csv") == truth
