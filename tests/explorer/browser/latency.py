"""From a slider's movement to its picture, in the browser; and the page's memory.

``python tests/interfaces/explorer/browser/latency.py`` measures eight cases, 100 key presses each,
and the heap before and after 1,000 presses, on a machine that does nothing else.
"""

import contextlib
import statistics
import sys

NAME = "slider-to-drawn"
PRESS = f"() => performance.getEntriesByName('{NAME}').length"
TIMES = f"() => performance.getEntriesByName('{NAME}').map(entry => entry.duration)"
RESTED = "() => document.querySelector('#regimes').innerText.includes('72')"
STICK_SLIP = "a=0.005&b=0.008&Dc=10 um&sigma=4 MPa&M=100 kg/m^2&K=0.96 GPa/m&V_lp=10 um/s"
FIG2 = "a=0.003&b=0.006&Dc=10 um&sigma=2 MPa&M=3000 kg/m^2&K=900 MPa/m&V_lp=3.2 mm/s"
CASES = {
    "stick-slip": f"{STICK_SLIP}&mu0=0.6&V0=1 nm/s&law=slip",
    "stick-slip, aging law": f"{STICK_SLIP}&mu0=0.6&V0=1 nm/s&law=aging",
    "quasi-harmonic": f"{FIG2}&mu0=0.6&V0=1 nm/s&law=slip",
    "quasi-harmonic, aging law": f"{FIG2}&mu0=0.6&V0=1 nm/s&law=aging",
    "steady": f"{FIG2.replace('3.2 mm', '0.3 mm')}&mu0=0.6&V0=1 nm/s&law=slip",
    "without mass": f"{FIG2.replace('3000 kg', '0 kg')}&mu0=0.6&V0=1 nm/s&law=aging",
}


def measured(page, fragment, moves):
    """Milliseconds from each of so many key presses on a slider to the end of its drawing."""
    page.evaluate("fragment => { location.hash = fragment }", fragment)
    page.wait_for_timeout(500)
    return pressed(page, moves)


def pressed(page, moves):
    """The same of what the page shows."""
    page.evaluate(f"performance.clearMeasures('{NAME}')")
    page.focus("#slider-K")
    for i in range(moves):
        page.keyboard.press("ArrowRight" if i // 4 % 2 else "ArrowLeft")
        page.wait_for_function(f"count => ({PRESS})() > count", arg=i)
    return page.evaluate(TIMES)


def summary(times):
    """Median and 95th percentile as text."""
    tail = statistics.quantiles(times, n=20)[-1]
    return f"median {statistics.median(times):.1f} ms, 95th percentile {tail:.1f} ms"


def heap(page):
    """Bytes of the page's heap, once its garbage is collected."""
    client = page.context.new_cdp_session(page)
    client.send("HeapProfiler.collectGarbage")
    return client.send("Runtime.getHeapUsage")["usedSize"]


def opened(stack, server, browser):
    """A page that has rested, the map's finest chart included."""
    context = stack.enter_context(contextlib.closing(browser.new_context()))
    page = context.new_page()
    page.goto(server.address)
    page.wait_for_function(RESTED, timeout=120_000)
    return page


def main(moves=100, presses=1000):
    """Measure, and print."""
    from conftest import FINE, browsing, serving

    def tell(text):
        sys.stdout.write(f"{text}\n")
        sys.stdout.flush()

    with contextlib.ExitStack() as stack:
        server, browser = stack.enter_context(serving(code=FINE)), stack.enter_context(browsing())
        page = opened(stack, server, browser)
        for name, fragment in CASES.items():
            tell(f"{name}: {summary(measured(page, fragment, moves))}")
        # a law and a ratio b/a whose chart nobody has asked for yet
        running = CASES["stick-slip"].replace("b=0.008", "b=0.00811")
        tell(f"while the map is computed: {summary(measured(page, running, moves))}")
        others = [opened(stack, server, browser) for _ in range(4)]
        for other in others:
            other.evaluate(
                """() => { const slider = document.querySelector('#slider-V_lp');
                setInterval(() => { slider.stepUp(slider.value > 0 ? -1 : 1);
                    slider.dispatchEvent(new Event('input')) }, 200) }"""
            )
        tell(f"of five pages that move: {summary(measured(page, CASES['stick-slip'], moves))}")
        for other in others:
            other.close()
        pressed(page, 50)
        before = heap(page)
        for _ in range(presses // 100):
            pressed(page, 100)
        tell(f"heap: {before / 1e6:.2f} MB, after {presses} moves {heap(page) / 1e6:.2f} MB")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
