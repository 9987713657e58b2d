# ruff: noqa: RUF001 (titles of files in Japanese and Chinese)
"""Titles and units in other languages and encodings, and headers of other programs."""

import json

import numpy as np
import pytest

import ratestate as rs
from ratestate.records.reading import titles
from ratestate.records.reading.titles import LIKE, match_rank

N = 120
T = np.arange(N) * 0.25
X = np.where(T < 15, T, 10 * T - 135)  # a step from 1 to 10 um/s at 15 s
MU = 0.6 + 0.003 * np.sin(T) + 0.0001 * T
SIGMA = np.full(N, 20.0)  # MPa


def write(path, header, columns, delimiter="\t", encoding="utf-8", number=repr):
    rows = zip(*columns, strict=True)
    lines = [header, *(delimiter.join(number(float(x)) for x in row) for row in rows)]
    path.write_bytes("\n".join(lines).encode(encoding))
    return path


def check(data):
    np.testing.assert_allclose(data.time, T, rtol=1e-14)
    np.testing.assert_allclose(data.delta_lp, 1e-6 * X, rtol=1e-14, atol=1e-20)
    np.testing.assert_allclose(data.friction, MU, rtol=1e-14)
    np.testing.assert_allclose(data.sigma, 2e7, rtol=1e-14)


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
        path = write(tmp_path / "r.txt", header.replace("|", "\t"), columns, encoding=encoding)
        data = rs.read_lab(path)
        check(data)
        known = json.loads(data.attrs["columns"]).values()
        assert [one["title"] for one in known] == header.split("|"), encoding


#: symbol -> titles, with units or without
SPELLINGS = {
    "time": "Zeit;Messzeit [s];temps écoulé (s);Tempo decorrido;Tiempo transcurrido;経過時間;时间",
    "delta_lp": "Scherweg [mm];Weg;Kolbenweg;Lastpunktverschiebung;Déplacement cumulé;"
    "déplacement de cisaillement;Spostamento del pistone;Desplazamiento de corte;せん断変位;"
    "載荷点変位;剪切位移;ｽﾄﾛｰｸ変位",
    "V_load": "Geschwindigkeit;Vitesse (µm/s);Velocità;velocidad;velocidade;速度;"
    "载荷点速度;剪切速率",
    "friction": "Reibungskoeffizient;Reibbeiwert;Reibungszahl;coefficient de frottement;"
    "Coefficiente d'attrito;coefficiente di attrito;Attrito;Fricción;coeficiente de fricción;"
    "Coeficiente de rozamiento;coeficiente de atrito;摩擦係数;摩擦系数",
    "tau": "Schubspannung;Scherspannung;contrainte de cisaillement;sforzo di taglio;"
    "tensione tangenziale;esfuerzo cortante;tensão cisalhante;剪断応力;剪应力;Scherkraft",
    "sigma": "Normalspannung;effektive Normalspannung;contrainte normale effective;"
    "tensione normale;esfuerzo normal efectivo;tensão normal;法線応力;正应力;"
    "有效正应力;Normalkraft",
}


@pytest.mark.parametrize("symbol", SPELLINGS)
def test_spellings_of_other_languages(symbol):
    for title in SPELLINGS[symbol].split(";"):
        name = titles.split(title)[0]
        known = [symbol for symbol in LIKE if match_rank(name, symbol) is not None]
        assert known == [symbol], title


@pytest.mark.parametrize(
    "title",
    ["Gleitweg", "Normalverschiebung [mm]", "Probendicke", "déplacement normal", "glissement",
     "spostamento normale", "desplazamiento normal", "垂直変位",
     "法向位移", "すべり変位", "厚さ変位"],
)  # fmt: skip
def test_displacements_of_others_in_other_languages(title):
    assert match_rank(titles.split(title)[0], "delta_lp") is None


def test_two_columns_of_one_meaning_remain_an_error(tmp_path):
    header = "Zeit [s]\tWeg A [µm]\tWeg B [µm]\tReibung"
    path = write(tmp_path / "r.txt", header, [T, X, X, MU])
    with pytest.raises(rs.ParameterError, match=r"delta_lp may be any of .*'Weg A \[µm\]'"):
        rs.read_lab(path)


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
    from ratestate.records.reading.sizes import in_si, unit_of
    from ratestate.records.reading.table import Column

    unit = unit_of(Column("x", "x", written, T), read, {})
    np.testing.assert_allclose(in_si(read, np.array([1.0, 2.0]), unit), [factor, 2 * factor], 1e-14)


def test_decimal_commas_and_a_row_of_units(tmp_path):
    header = "Zeit;Weg;Reibungskoeffizient;Normalspannung\ns;µm;-;N/mm²"
    path = write(tmp_path / "r.csv", header, [T, X, MU, SIGMA], ";", "cp1252",
                 lambda x: repr(x).replace(".", ","))  # fmt: skip
    check(rs.read_lab(path))


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
    data = rs.read_lab(path)
    check(data)
    columns = json.loads(data.attrs["columns"])
    assert columns["delta_lp"] == {"title": "LP_Disp", "unit": "um"}
    # without the line that only xlook has, a header may not lack a name
    lines = [line for line in path.read_text().splitlines() if "recs" not in line]
    path.write_text("\n".join(lines))
    with pytest.raises(rs.ParameterError, match="has 4 names for 5 columns"):
        rs.read_lab(path)


def test_dates_with_clock_times_beside_the_time(tmp_path):
    path = write(tmp_path / "r.txt", "Time (s)\tDisp (um)\tmu\tsigma (MPa)", [T, X, MU, SIGMA])
    head, *rows = path.read_text("utf-8").splitlines()
    stamped = [f"2019-05-14 12:00:{i % 60:02}\t{row}" for i, row in enumerate(rows)]
    path.write_text("\n".join([f"Date\t{head}", *stamped]), "utf-8")
    check(rs.read_lab(path))
