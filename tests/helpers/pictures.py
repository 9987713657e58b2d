"""Pictures in words, to compare with how they were: no number of a layout changes unseen.

`pytest --draw-anew` writes the words anew where pictures are meant to change; look at the pictures
(`make figures`) and at the difference of tests/pictures before it is committed.
"""

import math

import numpy as np
from matplotlib.colors import to_hex
from matplotlib.patches import Patch
from matplotlib.ticker import FixedLocator
from paths import TESTS

FOLDER = TESTS / "pictures"


def described(fig):
    """Lines of words and numbers on all that a figure consists of, before it is drawn."""
    found = [f"figure {numbers(fig.get_size_inches())}", *texts([fig._suptitle])]
    insets = [inset for ax in fig.axes for inset in ax.child_axes]
    for ax in [*fig.axes, *insets]:
        spec = ax.get_subplotspec()
        place = f"rows {spec.rowspan} columns {spec.colspan}" if spec else numbers(ax.bbox.bounds)
        found += [f"axes {place} {ax.get_xscale()} {ax.get_yscale()} {ax.get_aspect()}"]
        if spec:
            grid = spec.get_gridspec()
            found += [f"  grid {grid.get_height_ratios()} {grid.get_width_ratios()}"]
        found += [f"  limits {numbers([*ax.get_xlim(), *ax.get_ylim()])}"]
        for axis in (ax.xaxis, ax.yaxis):
            if isinstance(axis.get_major_locator(), FixedLocator):
                found += [f"  ticks {numbers(axis.get_majorticklocs())}"]
        titles = [ax.title, ax._left_title, ax._right_title]
        found += texts([ax.xaxis.label, ax.yaxis.label, *titles, *ax.texts])
        found += dict.fromkeys(map(line_in_words, ax.lines))
        found += [shape_in_words(shape) for shape in [*ax.patches, *ax.collections][:40]]
        if legend := ax.get_legend():
            box = legend.get_bbox_to_anchor().bounds if legend._bbox_to_anchor else ()
            found += [f"  legend {legend._loc} {legend._ncols} {legend._fontsize} {len(box)}"]
            found += [f"    {text.get_text()}" for text in legend.get_texts()]
    return found


def numbers(values):
    return " ".join(f"{float(x):.5g}" for x in np.ravel(values))


def texts(found):
    for text in found:
        if text and (text.get_text() or getattr(text, "arrow_patch", None)):
            shift = numbers(getattr(text, "xy", ()))  # what an annotation points at
            look = f"{text.get_ha()} {text.get_va()} {text.get_fontsize():.3g} {text.get_color()}"
            if box := text.get_bbox_patch():
                look += f" boxed {box.get_boxstyle().pad} {color(box.get_facecolor())}"
            if arrow := getattr(text, "arrow_patch", None):
                look += f" arrow {arrow.get_linewidth():.3g} {color(arrow.get_edgecolor())}"
                look += f" short by {numbers([arrow.shrinkA, arrow.shrinkB])}"
            yield f"  text {text.get_text()!r} at {numbers(text.get_position())} {shift} {look}"


def color(value):
    return to_hex(value, keep_alpha=True)


def line_in_words(line):
    x, y = (values[np.isfinite(values)] for values in np.asarray(line.get_data(), float))
    ends = numbers([x.min(), x.max(), y.min(), y.max()]) if x.size and y.size else "nothing"
    look = f"{line.get_lw():.3g} {line.get_ls()} {line.get_marker()} {line.get_ms():.3g}"
    more = f"{color(line.get_color())} {line.get_alpha()} {line.get_zorder():.3g}"
    return f"  line of {min(len(line.get_xdata()), 50)} within {ends} {look} {more}"


def shape_in_words(shape):
    colors = (np.atleast_2d(c)[:1] for c in (shape.get_facecolor(), shape.get_edgecolor()))
    look = " ".join(color(c[0]) if c.size else "none" for c in colors)
    width = numbers(np.ravel(shape.get_linewidth())[:1])
    place = ""
    if isinstance(shape, Patch):
        path = shape.get_path().transformed(shape.get_patch_transform())
        place = numbers(path.get_extents().extents)
    name = type(shape).__name__
    return f"  {name} {place} {look} {width} {shape.get_hatch()} {shape.get_zorder():.3g}"


def same(old, new):
    """Whether two lines are the same, with numbers to 1 %."""
    if len(a := old.split(" ")) != len(b := new.split(" ")):
        return False
    return all(x == y or close(x, y) for x, y in zip(a, b, strict=True))


def close(x, y):
    try:
        return math.isclose(float(x), float(y), rel_tol=1e-2, abs_tol=1e-9)
    except ValueError:
        return False


def check(fig, name, anew):
    """Compare a figure with the words kept under this name; return it."""
    path, words = FOLDER / f"{name}.txt", described(fig)
    if anew:
        FOLDER.mkdir(exist_ok=True)
        path.write_text("\n".join(words) + "\n")
    kept = path.read_text().splitlines()
    other = [
        f"{old!r} is now {new!r}"
        for old, new in zip(kept, words, strict=False)
        if not same(old, new)
    ]
    assert not other, "\n".join(other)
    assert len(words) == len(kept)
    return fig
