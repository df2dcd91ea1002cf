"""Reports in a browser without a network: nothing fails, numbers are those of `measure`, what is shown is linked."""

import csv
import io
import json
import pathlib
import re
import time
import zlib

import nibabel as nib
import numpy as np
import pytest
from conftest import DATA, measure, needs_data, surfometry
from PIL import Image
from playwright.sync_api import sync_playwright

CHROMIUM = pathlib.Path("/usr/bin/chromium")
pytestmark = pytest.mark.skipif(not CHROMIUM.exists(), reason=f"{CHROMIUM} is absent")

TORUS = "phantom:torus?major=12&minor=5&rotate=20,30,40&shift=0.3,0.2,0.1&spacing=0.9,0.8,1.2"
# A gap of 1.5 mm, which a blur fills.
JOINED = "phantom:two-balls?radius=7&length=15.5&rotate=20,30,0&spacing=1,1,1.3"
L4 = DATA / "bone" / "verse004_L4.nii.gz"
LABELS = DATA / "bone" / "totalseg_ct_3mm_62labels.nii.gz"
TRABECULAR = DATA / "trabecular" / "lhdl_3155_lower_largest_padded.nii.gz"
HOSTILE = "<script>alert(1)</script>"
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
# Seconds for what software draws.
PATIENCE = 60


@pytest.fixture(scope="module")
def browser():
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def show(browser, tmp_path):
    """Writes and opens a report; at the end of the test the page must have had no trouble and asked for nothing."""
    troubles = []

    def of(*arguments, status=0):
        path = tmp_path / "report.html"
        surfometry("report", *arguments, "-o", path, status=status)
        page = context.new_page()
        page.on("console", lambda m: troubles.append(m.text) if m.type in ["error", "warning"] else None)
        page.on("pageerror", lambda e: troubles.append(str(e)))
        page.on("dialog", lambda d: (troubles.append(d.message), d.dismiss()))
        allowed = (path.as_uri(), "data:", "blob:")
        page.on("request", lambda r: None if r.url.startswith(allowed) else troubles.append(r.url))
        page.goto(path.as_uri())
        ready(page)
        return page

    context = browser.new_context(offline=True, viewport={"width": 1200, "height": 900})
    yield of
    context.close()
    assert troubles == []


def ready(page):
    page.wait_for_selector("body[data-ready]", timeout=1000 * PATIENCE)
    assert page.locator(".trouble").count() == 0


def drawn(page):
    """The page, once what was asked of it is drawn."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return page


def pixels(page, of=".scene canvas"):
    """What an element shows, once it has been drawn."""
    drawn(page)
    picture = Image.open(io.BytesIO(page.locator(of).first.screenshot())).convert("RGB")
    return np.asarray(picture).astype(int)


def colourful(picture):
    """Share of the pixels that have a hue."""
    return np.mean(np.ptp(picture, axis=2) > 30)


def different(a, b):
    """Share of the pixels that differ."""
    height, width = np.minimum(a.shape, b.shape)[:2]
    return np.mean(np.abs(a[:height, :width] - b[:height, :width]).max(axis=2) > 12)


def shares(page):
    """How much of the 3-D view is reddish, and bluish."""
    redness = np.subtract(*np.moveaxis(pixels(page), 2, 0)[[0, 2]])
    return np.mean(redness > 40), np.mean(redness < -40)


def colour_by(page, text):
    page.get_by_label("Colour by").select_option(label=text)


def drag(page, target, start, end):
    """From one place of an element to another, both as shares of its sides."""
    target.scroll_into_view_if_needed()
    box = target.bounding_box()
    at = lambda share: (box["x"] + share[0] * box["width"], box["y"] + share[1] * box["height"])
    page.mouse.move(*at(start))
    page.mouse.down()
    for step in range(1, 9):
        page.mouse.move(*at([a + (b - a) * step / 8 for a, b in zip(start, end)]))
    page.mouse.up()


def numbers(text):
    """Those in a cell, as they stand there."""
    words = re.split(r"[\s,;]+", text.replace("−", "-"))
    return [float(word) for word in words if re.fullmatch(r"-?\d+\.?\d*(e[-+]?\d+)?", word)]


def embedded(page):
    """The results inside the page."""
    return [found["result"] for found in json.loads(page.locator("#report").text_content())["objects"]]


def check_record(page, record):
    """In the table with six digits, or with those of the error bar, of the Euler characteristic three decimals; in the page's JSON as it is."""
    lines = page.locator(".numbers tbody tr").all()
    rows = {name: cells for name, *cells in (line.locator("td").all_inner_texts() for line in lines)}
    topology = record["topology"]
    keys = ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm", "average_mean_curvature_per_mm"]
    field = "recovering" if record["parameters"]["embedding"] == "recovering" else "blurred"
    expected = {field: record["blurred"], "original": record, f"mesh of the {field}": record["mesh"]}
    if record["truth"]:
        expected["exact"] = record["truth"]
    # Of the original object no further than the second digit of its error.
    rounding = {key: 0.051 * (record["standard_error"][key] or 0) for key in keys}
    for name, values in expected.items():
        for cell, key in zip(rows[name], keys):
            off = rounding[key] if name == "original" else 0
            shown = [pytest.approx(values[key], rel=6e-6, abs=off)] if key in values else []
            assert numbers(cell) == shown, (name, key)
    for cell, key in zip(rows["its standard error"], keys):
        assert numbers(cell) == [pytest.approx(record["standard_error"][key], rel=0.06)]
    assert numbers(rows["voxels"][0]) == [pytest.approx(record["voxels"]["volume_mm3"], rel=6e-6)]
    assert numbers(rows[field][4]) == [pytest.approx(record["blurred"]["euler_characteristic"], abs=6e-4)]
    assert numbers(rows[f"mesh of the {field}"][4]) == [topology["euler_characteristic_mesh"]]
    assert numbers(rows["voxels"][4]) == [topology[f"euler_characteristic_voxels_{n}"] for n in [26, 6]]
    (found,) = embedded(page)
    # Times differ from run to run, and are not in the page; the surface has a scale of its own, the numbers do not.
    kept = record.keys() - {"read_seconds", "seconds", "curvature_sigma_mm"}
    assert {key: found.get(key) for key in kept} == {key: record[key] for key in kept}
    assert found["curvature_sigma_mm"] > found["parameters"]["sigma_mm"]
    assert "by vertex: the original surface" in page.locator("dl", has_text="Surface and local curvature").first.inner_text()
    assert found["seconds"] is None and found["read_seconds"] is None
    means = {d["name"]: d["by_area"]["mean"] for d in found["distributions"]}
    # The surface of the distributions is the original one.
    shown = record["average_mean_curvature_per_mm"]
    assert means["mean_curvature_per_mm"] == pytest.approx(shown, rel=0.05)
    flags = page.locator(".flags b").all_inner_texts()
    assert flags == [flag["code"] for flag in record["flags"]]


def test_a_torus_is_coloured_as_chosen(show):
    page = show(TORUS)
    (record,) = measure(TORUS)
    assert "truth" in record
    check_record(page, record)
    # H is positive all around, K on the outer half.
    assert shares(page)[0] > 0.05 and shares(page)[1] < 0.001
    colour_by(page, "Gaussian curvature K (1/mm²)")
    assert min(shares(page)) > 0.01
    colour_by(page, "Shape index")
    assert shares(page)[1] < 0.001
    options = page.get_by_label("Colour by").locator("option").all_inner_texts()
    assert "Mean curvature H, standard error (1/mm)" in options
    assert options.count("Mean curvature H (1/mm)") == 2
    before = pixels(page)
    page.get_by_label("Colours to", exact=True).evaluate("e => { e.value = 0.35 * e.max; e.dispatchEvent(new Event('input')); }")
    ranged = pixels(page)
    assert different(before, ranged) > 0.02
    page.get_by_label("Colours", exact=True).select_option("purple – orange")
    assert different(ranged, pixels(page)) > 0.05


def test_the_view_turns_zooms_and_comes_back(show):
    page = show(TORUS)
    canvas = page.locator(".scene canvas")
    whole = pixels(page)
    # The whole object is in view: nothing touches the rim.
    rim = np.concatenate([whole[3], whole[-4], whole[:, 3], whole[:, -4]])
    assert (np.ptp(rim, axis=1) < 30).all() and colourful(whole) > 0.15
    drag(page, canvas, (0.4, 0.5), (0.7, 0.35))
    turned = pixels(page)
    assert different(whole, turned) > 0.05
    canvas.hover()
    page.mouse.wheel(0, -600)
    assert colourful(pixels(page)) > 1.3 * colourful(turned)
    canvas.focus()
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("0")
    page.locator(".toolbar button[value=oblique]").click()
    assert different(whole, pixels(page)) < 0.01


def test_surface_and_histogram_light_up_in_each_other(show):
    page = show(TORUS)
    colour_by(page, "Gaussian curvature K (1/mm²)")
    histogram, canvas = page.locator(".side .histogram"), page.locator(".scene canvas")
    before = shares(page)
    # The upper values: the outer half stays, the inner one, which is blue, fades.
    drag(page, histogram, (0.75, 0.5), (0.99, 0.5))
    red, blue = shares(page)
    assert red > 0.01 and blue < 0.05 * before[1]
    chosen = page.locator(".chosen-text")
    assert 1 < numbers(chosen.inner_text())[0] < 60
    histogram.click(position={"x": 100, "y": 60})
    assert shares(page) == pytest.approx(before, abs=0.01)
    # A click on the surface, which its neighbours go with.
    box = canvas.bounding_box()
    picture = pixels(page)
    y, x = map(float, np.argwhere(np.ptp(picture, axis=2) > 60)[200])
    page.mouse.click(box["x"] + x, box["y"] + y + 2)
    assert chosen.inner_text().startswith("Gaussian curvature K") and "mm" in chosen.inner_text()
    assert histogram.locator("rect.chosen").count() >= 1
    # A lasso around its left half.
    page.get_by_role("button", name="lasso").click()
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    outline = [(0.01, 0.01), (0.5, 0.01), (0.5, 0.98), (0.01, 0.98)]
    page.mouse.move(box["x"] + 0.01 * box["width"], box["y"] + 0.01 * box["height"])
    page.mouse.down()
    for u, v in outline[1:]:
        page.mouse.move(box["x"] + u * box["width"], box["y"] + v * box["height"])
    page.mouse.up()
    assert histogram.locator("rect.chosen").count() > 10
    assert 10 < numbers(chosen.inner_text())[0] < 60
    left, right = np.array_split(pixels(page), 2, axis=1)
    assert colourful(left) > 5 * colourful(right)


def test_slices_scroll_through_the_object(show):
    page = show(TORUS)
    slices = page.locator(".slices figure")
    assert slices.count() == 3
    grey = lambda of: np.mean(np.abs(of - 176).max(axis=2) < 4)
    first = pixels(page, ".slices canvas")
    # Through the object, with its contour.
    assert grey(first) > 0.05 and colourful(first) > 0.002
    name = slices.first.locator(".slice-name").inner_text()
    page.locator(".slices canvas").first.focus()
    page.keyboard.press("ArrowUp")
    assert slices.first.locator(".slice-name").inner_text() != name
    for kind in ["phi", "delta", "curvature"]:
        page.get_by_label("Show", exact=True).select_option(kind)
        shown = pixels(page, ".slices canvas")
        assert different(first, shown) > 0.03, kind
        first = shown


def test_the_sweep_names_its_plateau_where_there_is_one(show):
    page = show("phantom:ball?radius=12&shift=0.2,0.3,0.4")
    sweep = json.loads(page.locator("#report").text_content())["objects"][0]["sweep"]
    plateau = sweep["plateau"]
    assert plateau["from_mm"] < sweep["used_mm"] < plateau["to_mm"]
    # A ball of many sigma: the blur takes nothing that is not undone.
    exact = 4 / 3 * np.pi * 12**3
    inside = [s for s in sweep["sigma_mm"] if plateau["from_mm"] <= s <= plateau["to_mm"]]
    lines = {line["name"]: line for line in sweep["panels"][0]["lines"]}
    volumes = dict(zip(sweep["sigma_mm"], lines["original"]["values"]))
    assert all(volumes[s] == pytest.approx(exact, rel=0.005) for s in inside)
    assert page.locator("p.plateau").inner_text().startswith("Plateau: from σ")
    assert page.locator(".sweep rect.plateau").count() == 4


def test_changes_of_topology_are_marked_on_the_surface(show):
    page = show(JOINED, "--sigma", "3")
    (record,) = embedded(page)
    changes = record["topology"]["changes"]
    assert changes and page.locator(".places li").count() == len(changes)
    assert page.locator(".mark").count() == len(changes)
    page.locator(".places button").first.click()
    x, y = map(float, re.findall(r"[\d.]+", drawn(page).locator(".mark").first.get_attribute("transform")))
    box = page.locator(".scene").bounding_box()
    assert (x, y) == (pytest.approx(box["width"] / 2, abs=2), pytest.approx(box["height"] / 2, abs=2))


def test_voxels_that_the_blur_took_lie_over_the_surface(show):
    page = show("phantom:genus?genus=1&major=8&minor=3", "--sigma", "3")
    assert page.locator(".flags b", has_text="detail-lost").count() == 1
    cloud = page.locator("[data-cloud=lost]")
    assert cloud.is_checked()
    shown = pixels(page)
    cloud.uncheck()
    assert different(shown, pixels(page)) > 0.01


def check_prints(page, sheets, more):
    """So many pages and few more, none of them blank."""
    path = pathlib.Path(page.url.removeprefix("file://")).with_suffix(".pdf")
    page.pdf(path=path)
    data = path.read_bytes()
    objects = dict(re.findall(rb"(\d+) 0 obj\n(.*?)endobj", data, re.DOTALL))
    found = [o for o in objects.values() if re.search(rb"/Type\s*/Page\b", o)]
    assert sheets <= len(found) <= sheets + more
    for one in found:
        content = objects[re.search(rb"/Contents (\d+) 0 R", one)[1]]
        stream = content[content.index(b"stream\n") + 7 : content.rindex(b"\nendstream")]
        text = zlib.decompress(stream) if b"FlateDecode" in content else stream
        assert len(re.findall(rb"\bT[jJ]\b|\bDo\b", text)) >= 3


def table(page):
    """The rows of the overview that are shown: names and cells."""
    return [row.locator("td").all_inner_texts() for row in page.locator(".objects tbody tr").all()]


def download(page, name):
    with page.expect_download() as found:
        page.get_by_role("button", name=name, exact=True).click()
    return pathlib.Path(found.value.path()).read_text()


def test_a_cohort_is_sorted_searched_filtered_saved_and_printed(show, tmp_path):
    inputs = [f"phantom:ball?radius={4 + 0.02 * n:.2f}&shift=0.1,0.2,{0.01 * n:.2f}" for n in range(98)]
    # Of a flat box and of slices there are flags.
    inputs += ["phantom:ball?radius=7&spacing=1,1,3", "phantom:torus?major=7&minor=2.5&spacing=1,1,2.5"]
    page = show(*inputs, "--title", "cohort")
    assert (tmp_path / "report.html").stat().st_size < 6.5e6
    rows = table(page)
    assert len(rows) == 100
    records = {record["input"]: record for record in embedded(page)}
    # Of so many the surfaces are those that were measured.
    assert {record["curvature_sigma_mm"] for record in records.values()} == {None}
    page.get_by_role("button", name="volume mm³").click()
    page.get_by_role("button", name="volume mm³").click()
    shown = [row[1] for row in table(page)]
    values = [numbers(cell)[0] for cell in shown]
    assert values == sorted(values, reverse=True) and "±" in shown[0]
    page.get_by_role("searchbox").fill("torus")
    assert len(table(page)) == 1 and page.locator(".count").inner_text() == "1 of 100 objects"
    page.get_by_role("searchbox").fill("")
    page.locator(".chip[data-flag=thick-slices]").click()
    flagged = [name for name, record in records.items() if "thick-slices" in {f["code"] for f in record["flags"]}]
    assert len(table(page)) == len(flagged) == 2

    rows_of = lambda text: list(csv.reader(io.StringIO(text)))
    lines = rows_of(download(page, "CSV"))
    expected = rows_of(surfometry("measure", inputs[-2], inputs[-1], "--format", "csv"))
    assert lines[0] == expected[0] and len(lines) == 3
    untimed = lambda line: [cell for name, cell in zip(lines[0], line) if "seconds" not in name]
    assert sorted(map(untimed, lines[1:])) == sorted(map(untimed, expected[1:]))
    saved = json.loads(download(page, "JSON"))
    assert saved["schema"] == "surfometry.measure/2"
    assert sorted(result["input"] for result in saved["results"]) == sorted(flagged)
    # No object has a flag and none.
    unflagged = [name for name, record in records.items() if not record["flags"]]
    page.locator(".chip", has_text="no flags").click()
    assert len(table(page)) == len(unflagged) > 50
    assert page.locator(".chip[data-flag=thick-slices]").get_attribute("aria-pressed") == "false"
    page.locator(".chip", has_text="no flags").click()
    page.get_by_role("searchbox").fill("SLICES thick")
    assert len(table(page)) == 2
    page.get_by_role("searchbox").fill("")

    page.get_by_label("Distribution of").select_option("surface_area_mm2")
    assert page.locator(".overview .dot").count() == 100
    check_prints(page, 101, 12)
    page.locator(".objects tbody a").first.click()
    page.wait_for_selector("article[data-ready] .scene[data-drawn]", timeout=1000 * PATIENCE)
    assert colourful(pixels(page)) > 0.1
    page.get_by_role("link", name="← all objects").click()
    page.wait_for_selector(".overview")
    assert len(table(page)) == 100


@needs_data
def test_the_labels_of_a_scan_are_one_scene(show, tmp_path):
    started = time.monotonic()
    page = show(LABELS)
    print(f"made, opened, all labels drawn: {time.monotonic() - started:.1f} s")
    size = (tmp_path / "report.html").stat().st_size
    assert size < 12e6
    records = measure(LABELS)
    rows = table(page)
    assert len(rows) == len(records) == 61
    volumes = [numbers(row[1])[0] for row in rows]
    assert volumes == [pytest.approx(r["volume_mm3"], rel=0.01) for r in records]
    scene = pixels(page)
    assert colourful(scene) > 0.1
    # Click an object: its row is marked, and others fade; its row lets it go.
    y, x = map(float, np.argwhere(np.ptp(scene, axis=2) > 60)[2000])
    box = page.locator(".scene canvas").bounding_box()
    page.mouse.click(box["x"] + x, box["y"] + y)
    marked = page.locator(".objects tr.marked")
    assert marked.count() == 1 and colourful(pixels(page)) < 0.7 * colourful(scene)
    marked.locator("td").nth(1).click()
    page.mouse.move(5, 5)
    assert colourful(pixels(page)) == pytest.approx(colourful(scene), abs=0.02)


@needs_data
@pytest.mark.parametrize("path", [L4, TRABECULAR], ids=["L4", "trabecular"])
def test_real_objects_have_what_was_measured(show, path):
    page = show(path)
    (record,) = measure(path)
    (found,) = embedded(page)
    kept = record.keys() - {"read_seconds", "seconds", "flags", "curvature_sigma_mm"}
    assert {key: found.get(key) for key in kept} == {key: record[key] for key in kept}
    # Of the surface there may be one more, or more of what is said.
    for shown_flag, flag in zip(found["flags"], record["flags"], strict=False):
        assert shown_flag["code"] == flag["code"] and shown_flag["message"].startswith(flag["message"])
    assert len(found["flags"]) >= len(record["flags"])
    red, blue = shares(page)
    assert red > 0.02 and blue > 0.002
    check_prints(page, 2, 4)


def test_what_is_printed_fits_on_paper(show):
    page = show(TORUS)
    # Letter, without its margins.
    page.set_viewport_size({"width": 710, "height": 900})
    page.emulate_media(media="print")
    widths = page.evaluate("() => [document.documentElement, ...document.querySelectorAll('table')].map(e => e.getBoundingClientRect().right)")
    assert len(widths) > 2 and max(widths) <= 710
    page.emulate_media(media="screen")
    # A range that falls is marked, and changes nothing.
    page.set_viewport_size({"width": 1200, "height": 900})
    ends, key = page.locator("input.limit"), page.locator(".side .color-bar")
    before = key.inner_html()
    ends.first.fill("5")
    ends.last.fill("-5")
    ends.last.blur()
    assert ends.first.get_attribute("aria-invalid") == "true" and key.inner_html() == before
    ends.last.fill("6")
    ends.last.blur()
    assert ends.first.get_attribute("aria-invalid") == "false" and key.inner_html() != before


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
    labels = np.zeros((24, 24, 40), np.uint8)
    grid = np.moveaxis(np.indices(labels.shape), 0, -1)
    labels[np.linalg.norm(grid - [11.7, 12.1, 11.9], axis=-1) < 8] = 1
    labels[np.linalg.norm(grid - [11.7, 12.1, 28.2], axis=-1) < 7] = 2
    nib.save(nib.Nifti1Image(labels, np.eye(4)), tmp_path / "plain.nii")
    (tmp_path / "plain.nii").rename(tmp_path / name)
    (tmp_path / "names.csv").write_text(f"label,name\n1,{HOSTILE}\n2,<img src=x onerror=alert(2)>\n")
    page = show(tmp_path / name, "--names", tmp_path / "names.csv")
    assert page.title() == name and page.locator("h1").inner_text() == name
    assert HOSTILE in table(page)[0][0] and "onerror" in table(page)[1][0]
    page.locator(".objects tbody a").first.click()
    page.wait_for_selector("article[data-ready]", timeout=1000 * PATIENCE)
    assert HOSTILE in page.locator("h2").first.inner_text() and name in page.locator("dl").last.inner_text()
    assert page.locator("h1 *, code *, h2 script, img[onerror], main script").count() == 0
    assert [found["name"] for found in embedded(page)] == [HOSTILE, "<img src=x onerror=alert(2)>"]


def test_the_same_input_makes_the_same_page(tmp_path):
    pages = []
    for threads in ["1", "2"]:
        path = tmp_path / "page.html"
        surfometry("report", TORUS, JOINED, "--threads", threads, "-o", path)
        pages.append(path.read_text().replace(f"--threads {threads}", "--threads N"))
    assert pages[0] == pages[1]
    surfometry("report", "phantom:ball?radius=5", "--date", "a Monday", "-o", tmp_path / "dated.html")
    assert '"created":"a Monday"' in (tmp_path / "dated.html").read_text()
