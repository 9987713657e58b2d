"""From a slider's movement to its picture, in the browser.

``python tests/browser/latency.py`` measures three kinds of motion, 60 key presses each, on a
machine that does nothing else.
"""

import statistics
import sys

NAME = "slider-to-drawn"
PRESS = f"() => performance.getEntriesByName('{NAME}').length"
TIMES = f"() => performance.getEntriesByName('{NAME}').map(entry => entry.duration)"
STICK_SLIP = "a=0.005&b=0.008&Dc=10 um&sigma=4 MPa&M=100 kg/m^2&K=0.96 GPa/m&V_lp=10 um/s"
FIG2 = "a=0.003&b=0.006&Dc=10 um&sigma=2 MPa&M=3000 kg/m^2&K=900 MPa/m&V_lp=3.2 mm/s"
CASES = {
    "stick-slip": f"{STICK_SLIP}&mu0=0.6&V0=1 nm/s&law=slip",
    "quasi-harmonic": f"{FIG2}&mu0=0.6&V0=1 nm/s&law=slip",
    "steady": f"{FIG2.replace('3.2 mm', '0.3 mm')}&mu0=0.6&V0=1 nm/s&law=slip",
}


def measured(page, fragment, moves):
    """Milliseconds from each of so many key presses on a slider to the end of its drawing."""
    page.evaluate("fragment => { location.hash = fragment }", fragment)
    page.wait_for_timeout(500)
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


def main(moves=60):
    """Measure, and print."""
    from conftest import browsing, serving

    with serving() as server, browsing() as browser:
        page = browser.new_page()
        page.goto(server.address)
        page.wait_for_function("() => document.querySelector('#numbers dd')")
        page.wait_for_timeout(15_000)  # until the map's chart is there
        for name, fragment in CASES.items():
            print(f"{name}: {summary(measured(page, fragment, moves))}")  # noqa: T201


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
