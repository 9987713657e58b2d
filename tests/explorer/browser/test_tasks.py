"""The guided tasks: each solved, and tried in ways that do not count."""

import pytest

TITLES = [
    "Let the contacts heal",
    "Find the critical stiffness",
    "Make it slow",
    "Stop it without touching the spring",
    "Make it squeal",
]


class Student:
    """Someone who works on a task of a page."""

    def __init__(self, shown, number):
        self.shown, self.page = shown, shown.page
        if self.page.is_hidden("#tasks"):
            self.page.click("#tasks-open")
        self.page.click(f"#tasks [aria-label^='Task {number}:']")
        self.begin()

    def begin(self):
        self.page.click("#task-start")
        self.shown.wait()

    def slide(self, symbol, power):
        """Bring a slider to a power of ten of the SI unit."""
        self.page.fill(f"#slider-{symbol}", str(power))
        self.shown.wait()

    @property
    def done(self):
        """Of each of its goals, whether it is reached."""
        return self.page.eval_on_selector_all(
            "#tasks .goals li", "all => all.map(e => e.classList.contains('done'))"
        )

    @property
    def outcome(self):
        return self.shown.text("#task-outcome")

    def act(self, way):
        """Do what a way says: "V_lp -3.5" moves a slider, "K = 2 GPa/m" types, "#kick" clicks."""
        symbol, *words = way.split(" ", 2)
        if way == "begin":
            self.begin()
        elif way.startswith(("#", "text=")):
            self.page.click(way)
            self.shown.wait()
        elif words[0] == "=":
            self.shown.set(symbol, words[1])
        else:
            self.slide(symbol, words[0])


#: task -> what is done, one after the other; how what is told of it begins,
#: None if that does not matter; which goals are reached
WAYS = {
    1: [
        ("V_lp -3.5", "The peak is higher because sliding ends faster.", [False]),
        ("b = 0.012", "This task does not allow a change of b. Set it back to 0.004", [False]),
        ("begin", None, [False]),
        ("#kick", "A kick changes only the speed: no contact has healed.", [False]),
        # b ln 7.0 is not twice the first peak, b ln 7.4 is
        ("begin", None, [False]),
        ("V_lp -5.3", "Sliding slows down at time 0 now", [False]),
        ("#step-V_lp", "", [False]),
        ("V_lp -4.455", None, [False]),
        ("V_lp -4.43", "Contacts grow stronger with the logarithm of their age", [True]),
        ("text=Reset progress", None, [False]),
        ("begin", None, [False]),
        ("#hold", "Contacts grow stronger with the logarithm of their age", [True]),
    ],
    2: [
        ("K = 1.225 GPa/m", None, [False, False]),  # stiffer by more than two percent
        ("K = 1.223 GPa/m", None, [False, True]),
        ("text=Reset progress", "", [False]),
        ("#tasks [aria-label^='Task 2:']", None, [False, False]),
        ("begin", None, [False, False]),
        ("K 9.3", None, [False, False]),
        ("begin", None, [False, False]),
        ("K 9.07", None, [False, False]),  # 2.1 % below
        ("K 9.075", None, [True, False]),  # 0.96 % below
        ("K 9.08", "If the spring is softer than Kc, friction falls", [True, True]),  # 0.19 % above
    ],
    3: [
        ("V_lp -5", "At a lower Vlp it slips less often, but faster", [False]),
        ("V_lp -2.5", "This is vibration", [False]),
        ("V_lp -4", "", [False]),
        ("M 1.5", "A lighter block slips faster", [False]),
        ("M 4.9", "A heavier block slips more slowly", [False]),
        ("M = 0", "Without mass nothing limits", [False]),
        ("begin", None, [False]),
        ("K 9", "Now the block slides steadily", [False]),
        ("K 8.75", None, [False]),  # 0.937 K_c: stick-slip
        ("K 8.765", "Slips are slow just below Kc", [True]),  # 0.970 K_c
    ],
    4: [
        ("V_lp -1.9", "This is more inertia", [False, False]),
        ("K = 2 GPa/m", "This task does not allow a change of K. Set it back", [False, False]),
        ("K = 900 MPa/m", None, [False, False]),  # steady, but by friction
        ("V_lp -2.495", None, [False, False]),  # V_c = 3.162 mm/s: log10 is -2.5
        ("V_lp -2.505", None, [True, False]),
        ("M 2", "Vlp and M are both changed. Set one back: Vlp to 10 mm/s", [True, False]),
        ("begin", None, [True, False]),
        ("M 2.48", None, [True, False]),  # M_c = 300 kg/m^2: log10 is 2.477
        ("M 2.475", "Inertia raises Kc", [True, True]),
    ],
    5: [
        ("M 1", "It is silent: with \u03b7 = 0.00171", [False]),
        ("V_lp -1.2", "", [False]),  # 927 Hz
        ("M = 1", None, [False]),
        ("V_lp = 3 m/s", "That is too high for a squeal", [False]),  # 4.68 kHz
        ("V_lp = 1 mm/s", None, [False]),
        ("K = 100 MPa/m", "It sticks and slips", [False]),
        ("begin", None, [False]),
        ("M 1", None, [False]),
        ("V_lp -0.5", "K/M decides the pitch", [True]),  # 1.39 kHz
    ],
}


@pytest.mark.parametrize("number", WAYS)
def test_a_task_is_solved_and_tried_in_ways_that_do_not_count(number, show):
    student = Student(show(), number)
    for way, outcome, done in WAYS[number]:
        student.act(way)
        if outcome == "":
            assert student.outcome == "", way
        assert student.outcome.startswith(outcome or ""), way
        assert student.done == done, way


def test_what_is_measured_and_heard_of_a_task(show):
    student = Student(show(), 1)
    page = student.page
    told = "The peak is 0.00379 high. Vlp ends at 81.5 \u00b5m/s."
    assert student.shown.text("#tasks .measure") == told
    assert student.outcome == ""
    student = Student(student.shown, 5)
    assert student.shown.text("#tasks .measure") == "f is 50.6 Hz, fn 87.2 Hz: quasi-harmonic."
    student = Student(student.shown, 2)
    page.select_option("#law", "aging")
    student.shown.wait()
    assert student.outcome.startswith("This task does not allow a change of law. Set it back to")
    student.begin()
    assert page.input_value("#law") == "slip"
    student.slide("K", 9.07)
    for _ in range(2):
        page.press("#slider-K", "ArrowRight")
        student.shown.wait()
    assert student.done == [True, True]
    heard = page.get_attribute("#tasks [aria-current=true]", "aria-label")
    assert heard == "Task 2: Find the critical stiffness, done"
    assert page.get_attribute("#task-outcome", "role") == "status"


def test_progress_lasts_as_long_as_the_tab_and_can_be_forgotten(show):
    shown = show()
    page = shown.page
    assert page.get_attribute("#tasks-open", "aria-expanded") == "false"
    before = shown.entry("K")
    student = Student(shown, 2)
    titles = page.eval_on_selector_all(
        ".choices button[aria-label]", "all => all.map(e => e.ariaLabel)"
    )
    assert titles == [f"Task {i + 1}: {title}" for i, title in enumerate(TITLES)]
    assert page.get_attribute("#tasks-open", "aria-expanded") == "true"
    student.shown.set("K", "1.19 GPa/m")
    assert student.done == [True, False]
    page.wait_for_function("() => location.hash.includes('K=1.19+GPa')")
    page.reload()
    shown.wait()
    page.click("#tasks-open")
    assert shown.text("#task-title") == "2. Find the critical stiffness"
    assert student.done == [True, False]
    assert shown.entry("K") == "1.19 GPa/m" != before
    # what is done without having begun does not count
    student.shown.set("K", "1.21 GPa/m")
    assert student.done == [True, False]
    student.begin()
    assert shown.entry("K") == before
    student.shown.set("K", "1.21 GPa/m")
    assert student.done == [True, True]
    page.click("#task-next")
    assert shown.text("#task-title") == "3. Make it slow"
    assert page.evaluate("document.activeElement.id") == "task-start"
    page.click("text=Reset progress")
    page.reload()
    shown.wait()
    page.click("#tasks-open")
    assert shown.text("#task-title") == "1. Let the contacts heal"
    assert page.locator(".choices .done").count() == 0
    # what the browser kept for other tasks is not taken
    page.evaluate("sessionStorage.setItem('tasks', '{\"index\": 9, \"reached\": {}}')")
    page.reload()
    shown.wait()
    page.click("#tasks-open")
    assert page.inner_text("#task-title") == "1. Let the contacts heal"


def test_a_task_whose_first_picture_was_overtaken_begins_again(modules):
    begun = modules.evaluate(
        """async () => { const { Tasks } = await import('/js/lessons/tasks.js');
        const begun = [], seen = [];
        const strip = { listen: on => (strip.on = on), tell: ({ isBegun }) => seen.push(isBegun) };
        const presets = [{ name: 'Velocity step, rigid drive', entries: { a: '0.003' } }];
        const begin = texts => 10 * begun.push(texts.a);
        const tasks = new Tasks(strip, [], presets, begin);
        const picture = id => ({ id, values: { V_lp: 1 }, numbers: { regime: 'steady' },
            arrays: { run_time: [0], run_mu: Float64Array.of(0.6) } });
        strip.on.start(0);
        tasks.show(picture(9));   // of before
        tasks.show(picture(11));  // of what was moved since
        await Promise.resolve();
        tasks.show(picture(20));
        return [begun, seen] }"""
    )
    assert begun == [["0.003", "0.003"], [False, True]]


def test_nothing_moves_while_a_task_is_worked_on(show):
    shown = show()
    page = shown.page
    for width, height in ((390, 844), (1024, 768), (1440, 900)):
        page.set_viewport_size({"width": width, "height": height})
        student = Student(shown, 2)
        page.wait_for_timeout(600)  # (what a click moves counts as moved by it for half a second)
        shown.watch_shifts()
        for K in ("2 GPa/m", "1.19 GPa/m", "1.21 GPa/m"):
            student.shown.set("K", K)
            page.wait_for_timeout(100)
        assert student.done == [True, True]
        assert shown.shifts == [], width
        if width >= 1151:
            assert page.locator("#speed-chart").bounding_box()["height"] > 150
        assert page.evaluate("document.documentElement.scrollWidth") == width


def test_on_a_phone_the_task_is_told_while_the_strip_is_out_of_sight(show):
    shown = show(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True)
    page = shown.page
    page.tap("#tasks-open")
    page.tap("#tasks [aria-label^='Task 2:']")
    page.tap("#task-start")
    shown.wait()
    assert page.is_hidden("#task-line")
    range_ = page.locator("#slider-K")
    range_.scroll_into_view_if_needed()
    page.wait_for_selector("#task-line:not([hidden])")
    assert shown.text("#task-line") == "Task 2, 0 of 2 done. K/Kc is 0.8: stick-slip."
    box = range_.bounding_box()
    thumb = page.evaluate(
        "() => parseFloat(getComputedStyle(document.documentElement).fontSize) * 1.4"
    )
    for share in (2.0745 / 4, 2.0815 / 4):  # decades from 10 MPa/m, of 4
        page.touchscreen.tap(
            box["x"] + thumb / 2 + share * (box["width"] - thumb), box["y"] + box["height"] / 2
        )
        shown.wait()
    assert shown.text("#task-line") == "Task 2, 2 of 2 done. The explanation is above."
