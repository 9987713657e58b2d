"""Figures of what the page shows: files that open, curves that are the run's, legends."""

import functools
import re
from concurrent.futures import ThreadPoolExecutor
from xml.etree import ElementTree

import matplotlib as mpl
import numpy as np
import pytest

import ratestate as rs
from ratestate.plot.figures import overview
from ratestate_explorer import charts, entries, exports, figure, picture, wire
from ratestate_explorer.deadline import Deadline
from ratestate_explorer.menus import presets

STICK_SLIP = presets()[0]["entries"]
STEPPED = next(p["entries"] for p in presets() if p["name"] == "Step to just above V_c")
SLOWER = STEPPED | {"V_lp": "3 mm/s"}
PINNED = STEPPED, SLOWER, STEPPED | {"K": "800 MPa/m"}
RIGID = presets()[-1]["entries"]
CAPTION = "this slider"


@pytest.fixture(scope="module", autouse=True)
def small_maps():
    """Maps of few points, which are soon there."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(charts, "SIZES", (4, 5))
        yield


@pytest.fixture(scope="module")
def files():
    """Form of a file -> the file of a figure with a run behind, which is made once."""
    fig, _ = drawn(STICK_SLIP, STEPPED)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(figure, "figure_of", lambda *_: fig)
        return {form: file_of(form, STICK_SLIP, STEPPED) for form in exports.FIGURES}


@functools.cache
def _drawn(*questions):
    states = [entries.state_of(dict(texts)) for texts in questions]
    fig = figure.figure_of(states[0], states[1:], Deadline(60.0))
    return fig, fig.subfigs[0].axes + fig.subfigs[1].axes


def drawn(*questions):
    return _drawn(*(tuple(texts.items()) for texts in questions))


def file_of(form, texts, *pinned):
    return exports.export(wire.Question(1, form, texts, pinned=pinned), Deadline(60.0))["content"]


def by_label(ax):
    return {line.get_label(): line for line in ax.lines}


class TestCurves:
    def test_curves_equal_those_of_simulate(self):
        state = entries.state_of(STICK_SLIP)
        plan = picture.study_of(state, Deadline(60.0)).plan
        run = rs.simulate(plan.slider, **plan.settings, rtol=1e-6)
        _, (stress, speed, phase, _) = drawn(STICK_SLIP)
        spring, friction = stress.lines
        assert np.array_equal(spring.get_xdata(), run.time)
        assert np.allclose(spring.get_ydata(), run.tau / state.slider.sigma, rtol=1e-15)
        assert np.array_equal(friction.get_ydata(), run.mu)
        slip = by_label(speed)["slip"]
        assert np.allclose(slip.get_ydata(), 1e6 * run.V, rtol=1e-15)  # in the unit of V_lp
        assert "\N{GREEK SMALL LETTER MU}m/s" in speed.get_ylabel()
        lines = by_label(phase)
        assert np.array_equal(lines["run"].get_xdata(), spring.get_ydata())
        cycle = rs.limit_cycle(state.slider, state.V_lp)
        largest = lines["limit cycle"].get_ydata().max()
        assert largest == pytest.approx(1e6 * float(cycle.V_max), rel=1e-4)
        (x,), (y,) = lines["steady at $V_{lp}$"].get_data()
        assert y == pytest.approx(1e6 * state.V_lp)
        steady = state.slider.steady_stress(state.V_lp)
        assert x == pytest.approx(steady, rel=1e-12)

    def test_time_0_is_the_step_of_the_load_point_too(self):
        _, (_, speed, *_) = drawn(*PINNED)
        load = by_label(speed)["load point"]
        t, V = load.get_data()
        before, after = V[t < 0], V[t > 0]
        assert set(np.round(before, 9)) == {0.1}
        assert set(np.round(after, 9)) == {3.2}
        assert t[0] < 0 < t[-1]
        assert sum(t == 0) == 2

    def test_an_experiment_is_drawn_and_told(self):
        fig, (_, speed, *_) = drawn(STICK_SLIP | {"protocol": "0 m/s for 2 s; 20 um/s for 3.3 s"})
        t, V = by_label(speed)["load point"].get_data()
        held, slow = (t > 0) & (t < 2), (t > 2) & (t < 5.3)
        assert np.isnan(V[held]).all()  # at rest it has no place on a logarithmic axis
        assert np.allclose(V[slow], 0.02)
        caption = fig._suptitle.get_text().replace("\n", " ")
        assert "from time 0: 0 m/s for 2 s, 20 \N{GREEK SMALL LETTER MU}m/s for 3.3 s" in caption

    def test_the_map_has_the_slider(self):
        _, (*_, regimes) = drawn(STICK_SLIP)
        state = entries.state_of(STICK_SLIP)
        found = rs.stability(state.slider, state.V_lp)
        (x,), (y,) = by_label(regimes)[CAPTION].get_data()
        slider = state.slider
        assert x == pytest.approx(slider.K / (slider.sigma * (slider.b - slider.a) / slider.Dc))
        assert y == pytest.approx(slider.M * state.V_lp**2 / (slider.sigma * slider.a * slider.Dc))
        assert x == pytest.approx(slider.K / float(found.K_c), rel=1e-3)

    def test_a_slider_beyond_the_map_is_at_its_edge(self):
        _, (*_, regimes) = drawn(RIGID)
        (x,), (y,) = by_label(regimes)[f"{CAPTION}, beyond the map"].get_data()
        assert (x, y) == (regimes.get_xlim()[1], regimes.get_ylim()[0])

    def test_without_a_chart_there_are_three_panels(self):
        strengthening = STICK_SLIP | {"a": "0.01"}
        assert len(drawn(strengthening)[1]) == 3
        two_lengths = STICK_SLIP | {"law": "two-state-slip", "b2": "0.001", "Dc2": "1 um"}
        assert charts.key_of(entries.state_of(two_lengths).slider) == ("two-state-slip",)

    def test_a_run_that_takes_too_long_is_said(self):
        with pytest.raises(rs.ParameterError, match="No run of"):
            figure._motion(entries.state_of(STICK_SLIP), _Late(60.0))


class _Late(Deadline):
    """Time that is up in every run, but not before."""

    def record(self, fraction):
        self.seconds = 0.0


class TestPinned:
    def test_pinned_runs_are_named_in_the_legend(self):
        fig, (stress, speed, phase, _) = drawn(*PINNED)
        names = [text.get_text() for text in fig.legends[0].get_texts()]
        assert names == [
            "the run shown",
            "$K$ = 900 MPa/m, $V_{lp}$ = 3 mm/s",
            "$K$ = 800 MPa/m, $V_{lp}$ = 3.2 mm/s",
        ]
        for ax in (stress, speed, phase):
            colors = {line.get_color(): line.get_zorder() for line in ax.lines}
            assert all(colors[muted] < 2 for muted in overview.MUTED[:2])
        plan = picture.study_of(entries.state_of(SLOWER), Deadline(60.0)).plan
        run = rs.simulate(plan.slider, **plan.settings, rtol=1e-6)
        slower = next(x for x in stress.lines if x.get_color() == overview.MUTED[0])
        n = slower.get_xdata().size
        assert np.allclose(slower.get_ydata(), (run.tau / plan.slider.sigma)[:n], rtol=1e-14)
        shown = stress.lines[0].get_xdata()
        assert slower.get_xdata().max() <= shown.max()

    def test_a_figure_has_at_most_three_pinned_runs(self):
        text = '{"id": 1, "ask": "svg", "entries": {}, "pinned": [%s]}'
        assert len(wire.checked(wire.Question, text % "{}, {}, {}").pinned) == 3
        for wrong in (text % "{}, {}, {}, {}", text.replace("[%s]", '"many"')):
            with pytest.raises(wire.BadQuestion, match="pinned"):
                wire.checked(wire.Question, wrong)


def _told(svg):
    """An SVG without its ids, to a hundredth of a point: the layout is solved to rounding."""
    text = re.sub(r"#?p[0-9a-f]{10}", "", svg.decode())
    return re.sub(r"\d+\.\d+", lambda found: f"{float(found[0]):.2f}", text)


class TestFiles:
    def test_legends_and_captions_are_in_the_svg(self, files):
        text = files["svg"].decode()
        root = ElementTree.fromstring(text)
        assert root.tag == "{http://www.w3.org/2000/svg}svg"
        said = "\n".join(re.findall("<!-- (.*?) -->", text, re.DOTALL))
        for name in (r"$\mu$, friction", "load point", "slip", "limit cycle", "run", "steady"):
            assert name in said
        for name in ("stick-slip", CAPTION, "Stick-slip, a cycle every 2.385 s", "4 MPa"):
            assert name in said
        assert "<text" not in text  # letters are outlines, the same on every machine
        assert "V_lp=100+um%2Fs" in text.replace("&amp;", "&")  # and it says how to make it again

    def test_the_pdf_has_one_page_and_its_fonts(self, files):
        content = files["pdf"]
        assert content.startswith(b"%PDF-1.")
        assert content.count(b"/Type /Page\n") + content.count(b"/Type /Page ") == 1
        fonts = re.findall(rb"/FontFile2|/FontFile3|/FontFile", content)
        assert fonts
        assert set(fonts) == {b"/FontFile2"}  # TrueType, whole
        assert b"/Type3" not in content

    def test_two_at_once_are_as_each_alone(self):
        both = [STICK_SLIP | {"a": "0.01", "M": M} for M in ("0", "100")]  # without a map
        alone = [_told(file_of("svg", texts)) for texts in both]
        before = dict(mpl.rcParams)
        with ThreadPoolExecutor(2) as pool:
            jobs = [pool.submit(file_of, "svg", texts) for texts in both]
            found = [_told(job.result()) for job in jobs]
        assert found == alone
        assert dict(mpl.rcParams) == before

    def test_title_axes_and_legend_of_the_figure_do_not_overlap(self):
        beyond = STICK_SLIP | {"law": "aging", "K": "0.1 MPa/m"}  # the longest legend of a map
        for questions in (PINNED, [beyond]):
            fig, axes = drawn(*questions)
            fig.draw_without_rendering()
            boxes = [
                fig._suptitle.get_window_extent(),
                *(x.get_window_extent() for x in fig.legends),
            ]
            for ax in axes:
                boxes += [ax.get_legend().get_window_extent(), ax.xaxis.label.get_window_extent()]
                boxes += [ax.yaxis.label.get_window_extent(), ax._left_title.get_window_extent()]
                boxes.append(ax.get_window_extent())
            boxes = [box for box in boxes if box.width * box.height > 0]
            for i, box in enumerate(boxes):
                assert box.x0 >= 0
                assert box.x1 <= fig.bbox.width
                for other in boxes[:i]:
                    assert not box.padded(-1).overlaps(other.padded(-1)), questions
