"""Mistakes in laws of users: `register` refuses each with its line and a remedy."""

import numpy as np
import pytest
from user_laws import PLAIN

import ratestate as rs

#: the line of PLAIN that returns its rate, and the line before which attributes may be added
RETURN = "        return -V * theta / p.Dc * rs.laws.log(V * theta / p.Dc)\n"
FIRST = '    name = "plain"\n'
IMPORT = "import ratestate as rs"
X = "V * theta / p.Dc"
CONDITION = "if, and, or, not, min or max depends on V, theta or p. Use ratestate.laws: where("
PARAMETERS = """
    states = {"theta": ("b", "Dc"), "theta2": ("b3", "Dc3")}
    parameters = {
        "b3": rs.laws.Parameter("1", "evolution effect of the second state"),
        "Dc3": rs.laws.Parameter("m", "critical slip distance of the second state", "> 0"),
    }
"""


def message_of(law_file, text):
    """Return the message of `register` about a law file with this text; FILE is its path."""
    path = law_file(text, "plain.py")
    with pytest.raises(rs.ParameterError) as error:
        rs.register(path)
    return str(error.value).replace(str(path), "FILE")


@pytest.mark.parametrize(
    ("rate", "expected"),
    [
        (f"1 - {X} if V > p.V0 else -{X}", CONDITION),
        (f"1 - max({X}, 0.5)", CONDITION),
        (f"1 - {X} * (V > 1e-3 and V < 1)", CONDITION),
        (f"1 - {X} * (V != 0)", "V, theta or p is compared by == or !=. Compare by < or >."),
        (f"1 - math.sqrt({X})", "a function that takes plain numbers, such as math.exp, is given"),
        (f"1 - np.sqrt({X})", "numpy.sqrt is given V, theta or p. Use ratestate.laws.sqrt."),
        (f"1 - np.arcsinh({X})", "numpy.arcsinh is given V, theta or p. Use ratestate.laws.asinh."),
        (f"np.where(V > 1, 1, 1) - {X}", "numpy.where is given V, theta or p. Use ratestate.law"),
        (f"rs.laws.where(rs.laws.log({X}), 1, 2) - {X}", "the condition of where is a number. G"),
        (f"1 - p.sigma * {X}", "p.sigma is not a parameter. Add sigma to parameters, or take one"),
        (f"1 - {X} * Dc", "NameError: name 'Dc' is not defined. Correct the formula, which runs"),
        (f"1 - {X} + math.inf", "inf is not a finite number. Write formulas with numbers, V, thet"),
    ],
)
def test_lines_that_a_formula_must_not_have(law_file, rate, expected):
    text = PLAIN.replace(RETURN, f"        return {rate}\n")
    text = text.replace(IMPORT, "import math, numpy as np, ratestate as rs")
    assert message_of(law_file, text).startswith(f"law 'plain', line 8 of FILE: {expected}")


def test_a_mistake_in_a_function_of_the_file_has_the_line_of_the_function(law_file):
    text = PLAIN.replace(RETURN, f"        return 1 - larger({X})\n")
    text += "\ndef larger(x):\n    return x if x > 1 else 1\n"
    assert message_of(law_file, text).startswith(f"law 'plain', line 11 of FILE: {CONDITION}")


SIDES = "rs.laws.where(x < 0.5, 0.5 - x, rs.laws.where(x < 2, 0, 2 - x))"


@pytest.mark.parametrize(
    ("returned", "expected"),
    [
        (f"1 - {X}", "evolution returns None. Return the value of the formula."),
        (f"return 1 - {X}, 0.0", "evolution returns 2 rates, and states has 1. Return d theta/dt "),
        (f"return 1 > {X}", "evolution must return a number: a condition is not a number. Use"),
        ("return 'theta'", "evolution must return a number: 'theta' is not a finite number. Wri"),
        (f"return 1 + {X}", "theta has no steady value at V = 1e-12 m/s: d theta/dt has one sign"),
        (f"return {X} - 1", "theta has an unstable steady value at V = 1e-12 m/s: V theta/D near"),
        (
            f"return (1 - {X}) * (2 - {X}) * (3 - {X})",
            "theta has several steady values at V = 1e-12 m/s: V theta/D near 0.905 and 1.65 and",
        ),
        (f"x = {X}; return {SIDES}", "theta does not approach its steady value, because d theta/"),
        (
            f"return 1 - {X} * rs.laws.where(V > 1e-2, 0, 1)",
            "theta has no steady value at V = 0.0316 m/s: d theta/dt has one sign for all V",
        ),
        (
            f"return 1 - {X} * rs.laws.sqrt(V / 0.02 - 1 + 1e-16)",
            "evolution is infinite or NaN at V = 1e-12 m/s and V theta/D = 1.53e-09. Give another",
        ),
    ],
)
def test_rates_that_a_state_must_not_have(law_file, returned, expected):
    """The message has the line of the method."""
    text = PLAIN.replace(RETURN, f"        {returned}\n")
    assert message_of(law_file, text).startswith(f"law 'plain', line 7 of FILE: {expected}")


@pytest.mark.parametrize(
    ("friction", "expected"),
    [
        ("p.mu0", "friction returns None. Return the value of the formula."),
        ("return p.mu0 - p.a * rs.laws.log(V / p.V0)", "friction must rise with V at a constant"),
        ("return p.mu0 + p.b * rs.laws.log(theta)", "friction must rise with V at a constant sta"),
        ("return p.mu0 + p.a * rs.laws.log(V - 0.01)", "friction is infinite or NaN at V = 1e-12"),
    ],
)
def test_friction_that_a_law_must_not_have(law_file, friction, expected):
    text = PLAIN + f"\n    def friction(self, V, theta, p):\n        {friction}\n"
    assert message_of(law_file, text).startswith(f"law 'plain', line 10 of FILE: {expected}")


def test_a_state_that_depends_on_another_is_refused(law_file):
    rates = "1 - V * theta[0] / p.Dc, 1 - V * theta[1] / p.Dc3 * theta[0] / theta[1]"
    text = PLAIN.replace(FIRST, FIRST + PARAMETERS).replace(RETURN, f"        return {rates}\n")
    assert message_of(law_file, text) == (
        "law 'plain', line 13 of FILE: the rate of theta2 depends on theta. A state may depend on "
        "V and itself alone."
    )


OWN = "parameters = {{{}: rs.laws.Parameter({})}}"


@pytest.mark.parametrize(
    ("attribute", "expected"),
    [
        (
            'states = {"theta": ("b", "Dc"), "theta2": ("b2", "Dc2")}',
            "law 'plain': states['theta2'] = ('b2', 'Dc2') must be the symbols of b and Dc of",
        ),
        ('states = {"theta": "Dc"}', "law 'plain': states['theta'] = 'Dc' must be the symbols of"),
        ("states = {}", "law 'plain': states is empty. Leave it out for theta alone."),
        (
            'states = {"tau": ("b", "Dc")}',
            "law 'plain' of FILE: the name of its state 'tau' is used",
        ),
        (
            OWN.format("'K'", "'1', 'x'"),
            "law 'plain' of FILE: the name of its parameter 'K' is used",
        ),
        (
            OWN.format("'law'", "'1', 'x'"),
            "law 'plain' of FILE: the name of its parameter 'law' is",
        ),
        (
            OWN.format("'q'", "'furlong', 'x'"),
            "law 'plain' of FILE: its parameter q has an unknown unit",
        ),
        (
            OWN.format("'q'", "'m', 'x', '> 0', '3 kg'"),
            "law 'plain' of FILE: the example of its parameter q cannot be used: q = '3 kg' is a",
        ),
        ("def rates(self, v, w, psi, e, p): pass", "law 'plain' has the method rates, an old for"),
        ("def stiffness(self, kappa, p): return 2", "law 'plain' defines stiffness, a name that"),
        ("motion = {}", "law 'plain' defines motion, a name that"),
        ("name = 'slip'", "law 'slip' of FILE: the name 'slip' belongs to a built-in law. Choose"),
        ("name = 'ruina'", "law 'ruina' of FILE: the name 'ruina' belongs to a built-in law"),
        ("name = 'Plain law'", "Plain.name = 'Plain law' is not a name in small letters"),
        ("def __init__(self): exit(3)", "law of FILE cannot be made: SystemExit: 3"),
    ],
)
def test_attributes_that_a_law_must_not_have(law_file, attribute, expected):
    message = message_of(law_file, PLAIN.replace(FIRST, f"{FIRST}    {attribute}\n"))
    assert message.startswith(expected)


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (IMPORT, "import nothing_like_it", "line 2: ModuleNotFoundError: No m"),
        (IMPORT, f"{IMPORT}\n1 / 0", "line 3: ZeroDivisionError"),
        (IMPORT, f"{IMPORT}\nexit(3)", "line 3: SystemExit: 3. Co"),
        ("class Plain", "class Plain(:", "line 4: SyntaxError"),
        ("rs.FrictionLaw", "rs.Frictionlaw", "line 4: AttributeError: module 'ratestate' has no"),
        (
            "class Plain",
            "class E(Exception):\n    __str__ = None\nraise E()\nclass Plain",
            "line 6: E. Correct that line.",
        ),
        (
            "class Plain(rs.FrictionLaw)",
            "class T(type):\n    def __getattribute__(cls, name): 1 / 0\n\n"
            "class Plain(rs.FrictionLaw, metaclass=T)",
            "line 5: ZeroDivisionError",
        ),
    ],
)
def test_files_that_cannot_be_run(law_file, old, new, expected):
    message = message_of(law_file, PLAIN.replace(old, new))
    assert message.startswith(f"law file FILE cannot be loaded, {expected}")
    assert message.endswith(". Correct that line.")


def test_a_file_without_a_law(law_file):
    message = message_of(law_file, PLAIN.replace("(rs.FrictionLaw)", ""))
    assert message.startswith("law file FILE holds no law. It must hold one class")


def test_a_law_without_evolution(law_file):
    assert message_of(law_file, PLAIN.replace("evolution", "evolve")) == (
        "law 'plain' has no method evolution. Add evolution(self, V, theta, p), which returns d "
        "theta/dt."
    )


def test_deeply_nested_functions_give_an_answer_or_a_message(law_file):
    """There is no RecursionError, and the test takes seconds."""
    text = PLAIN.replace(
        RETURN,
        f"        x = {X}\n        for _ in range(100):\n            x = rs.laws.tanh(x)\n"
        "        return 0.1 - x\n",
    )
    slider = rs.SpringSlider(
        a=0.01, b=0.015, Dc=1e-5, sigma=1e6, K=1e9, law=rs.register(law_file(text, "plain.py"))
    )
    steady, slope = 0.1, 1.0
    for _ in range(100):
        slope *= 1.0 - steady**2
        steady = np.arctanh(steady)
    K_c = 0.005 * 1e6 / 1e-5 * slope  # (b - a) (sigma/Dc) times -d(d theta/dt)/d(V theta/Dc)
    assert slider.K_c(1e-3) == pytest.approx(K_c, rel=1e-9)
    assert message_of(law_file, text.replace("100", "5000")) == (
        "law 'plain': the formula nests too many functions. Write it with fewer."
    )
