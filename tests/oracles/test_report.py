"""Reports in a browser without a network: nothing fails, the numbers are those of `measure`, the surface is there."""

import io
import json
import pathlib
import time

import numpy as np
import pytest
from conftest import DATA, measure, needs_data, surfometry
from PIL import Image
from playwright.sync_api import sync_playwright

CHROMIUM = pathlib.Path("/usr/bin/chromium")
pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason=f"{CHROMIUM} is absent")

TORUS = "phantom:torus?major=12&minor=5"
L4 = DATA / "bone" / "verse004_L4.nii.gz"
# No GPU, and no call home.
FLAGS = [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
]
# Seconds for a scene to be drawn by software.
PATIENCE = 60


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def show(browser, tmp_path):
    """Writes and opens a report; at the end of the test the page must have had no trouble and asked for nothing.

    The window ends above the 3-D view, which is drawn when it comes into sight.
    """
    troubles = []

    def of(*arguments, status=0):
        path = tmp_path / "report.html"
        surfometry("report", *arguments, "-o", path, status=status)
        page = context.new_page()
        page.on("console", lambda m: troubles.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda e: troubles.append(str(e)))
        allowed = (path.as_uri(), "data:", "blob:")
        page.on("request", lambda r: None if r.url.startswith(allowed) else troubles.append(r.url))
        page.goto(path.as_uri())
        return page

    context = browser.new_context(offline=True, viewport={"width": 1000, "height": 200})
    yield of
    context.close()
    assert troubles == []


def scene(page):
    """Pixels of the 3-D view, without the colour bar at its right."""
    page.set_viewport_size({"width": 1000, "height": 900})
    page.locator(".scene").scroll_into_view_if_needed()
    page.wait_for_selector(".scene[data-shown]", timeout=1000 * PATIENCE)
    picture = Image.open(io.BytesIO(page.locator(".scene").screenshot())).convert("RGB")
    width, height = picture.size
    return np.asarray(picture.crop((0, 0, int(0.8 * width), height))).astype(int)


def shares(page):
    """How much of the 3-D view is reddish, and bluish."""
    pixels = scene(page)
    redness = pixels[..., 0] - pixels[..., 2]
    return np.mean(redness > 40), np.mean(redness < -40)


def until(condition):
    """Waits for what is drawn after the page says so."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.2)


def table(page):
    """The first table's cells by row name."""
    rows = [row.locator("td").all_inner_texts() for row in page.locator("table").first.locator("tr").all()[1:]]
    return {name: cells for name, *cells in rows}


def numbers(text):
    """Those in a cell, as they stand there."""
    words = text.replace("−", "-").replace(",", " ").split()
    return [float(word) for word in words if word.lstrip("-")[:1].isdigit()]


def embedded(page):
    """The results inside the page."""
    return [json.loads(script.text_content()) for script in page.locator("script.result").all()]


def check_record(page, record):
    """In the table with six digits, of the Euler characteristic three decimals; in the page's JSON as it is."""
    keys = ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm", "average_mean_curvature_per_mm"]
    rows, topology = table(page), record["topology"]
    expected = {"blurred": record["blurred"], "original": record, "mesh of the blurred": record["mesh"]}
    if record["truth"]:
        expected["exact"] = record["truth"]
    for name, values in expected.items():
        for cell, key in zip(rows[name], keys):
            assert numbers(cell) == ([pytest.approx(values[key], rel=6e-6)] if key in values else []), (name, key)
    assert numbers(rows["voxels"][0]) == [pytest.approx(record["voxels"]["volume_mm3"], rel=6e-6)]
    assert numbers(rows["blurred"][4]) == [pytest.approx(record["blurred"]["euler_characteristic"], abs=6e-4)]
    assert numbers(rows["mesh of the blurred"][4]) == [topology["euler_characteristic_mesh"]]
    both = [topology[f"euler_characteristic_voxels_{n}"] for n in [26, 6]]
    assert numbers(rows["voxels"][4]) == both

    (found,) = embedded(page)
    # Times differ from run to run.
    kept = record.keys() - {"read_seconds", "seconds"}
    assert {key: found.get(key) for key in kept} == {key: record[key] for key in kept}
    means = {d["name"]: d["by_area"]["mean"] for d in found["distributions"]}
    # The surface that is shown is the blurred one.
    shown = record["blurred"]["average_mean_curvature_per_mm"]
    assert means["mean_curvature_per_mm"] == pytest.approx(shown, rel=0.05)


def test_a_torus_has_its_exact_values_beside_and_is_colored_as_chosen(show):
    page = show(TORUS)
    (record,) = measure(TORUS)
    assert "truth" in record
    check_record(page, record)
    # H is positive all around.
    until(lambda: shares(page)[0] > 0.05)
    assert shares(page)[1] < 0.001
    page.locator("select").select_option(label="Gaussian curvature K (1/mm²)")
    until(lambda: min(shares(page)) > 0.01)
    assert page.locator(".scene .cbtitle").text_content().startswith("Gaussian curvature K")
    page.locator("select").select_option(label="Shape index")
    until(lambda: shares(page)[1] < 0.001)


@needs_data
def test_the_page_says_what_was_measured(show):
    page = show(L4)
    (record,) = measure(L4)
    check_record(page, record)
    # Ridges and hollows.
    until(lambda: shares(page)[0] > 0.02)
    assert shares(page)[1] > 0
    shown = page.locator("section").first.locator(".flags b").all_inner_texts()
    assert shown == [flag["code"] for flag in record["flags"] if flag["code"] != "not-computed"]


def test_what_failed_is_listed_and_the_rest_is_there(show, tmp_path):
    bad = tmp_path / "bad.nii"
    bad.write_bytes(b"no image")
    page = show("phantom:ball?radius=8", bad, status=1)
    failure = page.locator("section", has_text="Not measured")
    assert failure.locator("li b").all_inner_texts() == [str(bad)]
    (found,) = embedded(page)
    assert found["input"] == "phantom:ball?radius=8"


def test_names_are_text(show, tmp_path):
    # What ends or hides elements, in text, in attributes and in the JSON of scripts.
    name = """<!--<script>&amp;'"<b>.nii"""
    surfometry("phantom", "ball?radius=8", "-o", tmp_path / name)
    page = show(tmp_path / name)
    assert page.title() == name
    assert page.locator("h1").inner_text() == name
    assert name in page.locator("h2").first.inner_text()
    assert name in page.locator("dl").last.inner_text()
    assert page.locator("h1 *, h2 *, code *").count() == 0
    (found,) = embedded(page)
    assert found["input"] == str(tmp_path / name)
