"""Headings in other languages are known by the English ones; what no table has is stated."""

from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from seatrial.api import draft_trial
from seatrial.core.values import InputError
from seatrial.data.draft.naming import guess_by_name, in_english, stated_columns, without_accents
from seatrial.data.draft.survey import survey_log
from seatrial.data.readings import name_table


@pytest.mark.parametrize(
    ("heading", "symbol", "unit"),
    [("Kurs (gyro) [°]", "psi", "deg"), ("Rorvinkel [°]", "delta", "deg"), ("Rørvinkel (°)", "delta", "deg"),
     ("Svinghastighet [°/s]", "r", "deg/s"), ("Fart over grunn [kn]", "sog", "kn"), ("Breedte [deg]", "lat", "deg"),
     ("Geschwindigkeit über Grund [kn]", "sog", "kn"), ("Kurs über Grund [°]", "cog", "deg"),
     ("track_deg", "cog", "deg"),
     ("Drehgeschwindigkeit [°/min]", "r", "deg/min"), ("Vitesse fond (kn)", "sog", "kn"),
     ("Angle de barre [deg]", "delta", "deg"), ("Ángulo de timón [deg]", "delta", "deg"),
     ("Giri elica [rpm]", "n", "rpm"),
     ("Propellervarvtal [rpm]", "n", "rpm"), ("Krängning [deg]", "phi", "deg"), ("Roulis [deg]", "phi", "deg"),
     ("Ruderwinkel BB [°]", "delta", "deg"), ("Roerhoek stuurboord", "delta", ""),
     ("Vindhastighet [m/s]", "wind_speed", "m/s"), ("Sollkurs [°]", "psi_ref", "deg")],
)  # fmt: skip
def test_a_heading_is_known_in_its_language(heading: str, symbol: str, unit: str) -> None:
    guess = guess_by_name("", heading, "")
    assert guess is not None and (guess.symbol, guess.unit) == (symbol, unit)


def test_letters_lose_their_accents_and_other_words_stay() -> None:
    assert without_accents("Rør Längd Größe Ángulo") == "ror langd grosse angulo"
    assert in_english("klokkeslett") == "time" and in_english("battery") == "battery"
    assert in_english("ror_babord") == "rudder_angle_babord" and in_english("data_ora") == "date_time"
    assert in_english("stamp") == "stamp" and in_english("balance") == "balance"


@pytest.mark.parametrize("quantity", sorted({"time", "date", "speed"} ^ set(name_table()["languages"]["danish"])))
def test_every_quantity_of_a_language_is_one_that_logs_hold(quantity: str) -> None:
    assert guess_by_name("", quantity, "") is not None


def log(path: Path, headings: str) -> Path:
    start = datetime(2026, 10, 14, 23, 59, 30)
    psi = 30.0 * np.sin(0.05 * np.arange(120))
    r = np.degrees(np.gradient(np.radians(psi), 1.0))
    rows = [f"{start + timedelta(seconds=k):%H:%M:%S};{psi[k]:.3f};{r[k]:.4f}" for k in range(120)]
    path.write_text("\n".join([headings, *rows]), encoding="utf-8")
    return path


def test_a_time_of_day_is_known_by_its_values_past_midnight(tmp_path: Path) -> None:
    (topic,) = survey_log(log(tmp_path / "run.csv", "Hvornår;Kurs;Girrate [°/s]")).topics
    assert (topic.time_note, topic.rate) == ("the only column of times of day", pytest.approx(1.0))
    assert topic.duration == pytest.approx(119.0)


def test_what_is_stated_of_columns_holds(tmp_path: Path) -> None:
    path = log(tmp_path / "run.csv", "A;B [°];C")
    with pytest.raises(
        InputError, match=r"is recognised by its heading: B \[°\], C; say what they are, as in --column"
    ):
        draft_trial(path)
    draft = draft_trial(path, columns=("A=time", "B [°]=heading", "C=r"))
    for part in ('time = { column = "A", unit = "utc" }', 'channels.psi = { column = "B [°]", unit = "deg" }',
                 'channels.r = { column = "C", unit = "deg/s" }', "by what was stated of it"):  # fmt: skip
        assert part in draft.text


@pytest.mark.parametrize(
    ("columns", "sentence"),
    [(("A",), "write HEADING=CHANNEL"), (("A=time", "A=psi"), "stated twice"), (("A=tim",), "no channel that a log"),
     (("X=time",), "no log has this column")],
)  # fmt: skip
def test_what_is_stated_wrongly_is_refused(columns: tuple[str, ...], sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence):
        draft_trial(log(tmp_path / "run.csv", "A;B;C"), columns=columns)


def test_headings_have_the_last_equals_sign_behind_them() -> None:
    assert stated_columns(["a = b=psi", "Klokke = time"]) == {"a = b": "psi", "Klokke": "time"}
    assert stated_columns(["steering=alpha_1"]) == {"steering": "alpha_1"}, "the direction of a thruster"


def test_a_folder_without_a_time_says_how_one_is_stated(tmp_path: Path) -> None:
    rows = [f"x{k % 3},{k * 7 % 5},{0.1 * k * k - k}" for k in range(40)]
    (tmp_path / "run.csv").write_text("\n".join(["Wann,heading,rpm", *rows]), encoding="utf-8")
    with pytest.raises(InputError, match=r"no column is a time; if it is 'Wann', add --column 'Wann=time'"):
        draft_trial(tmp_path)
