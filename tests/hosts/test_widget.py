# SPDX-License-Identifier: BSD-3-Clause
"""conus.widget with the real anywidget: its Python side without a kernel, its JavaScript in Chromium, between them the
interface that anywidget gives to a module (get, set, save_changes, on, off). JupyterLab itself is not run."""
import json
import os
import pathlib
import shutil
import subprocess

import pytest

import conus

widget = pytest.importorskip("conus.widget")
playwright = pytest.importorskip("playwright.sync_api")
CHROMIUM = os.environ.get("CHROMIUM") or shutil.which("chromium")
PAGE = pathlib.Path(os.environ.get("CONUS_PAGE", pathlib.Path(__file__).parents[2] / "build/node/apps/web/page.html"))

# A cell's view of a model: what Python has, and what the view sets.
HARNESS = """<!doctype html><body><script type="module">
const [module, state] = await window.begin();
const { default: { render } } = await import(URL.createObjectURL(new Blob([module], { type: "text/javascript" })));
const heard = new Map();
const model = {
  get: (name) => state[name],
  set(name, value) { state[name] = value; },
  save_changes: () => window.save(state.answer),
  on: (event, step) => heard.set(event, step),
  off: (event) => heard.delete(event),
};
window.take = (name, value) => { state[name] = value; heard.get(`change:${name}`)?.(); };
window.views = [];
window.show = () => { window.views.push(render({ model, el: document.body })); };
window.show();
</script>"""


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """Asks the program for the rows of a cone."""
    monkeypatch.chdir(tmp_path)
    subprocess.run([os.environ["CONUS"], "phantom", "nested", "-o", ".", "--size", "24"], check=True, capture_output=True)

    def ask(**question):
        words = [f"--{name}={value}" for name, value in question.items()]
        said = subprocess.run([os.environ["CONUS"], "query", "nested.nii.gz", *words, "-q", "--format=ndjson"],
                              check=True, capture_output=True, text=True)
        return [json.loads(row) for row in said.stdout.splitlines()]
    return ask


@pytest.mark.skipif(not CHROMIUM or not PAGE.exists(), reason="no Chromium, or no page (CONUS_PAGE)")
def test_a_cell_asks_and_hears(asked, tmp_path, monkeypatch):
    program = tmp_path / "bin" / "conus"  # which finds the page beside it
    program.parent.mkdir()
    shutil.copy(os.environ["CONUS"], program)
    shutil.copy(PAGE, program.parent / "page.html")
    monkeypatch.setenv("LD_LIBRARY_PATH", str(pathlib.Path(os.environ["CONUS"]).parents[2]))
    monkeypatch.setenv("CONUS", str(program))
    hits = conus.load("nested.nii.gz").select((0, 0, 90), toward=(0, 0, 0), angle=20)
    shown = widget.Widget(hits, height=600)
    first = {"origin": "0,0,90", "toward": "0,0,0", "angle": 20}
    assert shown.rows == asked(**first)
    assert shown.question == {"origin": "0,0,90", "toward": "0,0,0", "angle": "20", "layers": "visible", "resolution": "64"}
    assert shown.to_dataframe()["name"].tolist() == [row["name"] for row in asked(**first)]

    shown.ask(toward=(10, 5, 0))  # before it is shown
    shown.ask(angle=8.5)
    for what in ("rows", "question"):
        with pytest.raises(conus.Error, match="has not answered yet"):
            getattr(shown, what)

    with playwright.sync_playwright() as play:
        browser = play.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"])
        cell = browser.new_page(viewport={"width": 1280, "height": 1300})
        said, answers = [], []
        cell.on("pageerror", lambda error: said.append(str(error)))
        cell.on("request", lambda request: said.append(request.url) if request.url.startswith("http") else None)
        names = ("_page", "_asked", "answer", "height")
        cell.expose_function("begin", lambda: [shown._esm, {name: getattr(shown, name) for name in names}])

        def save(answer):
            answers.append(answer)
            shown.answer = answer
        cell.expose_function("save", save)
        shown.observe(lambda change: cell.evaluate("asked => window.take('_asked', asked)", change["new"]), "_asked")

        def wait():
            """Until the newest question has its answer."""
            for _ in range(600):
                if shown.answer["id"] == shown._asked["id"]:
                    return
                cell.wait_for_timeout(100)
            raise AssertionError(f"no answer: {said}")

        cell.set_content(HARNESS)
        wait()
        assert shown.rows == asked(origin="0,0,90", toward="10,5,0", angle=8.5)
        assert (shown.question["toward"], shown.question["angle"]) == ("10,5,0", "8.5")

        for question in ({"origin": "80,0,0", "toward": "0,3,0", "angle": 30, "layers": "all"},
                         {"origin": "80,0,0", "toward": "0,3,0", "angle": 30, "layers": "all", "range": "40,80", "resolution": 300},
                         {"origin": "80,0,0", "toward": "0,3,0", "angle": 5, "layers": "visible", "resolution": 17, "range": ""}):
            shown.ask(**question)
            with pytest.raises(conus.Error, match="has not answered yet"):
                shown.rows  # pylint: disable=pointless-statement
            wait()
            assert shown.rows == asked(**{name: value for name, value in question.items() if value != ""})

        shown.ask(radius=3)
        wait()
        with pytest.raises(conus.ArgumentError, match='"radius", which this page does not know'):
            shown.rows  # pylint: disable=pointless-statement
        shown.ask(radius=3, angle=171)
        wait()
        with pytest.raises(conus.ArgumentError):
            shown.rows  # pylint: disable=pointless-statement
        shown.ask(angle=20)
        wait()
        assert shown.rows == asked(origin="80,0,0", toward="0,3,0", angle=20, resolution=17)

        frame = cell.frames[1]
        with pytest.raises(playwright.Error):  # the page has no way into the notebook
            frame.evaluate("parent.document.title")
        count = len(answers)
        frame.locator("[name=angle]").fill("40")  # by hand
        for _ in range(600):
            if len(answers) > count and shown.question["angle"] == "40":
                break
            cell.wait_for_timeout(100)
        assert shown.rows == asked(origin="80,0,0", toward="0,3,0", angle=40, resolution=17)

        count = len(answers)
        cell.evaluate("window.views[0](); window.last = new Promise((done) => addEventListener('message', done)); 0")
        frame.locator("[name=angle]").fill("50")
        cell.evaluate("window.last.then(() => {})")  # the page says its answer; the view that is gone hears nothing
        assert len(answers) == count and said == []
        browser.close()
