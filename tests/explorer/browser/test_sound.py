"""The vibration as sound: which pitch, which samples, and what really is played."""

import numpy as np
import pytest

#: evaluate with [...] of JavaScript: a call of what a module exports
CALL = "async ([name, ...given]) => (await import('/js/motion/vibration.js'))[name](...given)"
#: render half a second of a curve's sound at a pitch
RENDER = """async ([time, V, pitch]) => {
    const { Voice } = await import('/js/motion/sound.js');
    const context = new OfflineAudioContext(1, 24000, 48000);
    new Voice(context, { cycle_time: time, cycle_V: V }, pitch, context.destination);
    return Array.from((await context.startRendering()).getChannelData(0)) }"""
#: from now on what a page plays goes through an analyser too
TAP = """() => { const connect = AudioNode.prototype.connect;
    AudioNode.prototype.connect = function (to, ...more) {
        if (to instanceof AudioDestinationNode) {
            const analyser = new AnalyserNode(this.context, { fftSize: 32768 });
            window.tapped = { context: this.context, analyser };
            connect.call(this, tapped.analyser);
        }
        return connect.call(this, to, ...more) } }"""
SAMPLES = """() => { const found = new Float32Array(tapped.analyser.fftSize);
    tapped.analyser.getFloatTimeDomainData(found);
    return [tapped.context.sampleRate, Array.from(found)] }"""
#: until all that the analyser holds is of the sound that is played now
FILLED = """since => window.tapped && tapped.context.currentTime > since + 0.85"""


def frequency(samples, rate):
    """The fundamental: where the autocorrelation has its first high peak, between samples too."""
    x = np.asarray(samples) - np.mean(samples)
    power = np.abs(np.fft.rfft(x, 2 * x.size)) ** 2
    r = np.fft.irfft(power)[: x.size // 2] / np.arange(x.size, x.size // 2, -1)
    below = int(np.argmax(r < 0.5 * r[0]))  # beyond the peak at no lag
    peaks = np.flatnonzero((r[1:-1] >= r[:-2]) & (r[1:-1] > r[2:])) + 1
    peaks = peaks[peaks > below]
    # (the peak of spikes as short as a sample, between two lags, is half as high at either)
    k = peaks[r[peaks] > 0.45 * r[peaks].max()][0]
    shift = 0.5 * (r[k - 1] - r[k + 1]) / (r[k - 1] - 2 * r[k] + r[k + 1])
    return rate / (k + shift)


@pytest.mark.parametrize(
    ("f", "raised"),
    [(30, 0), (29.99, 3), (12.5, 4), (0.4193, 9), (1e-10, 41), (8000, 0), (8000.1, -5), (4e4, -7)],
)
def test_frequencies_that_are_not_heard_are_moved_by_octaves(modules, f, raised):
    assert modules.evaluate(CALL, ["octaves", f]) == raised
    if raised:
        assert 200.0 <= f * 2.0**raised < 400.0


def test_samples_are_means_of_the_curve(modules):
    rng = np.random.default_rng(3)
    time = 7.0 + np.append(0.0, np.cumsum(rng.exponential(size=40)))
    V = rng.normal(size=time.size)
    V[-1] = V[0]
    periods, count = 3, 50
    found = modules.evaluate(CALL, ["means", time.tolist(), V.tolist(), periods, count])
    found = [found[str(k)] for k in range(count)] if isinstance(found, dict) else found
    T = np.ptp(time)
    fine = np.unique(
        np.concatenate(
            [np.linspace(0, periods * T, 50 * count + 1)]
            + [time - 7.0 + k * T for k in range(periods)]
        )
    )
    curve = np.interp(fine % T + 7.0, time, V)
    curve[-1] = V[-1]
    integral = np.append(0.0, np.cumsum(np.diff(fine) * 0.5 * (curve[1:] + curve[:-1])))
    edges = np.interp(np.linspace(0, periods * T, count + 1), fine, integral)
    np.testing.assert_allclose(found, np.diff(edges) * count / (periods * T), atol=1e-9)


@pytest.mark.parametrize(
    ("shape", "peak", "size"),
    [("sine", 0.25 * 2**0.5, 0.25), ("spike", 1.0, 0.1), ("flat", 0.0, 0.0)],
)
def test_all_are_as_loud_as_their_peaks_allow(modules, shape, peak, size):
    t = np.arange(1000) / 1000
    curve = {
        "sine": 3.0 + np.sin(2 * np.pi * t),
        "spike": 1e9 * (np.arange(1000) % 100 == 0),
        "flat": 0.0 * t + 2.0,
    }[shape]
    found = modules.evaluate(
        f"async given => Array.from(await ({CALL})(given))", ["levelled", curve.tolist()]
    )
    assert np.abs(found).max() == pytest.approx(peak, rel=0.02)
    assert np.std(found) == pytest.approx(size, rel=0.02)


@pytest.mark.parametrize("pitch", [30.0, 391.7, 7990.0])
def test_the_sound_has_the_pitch_of_the_cycle(modules, pitch):
    """Of a stick-slip, whose points are where it moves."""
    phase = np.linspace(0, 1, 400) ** 3
    V = 1e-6 * np.exp(10.0 * np.exp(-(((phase - 0.3) / 0.1) ** 2)))
    samples = np.array(modules.evaluate(RENDER, [(5.0 * phase).tolist(), V.tolist(), pitch]))
    assert frequency(samples[4800:], 48000.0) == pytest.approx(pitch, rel=2e-3)
    assert np.std(samples[4800:]) > 0.02
    # it begins, and goes on, without a click: no step is larger than the sound itself has
    steps = np.abs(np.diff(np.append(0.0, samples)))
    assert steps[:2400].max() < 1.1 * steps[4800:].max()


def test_one_sound_gives_way_to_the_next_without_a_click(modules):
    """Two that are alike but for their phase, which differs by a third of a period."""
    t = np.linspace(0, 1, 200)
    join = """async ([time, V]) => {
        const { Voice } = await import('/js/motion/sound.js');
        const context = new OfflineAudioContext(1, 48000, 48000);
        const arrays = { cycle_time: time, cycle_V: V };
        const first = new Voice(context, arrays, 240.7, context.destination);
        context.suspend(0.5).then(() => {
            first.end();
            new Voice(context, arrays, 240.7, context.destination);
            context.resume(); });
        return Array.from((await context.startRendering()).getChannelData(0)) }"""
    samples = np.array(modules.evaluate(join, [t.tolist(), np.cos(2 * np.pi * t).tolist()]))
    steps = np.abs(np.diff(np.append(0.0, samples)))
    assert steps[:1000].max() < 1.05 * steps[10000:20000].max()
    assert steps[20000:].max() < 1.05 * steps[10000:20000].max()
    assert np.std(samples[-4800:]) == pytest.approx(0.25, rel=0.02)


def test_what_is_shown_is_played(show):
    shown = show()
    page = shown.page
    page.evaluate(TAP)
    assert page.get_attribute("#sound", "aria-pressed") == "false"
    assert page.evaluate("typeof tapped") == "undefined"
    page.click("#sound")
    assert page.get_attribute("#sound", "aria-pressed") == "true"
    assert shown.text("#heard") == "419 mHz, played 512 times as fast"
    page.wait_for_function(FILLED, arg=0)
    rate, samples = page.evaluate(SAMPLES)
    period = 2.3850  # of the paper's figure 4, see test_it_opens_with_a_verdict
    assert frequency(samples, rate) == pytest.approx(512 / period, rel=0.01)
    loud = np.std(samples)
    page.fill("#volume", "0.25")  # a quarter of the amplitude at 0.5
    since = page.evaluate("tapped.context.currentTime")
    page.wait_for_function(FILLED, arg=since)
    assert np.std(page.evaluate(SAMPLES)[1]) == pytest.approx(loud / 4, rel=0.05)
    shown.set("K", "2 GPa/m")
    assert shown.text("#heard") == "steady sliding: silent"
    since = page.evaluate("tapped.context.currentTime")
    page.wait_for_function(FILLED, arg=since)
    assert np.abs(page.evaluate(SAMPLES)[1]).max() < 1e-4
    # nobody hears a page that is not looked at
    hide = """is => { Object.defineProperty(document, 'hidden', { value: is, configurable: true });
        document.dispatchEvent(new Event('visibilitychange')) }"""
    for hidden, state in ((True, "suspended"), (False, "running")):
        page.evaluate(hide, hidden)
        page.wait_for_function("state => tapped.context.state === state", arg=state)
    page.click("#sound")
    page.wait_for_function("() => tapped.context.state === 'suspended'")
    assert page.get_attribute("#sound", "aria-pressed") == "false"
    assert not page.is_visible("#heard")
