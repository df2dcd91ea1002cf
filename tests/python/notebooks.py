"""Runs notebooks."""

import os
import pathlib
import re
import sys
import tempfile

import nbformat
from nbclient import NotebookClient

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "docs" / "notebooks"


def executed(path):
    """A notebook with what it shows now: run in an empty folder, with the command line of this environment."""
    notebook = nbformat.read(path, as_version=4)
    before = os.environ["PATH"]
    os.environ["PATH"] = os.pathsep.join([str(pathlib.Path(sys.executable).parent), before])
    try:
        with tempfile.TemporaryDirectory() as folder:
            place = {"metadata": {"path": folder}}
            client = NotebookClient(notebook, timeout=300, kernel_name="python3", record_timing=False, resources=place)
            # No port of this machine is opened for it.
            client.km = client.create_kernel_manager()
            client.km.transport, client.km.ip = "ipc", str(pathlib.Path(folder) / "kernel")
            client.execute()
    finally:
        os.environ["PATH"] = before
    return notebook


def words(notebook):
    """The words and numbers that cells show; pictures and addresses of objects are not among them."""
    shown = []
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            text = output.get("text") or output.get("data", {}).get("text/plain", "")
            shown.append(re.sub(r"0x[0-9a-f]+", "0x", text))
    return shown


def pictures(notebook):
    """How many pictures a notebook shows."""
    return sum("image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", []))
