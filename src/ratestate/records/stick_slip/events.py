"""The function `events`: the catalogue of stick-slip events in a record or a run."""

from ...dynamics.results import versions
from ...model.names import keywords_checked
from .catalogue import catalogue_of
from .series import series_of


@keywords_checked
def events(data, *, K=None, M=None, sigma=None):
    """Find the stick-slip events of a record or a run: a catalogue with errors.

    An event is the fall of shear stress from a maximum to the next minimum, if it is larger than
    what noise does: slip is faster than the load point from the one to the other.  A smooth
    oscillation has one event a period.

    Parameters
    ----------
    data : xarray.Dataset
        A record of `read_lab` (``friction`` or ``tau``; ``delta_lp`` or ``V_load``; perhaps
        ``sigma``), or a run of `simulate` of one slider, with more than its ends saved.
    K : float, str or pint.Quantity, optional
        Stiffness per area [Pa/m]; by default the slider's, or for a record that of the loading
        between events.
    M : float, str or pint.Quantity, optional
        Mass per area [kg/m^2], if it is known; by default that of the run's slider.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa], where the record has none or another is meant.

    Returns
    -------
    xarray.Dataset
        Along ``event``, in order of time, each with its standard error ``..._error``:
        ``event_start`` and ``event_end`` [s], of the largest and smallest stress, and
        ``event_time``, when stress is midway; ``tau_max``, ``tau_min`` and ``stress_drop`` [Pa],
        ``friction_drop``; ``recurrence`` [s], between the event times of this and the last
        event; ``duration`` [s]; ``slip`` [m] and ``peak_slip_rate`` [m/s]; ``friction_work``, the
        integral of tau over slip, and ``spring_energy``, what the spring loses [J/m^2]; ``V_lp``
        [m/s].  ``event_kind`` is "fast" where the peak slip rate is half of the inertial limit
        stress_drop/(2 sqrt(K M)) or more, else "slow"; where M is not known, where it is 100 V_lp
        or more.  ``samples_in_fall``; ``event_status`` (int8 with CF flags; 0 whole) and
        ``event_message``, with a line for whatever is NaN or to be known.

        Along ``abscissa`` ("recurrence", "V_lp") the line stress_drop = A + B log10(x), x in SI, of
        whole events loaded at one V_lp: ``trend_A``, ``trend_B`` [Pa], their errors,
        ``trend_events`` and ``trend_message``.  ``K``, ``K_error`` [Pa/m]; ``tau_noise`` [Pa] and
        ``tau_noise_correlation`` of neighbouring samples, as found in the loading;
        ``detection_threshold`` [Pa], the smallest stress drop that is found; ``tau`` along
        ``time``, thinned where it is long.

    Raises
    ------
    ParameterError
        A Dataset that is neither; a value that cannot be used; a sweep; friction without a normal
        stress.

    Notes
    -----
    In a run peaks lie on cubics through tau and its known slope.  In a record they are those of
    polynomials, in windows that are as wide as the noise hides what a polynomial cannot follow, and
    without the bias of largest samples.  Errors are from the noise in the loading phases, white or
    correlated.  Errors of slip, slip rate and energies contain that of K, which all events share.
    The rounding of stresses and times to the record's digits is part of every error.  If the
    samples next to a fall show that a peak or trough lies between samples, it is put halfway to
    where the lines through these samples meet, with that distance as its error.  The duration is
    NaN if it is less than one step between samples.

    Two events are found as one fall if the loading between them raises the stress by less than the
    detection threshold.  A fall that slackens and gains speed again is several events (status 6);
    its errors cover any one of them.  Messages name a drop of more than 1.5 times the median one in
    few samples, which may be several events; a smaller fall in the loading before an event; and a
    drop of less than twice the threshold, so that similar events may be lost.

    If the middle half of a fall has fewer than 8 samples, the peak slip rate is the mean there: a
    lower bound.

    Examples
    --------
    >>> import ratestate as rs
    >>> slider = rs.SpringSlider(a=0.005, b=0.008, Dc="10 um", sigma="4 MPa", M=100, K="960 MPa/m")
    >>> run = rs.simulate(slider, rs.Loading.constant("10 um/s"), t_end=200, V_start="5 um/s")
    >>> catalogue = rs.events(run)
    >>> [round(float(x[-1]), 3) for x in (catalogue.friction_drop, catalogue.recurrence)]
    [0.061, 29.975]
    """
    series = series_of(data, K, M, sigma)
    catalogue, stiffness = catalogue_of(series)
    kept = {name: data.attrs[name] for name in ("source", "slider") if name in data.attrs}
    mass = {} if series.M is None else {"M": series.M}
    return catalogue.assign_attrs(
        title="ratestate events", **kept, **mass, stiffness=stiffness.text, versions=versions()
    )
