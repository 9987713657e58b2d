"""Sentences in pictures: symbols as mathematics, numbers as they are printed, lines that fit."""

import re
from bisect import bisect_right

from .labels import LETTERS, PREFIXES, STRESS, label
from .layout import text_width

#: symbols that sentences name; single letters that are words as well are not among them
SYMBOLS = (*LETTERS, "K_c", "V_c", "V_c_upper", "f_n", "V_from", "sigma_from", "K", "M", "V", "b")
_NAMED = "|".join(sorted(map(re.escape, SYMBOLS), key=len, reverse=True))
_SYMBOL = re.compile(rf"(?<![\w'\"$])(tau/sigma|{_NAMED})(?![\w'\"^])")
_POWER = re.compile(r"(\d)e([+-]?)0*(\d+)\b")
_MICRO = re.compile(r"(?<=\d )u(?=m|s|Hz)")


def mathematics(text):
    """A plain sentence with its symbols and powers of ten as mathematics."""
    text = _SYMBOL.sub(lambda found: STRESS if found[0] == "tau/sigma" else label(found[0]), text)
    text = _POWER.sub(lambda f: rf"{f[1]}$\cdot$10$^{{{f[2].strip('+')}{f[3]}}}$", text)
    text = _MICRO.sub(PREFIXES[-6], text)
    return text.replace("<=", r"$\leq$").replace("m^2", "m$^2$").replace("+-", r"$\pm$")


def wrapped(parts, width, size, joint=" "):
    """Texts one after another, in lines that are at most `width` wide if each text is [points]."""
    lines, rest = [], list(parts)
    while rest:
        counts = range(2, len(rest) + 1)
        n = 1 + bisect_right(counts, width, key=lambda k: text_width(joint.join(rest[:k]), size))
        lines.append(joint.join(rest[:n]))
        rest = rest[n:]
    return f"{joint.rstrip()}\n".join(lines)
