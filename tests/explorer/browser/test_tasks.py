"""The guided tasks: each solved, and tried in ways that do not count."""

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

    def type(self, symbol, text):
        self.shown.type(symbol, text)
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


def test_contacts_heal(show):
    student = Student(show(), 1)
    assert student.shown.text("#tasks .measure") == (
        "The peak is 0.00379 high; in the end Vlp is 81.5 \u00b5m/s."
    )
    assert student.outcome == ""
    # a faster end, and other friction
    student.slide("V_lp", -3.5)
    assert student.outcome.startswith("The peak is higher because sliding ends faster.")
    student.type("b", "0.012")
    assert student.outcome == (
        "This task keeps b as it was: set it back to 0.004, or set the sliders anew."
    )
    assert student.done == [False]
    student.begin()
    # a kick has a peak, though nothing healed
    student.page.fill("#factor-kick", "20")
    student.page.click("#kick")
    student.shown.wait()
    assert student.outcome.startswith("A kick changes the speed alone: no contact has healed.")
    assert "The peak is 0.00" in student.shown.text("#tasks .measure")
    assert student.done == [False]
    student.begin()
    assert student.shown.entry("b") == "0.004"
    # no step up
    student.slide("V_lp", -5.3)
    assert "Sliding slows down at time 0 now" in student.outcome
    # 3 times as fast, then faster and faster: b ln 7.0 is not twice the first peak, b ln 7.4 is
    student.page.click("#step-V_lp")
    student.shown.wait()
    assert student.done == [False]
    assert student.outcome == ""
    student.slide("V_lp", -4.455)
    assert "The peak is 0.00747 high" in student.shown.text("#tasks .measure")
    assert student.done == [False]
    student.slide("V_lp", -4.43)
    assert student.done == [True]
    assert student.outcome.startswith("Contacts grow stronger with the logarithm of their age")
    assert student.page.is_visible("#task-next")
    # so do contacts that rest
    student.page.click("text=Forget what is done")
    student.begin()
    assert student.done == [False]
    student.page.click("#hold")
    student.shown.wait()
    assert student.done == [True]


def test_the_critical_stiffness_is_found_by_keyboard(show):
    student = Student(show(), 2)
    page = student.page
    # too stiff by more than two percent is not close
    student.type("K", "1.225 GPa/m")
    assert student.done == [False, False]
    student.type("K", "1.223 GPa/m")
    assert student.done == [False, True]
    page.click("text=Forget what is done")
    student = Student(student.shown, 2)
    student.slide("K", 9.3)
    assert "the edge is further down" in student.outcome
    # strengthening friction is steady too, but not what is sought
    student.type("b", "0.0049")
    assert student.outcome.startswith("This task keeps b as it was: set it back to 0.008")
    student.type("b", "0.008")
    page.select_option("#law", "aging")
    student.shown.wait()
    assert student.outcome.startswith("This task keeps law as it was: set it back to slip")
    assert student.done == [False, False]
    student.begin()
    assert page.input_value("#law") == "slip"
    student.slide("K", 9.07)  # 2.1 % below
    assert student.done == [False, False]
    seen = []
    for key in ("ArrowRight", "ArrowRight"):
        page.press("#slider-K", key)
        student.shown.wait()
        seen.append(student.done)
    assert seen == [[True, False], [True, True]]  # 0.96 % below, 0.19 % above
    assert student.outcome.startswith("A spring softer than Kc gives way too slowly")
    heard = page.get_attribute("#tasks [aria-current=true]", "aria-label")
    assert heard == "Task 2: Find the critical stiffness, done"
    assert page.get_attribute("#task-outcome", "role") == "status"


def test_slips_are_made_slow(show):
    student = Student(show(), 3)
    told = {}
    for symbol, power in (("V_lp", -5), ("V_lp", -2.5), ("V_lp", -4), ("M", 1.5), ("M", 4.9)):
        student.slide(symbol, power)
        told[symbol, power] = student.outcome
    assert told["V_lp", -5].startswith("Driven slower, it slips more seldom, but faster")
    assert told["V_lp", -2.5].startswith("This is vibration")
    assert told["V_lp", -4] == ""
    assert told["M", 1.5].startswith("A lighter block slips faster")
    assert told["M", 4.9].startswith("A heavier block slips more slowly")
    student.type("M", "0")
    assert student.outcome.startswith("Without mass nothing limits")
    student.begin()
    student.slide("K", 9)
    assert student.outcome.startswith("Now nothing slips at all")
    student.slide("K", 8.75)  # 0.937 K_c: stick-slip
    assert student.done == [False]
    student.slide("K", 8.765)  # 0.970 K_c: slow
    assert student.done == [True]
    assert student.outcome.startswith("Slips are slow just below Kc")


def test_sliding_is_steadied_by_speed_and_by_mass(show):
    student = Student(show(), 4)
    student.slide("V_lp", -1.9)
    assert student.outcome.startswith("That is more inertia")
    student.type("K", "2 GPa/m")
    assert student.outcome.startswith("This task keeps K as it was: set it back to 900 MPa/m")
    student.type("K", "900 MPa/m")
    student.type("b", "0.002")  # steady, and with another V_lp, but by friction
    assert student.outcome.startswith("This task keeps b as it was")
    assert student.done == [False, False]
    student.type("b", "0.006")
    student.slide("V_lp", -2.495)  # V_c = 3.162 mm/s: log10 is -2.5
    assert student.done == [False, False]
    student.slide("V_lp", -2.505)
    assert student.done == [True, False]
    student.slide("M", 2)
    assert student.outcome.startswith("Vlp and M are both changed. Bring one back: Vlp to 10 mm/s")
    assert student.done == [True, False]
    student.begin()
    assert student.done == [True, False]
    student.slide("M", 2.48)  # M_c = 300 kg/m^2: log10 is 2.477
    assert student.done == [True, False]
    student.slide("M", 2.475)
    assert student.done == [True, True]
    assert student.outcome.startswith("Inertia raises Kc")


def test_it_is_made_to_squeal(show):
    student = Student(show(), 5)
    assert student.shown.text("#tasks .measure") == ("f is 50.6 Hz, fn 87.2 Hz: quasi-harmonic.")
    student.slide("M", 1)
    assert student.outcome.startswith("It is silent: with \u03b7 = 0.00171")
    student.slide("V_lp", -1.2)  # 927 Hz
    assert student.outcome == ""
    assert student.done == [False]
    student.type("M", "1")
    student.type("V_lp", "3 m/s")  # 4.68 kHz
    assert student.outcome.startswith("That is too high for a squeal")
    student.type("V_lp", "1 mm/s")
    student.type("K", "100 MPa/m")
    assert student.outcome.startswith("It sticks and slips")
    assert student.done == [False]
    student.begin()
    student.slide("M", 1)
    student.slide("V_lp", -0.5)  # 1.39 kHz
    assert student.done == [True]
    assert student.outcome.startswith("Spring and block decide how high it squeals")


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
    student.type("K", "1.19 GPa/m")
    assert student.done == [True, False]
    page.wait_for_function("() => location.hash.includes('K=1.19+GPa')")
    page.reload()
    shown.wait()
    page.click("#tasks-open")
    assert shown.text("#task-title") == "2. Find the critical stiffness"
    assert student.done == [True, False]
    assert shown.entry("K") == "1.19 GPa/m" != before
    # what is done without having begun does not count
    student.type("K", "1.21 GPa/m")
    assert student.done == [True, False]
    student.begin()
    assert shown.entry("K") == before
    student.type("K", "1.21 GPa/m")
    assert student.done == [True, True]
    page.click("#task-next")
    assert shown.text("#task-title") == "3. Make it slow"
    assert page.evaluate("document.activeElement.id") == "task-start"
    page.click("text=Forget what is done")
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
            student.type("K", K)
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
    assert shown.text("#task-line") == "Task 2, 2 of 2 done. What was learnt is above."
