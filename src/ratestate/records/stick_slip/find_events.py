"""The function `events`: the catalogue of stick-slip events in a record or a run."""

from ...dynamics.recipe import versions
from ...model.names import keywords_checked
from .catalogue import catalogue_of
from .series import series_of


@keywords_checked
def events(data, *, K=None, M=None, sigma=None):
    """Find the stick-slip events of a record or a run, with standard errors.

    An event is a fall of the shear stress, from a maximum to the next minimum, that is too large
    for noise.  During the fall slip is faster than the load point.  A smooth oscillation has one
    event in each period.

    Parameters
    ----------
    data : xarray.Dataset
        A record from `read_lab` (``friction`` or ``tau``, ``delta_lp`` or ``V_load``, and perhaps
        ``sigma``), or a run of one slider from `simulate` with many saved times.
    K : float, str or pint.Quantity, optional
        Stiffness per area [Pa/m].  By default the stiffness of the run's slider is used.  For a
        record it is estimated from the loading between events.
    M : float, str or pint.Quantity, optional
        Mass per area [kg/m^2], if it is known.  By default the mass of the run's slider is used.
    sigma : float, str or pint.Quantity, optional
        Normal stress [Pa].  It is needed if the record has friction but no normal stress, and
        replaces a recorded normal stress.

    Returns
    -------
    xarray.Dataset
        Along ``event``, in order of time, with standard errors ``NAME_error``:

        - ``event_start`` and ``event_end`` [s]: times of the largest and smallest stress.
        - ``event_time`` [s]: when the stress is midway between them.
        - ``tau_max``, ``tau_min`` and ``stress_drop`` [Pa]; ``friction_drop``.
        - ``recurrence`` [s]: time since the ``event_time`` of the previous event.
        - ``duration`` [s], ``slip`` [m], ``peak_slip_rate`` [m/s], ``V_lp`` [m/s].
        - ``friction_work`` [J/m^2]: the integral of tau over slip.
        - ``spring_energy`` [J/m^2]: the energy that the spring loses.

        Without errors: ``event_kind`` is "fast" if the peak slip rate is at least half the inertial
        limit stress_drop/(2 sqrt(K M)), or at least 100 V_lp if M is unknown, and "slow" otherwise.
        ``samples_in_fall`` is the number of samples.  ``event_status`` (int8 with CF flags) is 0
        for a whole event.  ``event_message`` explains NaN and gives remarks.

        Along ``abscissa`` ("recurrence", "V_lp"): the line stress_drop = A + B log10(x), with x in
        SI, through whole events during whose loading V_lp was constant: ``trend_A`` and ``trend_B``
        [Pa] with errors, ``trend_events`` and ``trend_message``.

        Scalars: ``K`` and ``K_error`` [Pa/m]; ``tau_noise`` [Pa] and ``tau_noise_correlation`` of
        neighbouring samples, from the loading; ``detection_threshold`` [Pa], the smallest stress
        drop that can be found.  Along ``time``: ``tau``, thinned if it is long.

    Raises
    ------
    ParameterError
        If the data are not a record or a run of one slider, a value cannot be used, or the record
        has friction but no normal stress.

    Notes
    -----
    In a run peaks lie on cubics through tau and its known slope.  In a record they are peaks of
    polynomials, which do not have the bias of the largest sample.  The windows are as wide as
    possible without a misfit beyond the noise.  Errors follow from the noise in the loading phases,
    white or correlated.  Errors of slip, slip rate and energies include the error of K, which all
    events share.  Every error includes the rounding of stresses and times to the record's digits.
    If the samples next to a fall show that a peak or trough lies between samples, it is placed
    halfway to the point at which the lines through these samples meet, with that distance as its
    error.  The duration is NaN if it is less than one step between samples.

    Two events are found as one fall if the loading between them raises the stress by less than the
    detection threshold.  A fall that slows down and speeds up again is several events (status 6),
    and its errors cover the values of each of them.  A message reports a stress drop with few
    samples that exceeds 1.5 times the median, because it may be several events.  Messages also
    report a smaller fall during the loading before an event, and a stress drop below twice the
    threshold, because similar events may then be missing.

    If the middle half of a fall has fewer than 8 samples, the peak slip rate is the mean slip rate
    there, a lower bound.

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
    names = ("source", "scenario", "slider")
    kept = {name: data.attrs[name] for name in names if name in data.attrs}
    mass = {} if series.M is None else {"M": series.M}
    return catalogue.assign_attrs(
        title="ratestate events", **kept, **mass, stiffness=stiffness.text, versions=versions()
    )
