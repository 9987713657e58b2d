"""The page as one HTML file: all of its own files in it, and the answers that it shows."""

import base64
import json
import re

import numpy as np
import pytest
from explorer_server import read

import ratestate as rs
from ratestate.interfaces.cli import main
from ratestate_explorer import branch, bundle, charts, entries, exports, picture, wire
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.menus import presets

STICK_SLIP = presets()[0]["entries"]
VIBRATION = presets()[1]["entries"]


@pytest.fixture(autouse=True)
def small_maps(monkeypatch):
    """Maps of few points, which are soon there."""
    monkeypatch.setattr(charts, "SIZES", (4, 5))


def recorded(text):
    """What was asked, and the answers by hand: header and arrays."""
    data = re.search(r'id="recording">(.*?)</script>', text, re.DOTALL)[1]
    rows = json.loads(data)
    return [(row["ask"], row["entries"], *read(base64.b64decode(row["answer"]))) for row in rows]


class TestRecording:
    def test_a_saved_page_has_the_answers_of_the_server(self):
        rows = recorded(exports.standalone(STICK_SLIP, [VIBRATION], Deadline(60.0)))
        asked = ["hello", "picture", "picture", "chart", "branch", "branch", "branch"]
        assert [row[0] for row in rows] == asked
        for row, texts in zip(rows[1:3], (STICK_SLIP, VIBRATION), strict=True):
            header, arrays = picture.picture(entries.state_of(texts), Deadline(60.0))
            assert row[1] == texts
            assert row[2]["sentences"] == list(header["sentences"])
            assert all(np.array_equal(row[3][name], arrays[name]) for name in arrays)
        assert rows[3][2]["size"] in charts.SIZES
        along = [row[2]["along"] for row in rows[4:]]
        assert along == list(branch.ALONG)
        header, arrays = branch.branch(entries.state_of(STICK_SLIP), "K", Deadline(60.0))
        assert rows[4][2]["hopf"] == list(header["hopf"])
        assert all(np.array_equal(rows[4][3][name], arrays[name]) for name in arrays)
        hello = rows[0][2]
        assert [start["entries"] for start in hello["presets"]] == [STICK_SLIP]
        assert hello["live"].startswith("http://127.0.0.1:8765/#a=0.005&b=0.008&")

    def test_ranges_of_controls_are_about_usual_values_if_M_is_0_or_K_is_inf(self):
        rigid = VIBRATION | {"M": "0 kg/m^2", "K": "inf Pa/m"}
        hello = recorded(exports.standalone(rigid, [], Deadline(60.0)))[0][2]
        usual = {field["symbol"]: field["usual"] for field in hello["fields"]}
        assert (usual["M"], usual["K"]) == (100.0, 9.6e8)

    def test_the_map_is_the_finest_that_is_soon_there(self, monkeypatch):
        monkeypatch.setattr(charts, "KNOWN", 0.0)
        slider = entries.state_of(STICK_SLIP | {"b": "0.00812"}).slider
        monkeypatch.setattr(charts, "SIZES", (4, 72))
        assert charts.size_in_time(slider, Deadline(60.0)) == 4
        charts.survey(*charts.key_of(slider), 5)
        monkeypatch.setattr(charts, "SIZES", (4, 5))
        assert charts.size_in_time(slider, Deadline(60.0)) == 5
        monkeypatch.setattr(charts, "SIZES", (71, 72))
        assert charts.size_in_time(slider, Deadline(0.0)) is None

    def test_the_server_gives_it_as_a_file(self):
        question = wire.Question(1, "page", STICK_SLIP, pinned=(VIBRATION,))
        file = exports.export(question, Deadline(60.0))
        assert (file["name"], file["type"]) == ("ratestate.html", "text/html")
        assert [row[0] for row in recorded(file["content"].decode())].count("picture") == 2
        question = wire.Question(1, "page", STICK_SLIP, pinned=(VIBRATION | {"K": "-1"},))
        with pytest.raises(rs.ParameterError, match="kept for comparison: K = '-1 Pa/m'"):
            exports.export(question, 1)


class TestFile:
    def test_a_saved_page_loads_no_other_file(self):
        text = exports.standalone(STICK_SLIP, [], Deadline(60.0))
        assert not re.search(r'(?:src|href)="(?!data:|http://127\.0\.0\.1:8765/#)', text)
        policy = re.search(r'Content-Security-Policy" content="([^"]+)"', text)[1]
        assert policy.startswith("default-src 'none'; script-src 'sha256-")
        assert "unsafe" not in policy
        assert text.count("<script") == 2
        assert text.index("Content-Security-Policy") < text.index("<style")
        assert f"by ratestate {rs.__version__}" in text
        assert 300_000 < len(text) < 700_000

    def test_texts_cannot_end_their_element(self):
        text = exports.standalone(STICK_SLIP | {"note": "</script><b>"}, [], Deadline(60.0))
        assert "</script><b>" not in text
        assert text.count("</script>") == 2
        assert recorded(text)[1][1]["note"] == "</script><b>"

    def test_a_saved_page_is_written_whole_or_not_at_all(self, tmp_path, monkeypatch):
        path = tmp_path / "page.html"
        path.write_text("before")
        with pytest.raises(rs.ParameterError, match=r"ends in \.html"):
            exports.save_page(tmp_path / "page.png", STICK_SLIP)
        monkeypatch.setattr(exports, "bundle", lambda *_: "\ud800")  # cannot be encoded
        with pytest.raises(UnicodeEncodeError):
            exports.save_page(path, STICK_SLIP)
        assert [file.name for file in tmp_path.iterdir()] == ["page.html"]
        assert path.read_text() == "before"

    def test_explore_save_writes_a_page(self, tmp_path, capsys):
        path = tmp_path / "rig.html"
        with pytest.raises(SystemExit) as done:
            main(["explore", "--save", str(path)])
        assert done.value.code in (0, None)
        assert recorded(path.read_text())[1][1] == STICK_SLIP
        assert f"wrote {path}" in capsys.readouterr().err


class TestBundle:
    def test_every_module_is_in_it_once(self):
        code = bundle._script("js/main.js")
        used = {path.name for path in (bundle.STATIC / "js").rglob("*.js")} | {"uPlot.js"}
        assert len(re.findall(r"^const module\d+ = ", code, re.MULTILINE)) == len(used)
        assert not re.search(r"^(import|export)\b", code, re.MULTILINE)
        assert code.count("Copyright (c) 2025, Leon Sorokin") == 1

    @pytest.mark.parametrize(
        "line",
        [
            "export let count = 0;\n",
            'const a = await import("./b.js");\n',
            'export * from "./b.js";\n',
        ],
    )
    def test_what_cannot_be_put_into_one_file_is_refused(self, line, tmp_path, monkeypatch):
        (tmp_path / "main.js").write_text(line)
        monkeypatch.setattr(bundle, "STATIC", tmp_path)
        with pytest.raises(ValueError, match=r"main\.js: .* cannot be put into one file"):
            bundle._script("main.js")
