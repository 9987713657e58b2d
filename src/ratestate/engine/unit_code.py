"""The units of a law as LLVM text, by running them once with numbers that write code (code.py).

===========================  =======================================================
``void f(s, n)``             of lanes: over n vectors of them, from the column s on
``void f(s, given, found)``  of the lane at s: numbers that it is given, and finds
===========================  =======================================================
"""

from .code import Code
from .rows import FOUND, WORK
from .units import lane_units, point_units


class _Lane:
    """The lane buffer as units see it: a row of it is loaded once, and stored at the end."""

    def __init__(self, code, start):
        self.code, self._start, self._rows, self._stored = code, start, {}, {}

    def __getitem__(self, row):
        if row not in self._rows:
            self._rows[row] = self.code.load(self._start, row)
        return self._rows[row]

    def __setitem__(self, row, value):
        self._rows[row] = self._stored[row] = self.code.number(value)

    def store(self):
        """Write the code that stores what was set."""
        for row, value in self._stored.items():
            self.code.store(value, self._start, row)


def unit_text(law, kind, width):
    """LLVM text of all units of a law.

    kind : their class (units.py); width : doubles of a vector
    """
    texts: dict[str, str] = {}
    declarations: dict[str, str] = {}
    for name, bodies in lane_units(law, kind).items():
        loops = []
        for k, body in enumerate(bodies):
            code = Code(width, f"v{k}.")
            lane = _Lane(code, f"%lane{k}")
            body(lane, 0, law)
            lane.store()
            loops.append(code.lines)
            declarations |= code.declarations
        texts[name] = _loops(name, loops, width)
    for name, (body, count) in point_units(law, kind).items():
        code = Code(1)
        lane = _Lane(code, "%s")
        found = body(lane, 0, law, *(code.load("%given", k) for k in range(count)))
        lane.store()
        if count > FOUND or len(found) > WORK - FOUND:
            raise ValueError(f"law = {law.name!r} has too many states: {len(law.states)}")
        for k, value in enumerate(found):
            code.store(code.number(value), "%found", k)
        lines = "\n  ".join([*code.lines, "ret void"])
        texts[name] = f"define void @{name}(ptr %s, ptr %given, ptr %found) {{\n  {lines}\n}}"
        declarations |= code.declarations
    return "\n".join([*declarations.values(), *texts.values(), ""])


def _loops(name, loops, width):
    """A function whose loops over vectors of lanes have these lines."""
    head = f"define void @{name}(ptr %s, i64 %n) {{\n"
    text = ["%some = icmp sgt i64 %n, 0", "br i1 %some, label %enter0, label %done"]
    for k, lines in enumerate(loops):
        after = "done" if k + 1 == len(loops) else f"enter{k + 1}"
        text += [
            f"enter{k}:",
            f"br label %loop{k}",
            f"loop{k}:",
            f"%i{k} = phi i64 [ 0, %enter{k} ], [ %next{k}, %loop{k} ]",
            f"%at{k} = mul i64 %i{k}, {width}",
            f"%lane{k} = getelementptr double, ptr %s, i64 %at{k}",
            *lines,
            f"%next{k} = add i64 %i{k}, 1",
            f"%more{k} = icmp slt i64 %next{k}, %n",
            f"br i1 %more{k}, label %loop{k}, label %{after}",
        ]
    return head + "\n".join([*text, "done:", "ret void", "}"])
