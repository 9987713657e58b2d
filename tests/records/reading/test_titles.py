# ruff: noqa: RUF001 (titles of files in Japanese and Chinese)
"""Which columns are read, which are not, and which are reported, by the words of their titles."""

import contextlib
import json
import warnings

import numpy as np
import pytest
from lab_files import MU, SIGMA, N, T, X, check, write

import ratestate as rs
from ratestate import describe_lab, read_lab
from ratestate.errors import RecordWarning
from ratestate.records.reading.columns import Column, unit_of
from ratestate.records.reading.sizes import in_si
from ratestate.records.reading.titles import (
    CERTAIN,
    EXAMPLE_UNIT,
    match_rank,
    name_and_units,
    split_title,
)

BASE = {
    "Time (s)": T,
    "LP disp (um)": X,
    "Shear stress (MPa)": 20 * MU,
    "Normal stress (MPa)": SIGMA,
}


def without(*titles):
    return {title: values for title, values in BASE.items() if title not in titles}


#: symbol -> titles that files have, with units or without
SPELLINGS = {
    "time": (
        "Time(s);time [s];Time;t;Elapsed Time (sec);TIME_s;Test time/s;seconds;Timestamp (ms);"
        "Zeit;Messzeit [s];temps écoulé (s);Tempo decorrido;Tiempo transcurrido;経過時間;时间"
    ),
    "delta_lp": (
        "Displ(microns);LP_Disp(mic);Load Point Displacement [mm];LPDisp;lp displacement;"
        "disp_mm;Displacement (um);Shear displacement, mm;delta_lp [m];ram_position(mm);Lp;"
        "Loading point disp;Scherweg [mm];Weg;Kolbenweg;Lastpunktverschiebung;"
        "Déplacement cumulé;déplacement de cisaillement;Spostamento del pistone;"
        "Desplazamiento de corte;せん断変位;載荷点変位;剪切位移;ｽﾄﾛｰｸ変位"
    ),
    "V_load": (
        "V_load;Velocity (um/s);Load-point velocity [m/s];V_lp;vlp_um/s;Sliding velocity;"
        "Geschwindigkeit;Vitesse (µm/s);Velocità;velocidad;velocidade;速度;载荷点速度;剪切速率"
    ),
    "friction": (
        "Friction;mu;mu [-];COF;µ;Friction coefficient;coefficient of friction;mu_app;"
        "Coeff. friction;apparent friction;FRICTION (-);Reibungskoeffizient;Reibbeiwert;"
        "Reibungszahl;coefficient de frottement;Coefficiente d'attrito;coefficiente di attrito;"
        "Attrito;Fricción;coeficiente de fricción;Coeficiente de rozamiento;"
        "coeficiente de atrito;摩擦係数;摩擦系数"
    ),
    "tau": (
        "Shear stress, MPa;Shear_stress(MPa);tau [Pa];ShearStress;Shr_stress (MPa);tau_MPa;"
        "Schubspannung;Scherspannung;contrainte de cisaillement;sforzo di taglio;"
        "tensione tangenziale;esfuerzo cortante;tensão cisalhante;剪断応力;剪应力;Scherkraft"
    ),
    "sigma": (
        "Normal_stress(MPa);Effective_Normal_stress(MPa);sigma_n [MPa];Eff. normal stress;"
        "NormStress;sigma;Normal stress, MPa;σn (MPa);Normalspannung;effektive Normalspannung;"
        "contrainte normale effective;tensione normale;esfuerzo normal efectivo;tensão normal;"
        "法線応力;正应力;有效正应力;Normalkraft"
    ),
}  # fmt: skip


@pytest.mark.parametrize("symbol", SPELLINGS)
def test_titles_in_many_spellings_are_recognized(symbol):
    for title in SPELLINGS[symbol].split(";"):
        known = [
            symbol
            for symbol in EXAMPLE_UNIT
            if match_rank(split_title(title)[0], symbol) is not None
        ]
        assert known == [symbol], title


#: titles of what is not the load point's displacement: the sample, the fault, a gauge, a remainder
ELSEWHERE = (
    """
Elastically corrected displacement;Verschiebung Probe;Local displacement;Gap;Gap displacement
LVDT sample disp;On-board displacement;Corrected displacement;Shear displacement corrected
Stiffness-corrected disp;Interface displacement;Clip gauge displacement;Extensometer displacement
Joint displacement;Déplacement local;Déplacement corrigé;Spostamento corretto;Weg lokal
Desplazamiento de la probeta;Relativverschiebung;試験片変位;補正変位;局部位移;Normal displacement
Verschiebung korr.;Deslocamento corrigido;Extension (local);Kluftverschiebung;Slip (mm)
Normal displacement [mm];Layer thickness;On-board disp;Gleitweg;Normalverschiebung [mm];Probendicke
déplacement normal;glissement;spostamento normale;desplazamiento normal;垂直変位;法向位移
すべり変位;厚さ変位
""".strip()
    .replace("\n", ";")
    .split(";")
)


@pytest.mark.parametrize("title", ELSEWHERE)
def test_titles_of_other_displacements_are_not_delta_lp(title):
    assert match_rank(name_and_units(title)[0], "delta_lp") is None


@pytest.mark.parametrize(
    "title",
    ["Extension", "Crosshead displacement", "Stroke", "Piston position", "Kolbenhub", "Course",
     "Traversenweg", "Corsa", "Standard travel", "クロスヘッド変位", "Compressive extension"],
)  # fmt: skip
def test_titles_of_testing_machines(title):
    assert match_rank(title, "delta_lp") < CERTAIN["delta_lp"]


@pytest.mark.parametrize("title", ["Displacement west (um)", "Axial displacement (um)"])
def test_an_ambiguous_title_is_reported(tmp_path, title):
    path = write(tmp_path / "r.txt", {"Time (s)": T, title: X, "Friction": MU})
    with pytest.warns(RecordWarning, match=r"delta_lp is read from the column 'Disp|'Axial"):
        read_lab(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_lab(path, {"delta_lp": title})
        read_lab(write(tmp_path / "s.txt", {"Time (s)": T, "Displacement (um)": X, "mu": MU}))


#: symbol -> titles of set points, spreads and errors
NOT_MEASURED = {
    "sigma": "Normal stress setpoint;Normal stress (set);NormalStressCmd;Normalspannung Sollwert;"
    "Contrainte normale de consigne;法線応力 設定値;Normal stress target;Normal stress SP;"
    "Normal stress SD;Normal stress std. dev.;Normalspannung Standardabweichung;"
    "Normal stress (nominal);±normal stress",
    "tau": "Shear stress command;sd shear stress;Shear stress error;écart-type contrainte de "
    "cisaillement;せん断応力 標準偏差;Schubspannung Vorgabe",
    "delta_lp": "Displacement command;LP disp demand;Kolbenweg Soll;LP displacement std",
    "friction": "Friction std;mu_err;Friction uncertainty;Reibung Fehler",
    "V_load": "Velocity error;LP velocity SD",
}


@pytest.mark.parametrize("symbol", NOT_MEASURED)
def test_set_points_and_spreads_are_not_data(symbol):
    for title in NOT_MEASURED[symbol].split(";"):
        assert match_rank(name_and_units(title)[0], symbol) is None, title


def test_measured_and_mean_columns_are_read_beside_them(tmp_path):
    columns = {
        "Time (s)": T,
        "Kolbenweg Soll (um)": 2 * X,
        "Kolbenweg Ist (um)": X,
        "Shear stress SD (MPa)": 0.01 * T,
        "Shear stress mean (MPa)": 20 * MU,
        "Normal stress setpoint (MPa)": 2 * SIGMA,
        "Normal stress measured (MPa)": SIGMA,
    }
    data = read_lab(write(tmp_path / "r.txt", columns))
    np.testing.assert_allclose(data.friction, MU)
    np.testing.assert_allclose(data.segment_V, [1e-6, 1e-5])


def test_a_commanded_speed_is_read_if_nothing_is_measured(tmp_path):
    V = np.where(T < 15, 1.0, 10.0)
    columns = {"Time (s)": T, "Target velocity (um/s)": V, "Friction": MU}
    with pytest.warns(RecordWarning, match=r"V_load is read from .*'Target velocity \(um/s\)'"):
        np.testing.assert_allclose(read_lab(write(tmp_path / "r", columns)).segment_V, [1e-6, 1e-5])
    measured = columns | {"Velocity (um/s)": 1.1 * V}
    data = read_lab(write(tmp_path / "r.txt", measured))
    np.testing.assert_allclose(data.segment_V, [1.1e-6, 1.1e-5])


@pytest.mark.parametrize(
    ("title", "plain", "symbol"),
    [
        ("Corrected shear stress (MPa)", "Shear stress (MPa)", "tau"),
        ("Shear stress (area-corrected) [MPa]", "Shear stress (MPa)", "tau"),
        ("Schubspannung korrigiert (MPa)", "Schubspannung (MPa)", "tau"),
        ("Normal stress corr. (MPa)", "Normal stress (MPa)", "sigma"),
        ("Total normal stress (MPa)", "Normal stress (MPa)", "sigma"),
        ("mu_corr", "mu", "friction"),
    ],
)
def test_a_corrected_column_beside_the_plain_column_is_refused(tmp_path, title, plain, symbol):
    drop = {"sigma": ["Normal stress (MPa)"], "tau": ["Shear stress (MPa)"]}.get(
        symbol, ["Shear stress (MPa)", "Normal stress (MPa)"]
    )
    values = {"sigma": SIGMA, "tau": 20 * MU, "friction": MU}[symbol]
    path = write(tmp_path / "r.txt", {**without(*drop), title: 1.1 * values, plain: values})
    with pytest.raises(rs.ParameterError, match=f"{symbol} may be any of the columns"):
        read_lab(path)
    np.testing.assert_allclose(read_lab(path, {symbol: plain}).friction, MU)
    alone = read_lab(write(tmp_path / "s.txt", {**without(*drop), title: values}))
    np.testing.assert_allclose(alone.friction, MU)


def test_a_raw_column_is_read_only_alone(tmp_path):
    raw = {"Raw shear stress (MPa)": 24 * MU}
    path = write(tmp_path / "r.txt", BASE | raw)
    np.testing.assert_allclose(read_lab(path).friction, MU)
    path = write(tmp_path / "s.txt", without("Shear stress (MPa)") | raw)
    with pytest.warns(RecordWarning, match="tau is read from the column 'Raw shear stress"):
        read_lab(path)


PORE = ["Pp (MPa)", "Porendruck [MPa]", "Pression interstitielle (MPa)", "Pressão neutra (MPa)",
        "pf_MPa", "Presión de poros (MPa)", "Pressione dei pori (MPa)", "PWP (MPa)",
        "間隙水圧 (MPa)", "孔隙压力 (MPa)", "Pore fluid press. (MPa)"]  # fmt: skip


@pytest.mark.parametrize("title", PORE)
def test_titles_of_pore_pressures(title):
    assert match_rank(name_and_units(title)[0], "pore_pressure") is not None


def test_the_pore_pressure_is_subtracted(tmp_path):
    title = "Pore pressure (MPa)"
    p = 3.0 + 0.1 * np.sin(T)
    path = write(tmp_path / "r.txt", BASE | {"Normal stress (MPa)": SIGMA + p, title: p})
    with pytest.warns(RecordWarning, match="sigma is the effective normal stress: the pore"):
        data = read_lab(path)
    np.testing.assert_allclose(data.friction, MU)
    np.testing.assert_allclose(data.sigma, 2e7)
    assert json.loads(data.attrs["columns"])["pore_pressure"] == {"title": title, "unit": "MPa"}
    # a column that is named is taken as it is, unless the pore pressure is named as well
    named = {"sigma": "Normal stress (MPa)"}
    with pytest.warns(RecordWarning, match="is not subtracted from sigma"):
        np.testing.assert_allclose(read_lab(path, named).sigma, 1e6 * (SIGMA + p))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        both = read_lab(path, named | {"pore_pressure": title})
        np.testing.assert_allclose(both.sigma, 2e7)
        lab = tmp_path / "lab.toml"
        lab.write_text(describe_lab(path), "utf-8")
        np.testing.assert_allclose(read_lab(path, lab_format=lab).sigma, 2e7)


NORMAL, PRESSURE, P = "Normal stress (MPa)", "Pore pressure (MPa)", 0.0 * T + 3.0
#: titles beside which a pore pressure is not subtracted a second time
EFFECTIVE = ["Effective normal stress (MPa)", "Normal stress effective (MPa)", "sigma_n' (MPa)",
             "Normal stress (effective) [MPa]", "Net normal stress (MPa)", "\u03c3'n (MPa)",
             "Normal stress minus pore pressure (MPa)", "eff. Normalspannung [MPa]",
             "Normalspannung effektiv [MPa]", "Contrainte effective normale (MPa)",
             "Sn\u2019 (MPa)"]  # fmt: skip
RELATIVE = ["EPWP (MPa)", "Excess pore pressure (MPa)", "Porenwasser\u00fcberdruck (MPa)"]
#: units of stress as laboratories write them [Pa]
STRESSES = {"Mpa": 1e6, "mpa": 1e6, "KPa": 1e3, "kpa": 1e3, "Bar": 1e5, "psig": 6894.757293168,
            "kg/cm2": 98066.5, "kg/cm\u00b2": 98066.5, "kp/cm2": 98066.5, "kg/cm^2": 98066.5,
            "t/m2": 9806.65, "lb/in2": 6894.757293168, "Atm": 101325.0}  # fmt: skip
SUBTRACTED, TENSION = "sigma is the effective normal stress", -(SIGMA + 3.0)
#: columns in the place of the normal stress; words of the warning; sigma that is read [Pa]
READ_AS = [
    *(({title: SIGMA, "Pp (MPa)": P}, None, 2e7) for title in EFFECTIVE),
    *(
        ({f"Normal stress ({x})": 2e7 / pascals + 0.0 * T}, None, 2e7)
        for x, pascals in STRESSES.items()
    ),
    *(({NORMAL: SIGMA, x: 0.1 * SIGMA}, "is relative to an initial", 2e7) for x in RELATIVE),
    ({NORMAL: SIGMA, "Confining pressure (MPa)": P}, None, 2e7),
    ({NORMAL: SIGMA, "Argon pressure (MPa)": P}, "the pressure 'Argon .* is not subtr", 2e7),
    ({NORMAL: TENSION, PRESSURE: P}, SUBTRACTED, 2e7),
    ({NORMAL: TENSION, PRESSURE: -P}, SUBTRACTED, 2e7),  # where tension is positive
    ({NORMAL: SIGMA, PRESSURE: 0.0 * T - 0.01}, SUBTRACTED, 20.01e6),  # suction
]


@pytest.mark.parametrize(("columns", "words", "sigma"), READ_AS)
def test_normal_stresses_that_are_read(tmp_path, columns, words, sigma):
    path = write(tmp_path / "r.txt", without(NORMAL) | columns)
    with pytest.warns(RecordWarning, match=words) if words else contextlib.nullcontext():
        data = read_lab(path)
    np.testing.assert_allclose(data.sigma, sigma)


def test_two_pore_pressures_are_refused(tmp_path):
    two = BASE | {"Upstream pore pressure (MPa)": SIGMA, "Downstream pore pressure (MPa)": SIGMA}
    with pytest.raises(rs.ParameterError, match="pore_pressure may be any of the columns"):
        read_lab(write(tmp_path / "t.txt", two))


@pytest.mark.parametrize(
    ("shear", "normal", "factor"),
    [("Shear force (kN)", "Normal force (kN)", 1.0), ("Reibkraft (N)", "Normal load (kN)", 1e3),
     ("Scherkraft (N)", "Normalkraft (kg)", 9.80665), ("Tau", "Sigma", None)],
)  # fmt: skip
def test_friction_is_the_ratio_of_forces(tmp_path, shear, normal, factor):
    columns = {"Time (s)": T, "LP disp (um)": X, shear: 20 * MU * (factor or 1.0), normal: SIGMA}
    path = write(tmp_path / "r.txt", columns)
    units = {} if factor else {"tau": "kN", "sigma": "kN"}
    with pytest.warns(RecordWarning, match="friction is the ratio of forces .* two faces"):
        data = read_lab(path, units=units)
    np.testing.assert_allclose(data.friction, MU)
    assert "sigma" not in data
    mixed = write(tmp_path / "m.txt", without("Shear stress (MPa)") | {"Shear force (kN)": MU})
    with pytest.raises(rs.ParameterError, match="is of the whole contact"):
        read_lab(mixed)


@pytest.mark.parametrize(
    ("title", "unit", "expected"),
    [
        ("Disp (mm)", "um", ("Disp", "um", "mm")),
        ("Disp_mm (um)", "", ("Disp", "um", "mm")),
        ("Disp (microns)", "um", ("Disp", "um", "")),
        ("Stress (corr.)", "MPa", ("Stress (corr.)", "MPa", "")),
        ("Stress (corr.) [MPa]", "", ("Stress (corr.)", "MPa", "")),
        ("Load [kN] left", "", ("Load left", "kN", "")),
        ("Time(s)", "", ("Time", "s", "")),
        ("mu", "", ("mu", "", "")),
        ("Shear stress, MPa", "", ("Shear stress", "MPa", "")),
        ("disp_um", "", ("disp", "um", "")),
        ("Velocity um/s", "", ("Velocity", "um/s", "")),
        ("sigma_n", "", ("sigma_n", "", "")),
        ("V_lp", "", ("V_lp", "", "")),
        ("t/s", "", ("t", "s", "")),
    ],
)
def test_units_of_a_title_and_beside_it(title, unit, expected):
    assert name_and_units(title, unit) == expected


def test_a_title_and_a_row_of_units_that_contradict_each_other(tmp_path):
    names = ["Time (s)", "LP disp (mm)", "Shear stress (MPa)", "Normal stress (bar)"]
    columns = dict(zip(["s", "um", "N/mm2", "MPa"], BASE.values(), strict=True))
    path = write(tmp_path / "r.txt", columns, above=["\t".join(names)])
    match = r"'LP disp \(mm\)' \(delta_lp\) as um and as mm"
    with pytest.raises(rs.ParameterError, match=match):
        read_lab(path)
    with pytest.raises(rs.ParameterError, match=r"'Normal stress \(bar\)' \(sigma\) as MPa"):
        read_lab(path, units={"delta_lp": "um"})
    data = read_lab(path, units={"delta_lp": "um", "sigma": "MPa"})  # MPa is N/mm2
    np.testing.assert_allclose(data.friction, MU)


@pytest.mark.parametrize("unit", ["mPa", "GPa"])
def test_units_mPa_and_GPa_are_read_as_written(tmp_path, unit):
    columns = without("Normal stress (MPa)") | {f"Normal stress ({unit})": SIGMA}
    told = pytest.warns(RecordWarning, match="sigma is 20 GPa")
    refused = pytest.raises(rs.ParameterError, match="impossible in a record")
    with refused if unit == "mPa" else told:
        read_lab(write(tmp_path / "r.txt", columns), units={"tau": unit})


#: language -> titles of time, displacement [um], shear and normal stress [MPa]; and its encodings
HEADERS = {
    "de": ("Zeit [s]|Weg [µm]|Schubspannung (N/mm²)|Normalspannung [MPa]", "cp1252"),
    "de 2": ("Versuchszeit (Sek)|Verschiebung (Mikron)|Scherspannung, MPa|Normalspannung MPa", ""),
    "fr": ("Temps (s)|Déplacement du vérin (µm)|Contrainte de cisaillement (MPa)|"
           "Contrainte normale (MPa)", "cp1252"),
    "it": ("Tempo [secondi]|Spostamento [µm]|Sforzo di taglio [MPa]|Sforzo normale [MPa]", ""),
    "es": ("Tiempo (seg)|Desplazamiento (µm)|Esfuerzo de corte (MPa)|Esfuerzo normal (MPa)",
           "cp1252"),
    "pt": ("Tempo (s)|Deslocamento (µm)|Tensão de cisalhamento (MPa)|Tensão normal (MPa)",
           "cp1252"),
    "ja": ("時間(秒)|荷重点変位(μm)|せん断応力(MPa)|垂直応力(MPa)", "cp932 euc_jp"),
    "ja 2": ("経過時間（s）|変位（㎛）|せん断応力（㎫）|有効垂直応力（㎫）", ""),
    "zh": ("时间(秒)|位移(微米)|剪切应力(兆帕)|法向应力(兆帕)", "gb18030 gbk"),
    "zh 2": ("時間(s)|位移(um)|剪切應力(MPa)|正應力(MPa)", "big5"),
}  # fmt: skip


@pytest.mark.parametrize("language", HEADERS)
def test_headers_of_other_languages(language, tmp_path):
    header, encodings = HEADERS[language]
    columns = [T, X, 20 * MU, SIGMA]
    for encoding in ["utf-8", "utf-16", *encodings.split()]:
        path = write(tmp_path / "r.txt", columns, header.split("|"), encoding=encoding)
        data = read_lab(path)
        np.testing.assert_allclose(data.friction, MU, rtol=1e-14)
        known = json.loads(data.attrs["columns"]).values()
        assert [one["title"] for one in known] == header.split("|"), encoding


@pytest.mark.parametrize(
    ("written", "read", "factor"),
    [
        *[("N/mm²", "sigma", 1e6), ("kgf/cm2", "sigma", 98066.5), ("bar", "sigma", 1e5)],
        *[("psi", "sigma", 6894.757293168361), ("kgf/cm²", "sigma", 98066.5), ("兆帕", "tau", 1e6)],
        *[("µm", "delta_lp", 1e-6), ("㎜", "delta_lp", 1e-3), ("Mikrometer", "delta_lp", 1e-6)],
        *[("mm/min", "V_load", 1e-3 / 60), ("微米/秒", "V_load", 1e-6)],
        *[("min", "time", 60.0), ("h", "time", 3600.0), ("Sek", "time", 1.0), ("秒", "time", 1.0)],
        *[("Std", "time", 3600.0), ("分钟", "time", 60.0), ("heures", "time", 3600.0)],
        *[("無次元", "friction", 1.0), ("sans", "friction", 1.0), ("%", "friction", 0.01)],
    ],
)
def test_units_of_other_laboratories(written, read, factor):
    unit = unit_of(Column("x", "x", written, T), read, {})
    np.testing.assert_allclose(in_si(read, np.array([1.0, 2.0]), unit), [factor, 2 * factor], 1e-14)


def test_decimal_commas_and_a_row_of_units(tmp_path):
    header = "Zeit;Weg;Reibungskoeffizient;Normalspannung\ns;µm;-;N/mm²".split(";")
    path = write(tmp_path / "r.csv", [T, X, MU, SIGMA], header, lambda x: repr(x).replace(".", ","),
                 delimiter=";", encoding="cp1252")  # fmt: skip
    check(read_lab(path))


def xlook(path, names, units, columns):
    """A file as xlook writes it: columns of 12 letters, the first of which has no name."""
    wide = "            "
    numbers = [f"col {i}" for i in range(2, 6)]
    lines = [f"number of records = {N}", wide + "".join(f"{name:>12}" for name in numbers)]
    lines += [wide + "".join(name.rjust(12) for name in row) for row in (names, units)]
    lines.append(wide + "".join(f"{N}recs".rjust(12) for _ in names))
    rows = zip(range(N), *columns, strict=True)
    lines += ["".join(f"{float(x):.17g}".rjust(25) for x in row) for row in rows]
    path.write_text("\n".join(lines))
    return path


def test_a_file_of_xlook(tmp_path):
    columns = [X, 20 * MU, SIGMA, T]
    path = xlook(tmp_path / "p1.txt", ["LP_Disp", "Shr_stress", "Nor_stress", "Time"],
                 ["mic", "MPa", "MPa", "sec"], columns)  # fmt: skip
    data = read_lab(path)
    np.testing.assert_allclose(data.friction, MU, rtol=1e-14)
    columns = json.loads(data.attrs["columns"])
    assert columns["delta_lp"] == {"title": "LP_Disp", "unit": "um"}
    # without the line that only xlook has, a header may not lack a name
    lines = [line for line in path.read_text().splitlines() if "recs" not in line]
    path.write_text("\n".join(lines))
    with pytest.raises(rs.ParameterError, match="has 4 names for 5 columns"):
        read_lab(path)
