"""The table and what it says: columns, CSV and Parquet, coverage, failures, maps."""

import csv
from pathlib import Path

import pytest
from scipy.stats import binomtest
from tests.campaigns.tasks import work

from seatrial.campaigns import Store, Work, open_store
from seatrial.campaigns.run_campaign import CampaignOptions, run_campaign
from seatrial.campaigns.summary import campaign_summary, campaign_table, coverage_interval, failure_reasons, write_table
from seatrial.core.values import InputError


def over_keys(keys: dict) -> list[dict]:
    """Error over bound 2 x + y at the truth 1."""
    row = {"row": "coefficient", "name": "a", "unit": "1", "truth": 1.0, "bound": 0.5, "lower": 0.0, "upper": 2.0}
    score = {"row": "score", "name": "rms psi_deg", "unit": "deg", "run": "zz", "estimate": float(keys["y"])}
    return [{**row, "estimate": 1.0 + 0.5 * (2 * keys["x"] + keys["y"])}, score]


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    folder = tmp_path_factory.mktemp("gather") / "store"
    run_campaign(work(), folder, CampaignOptions(workers=1))
    return open_store(folder)


def test_csv_holds_every_number_to_the_last_bit(store: Store, tmp_path: Path) -> None:
    table = campaign_table(store)
    assert table.keys == ("seed",)
    write_table(table, tmp_path / "t.csv")
    with (tmp_path / "t.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(table) == 24 * 2 + 6
    first = [row for row in rows if row["seed"] == "3" and row["name"] == "a"]
    assert [float(row["estimate"]) for row in first] == [3.1**2]
    assert sum(row["failure"] != "" for row in rows) == 6


def test_parquet_holds_the_same(store: Store, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table = campaign_table(store)
    for name in ("one.parquet", "two.parquet"):
        write_table(table, tmp_path / name)
    back = parquet.read_table(tmp_path / "one.parquet").to_pydict()
    assert back == {name: list(values) for name, values in table.columns.items()}
    assert (tmp_path / "one.parquet").read_bytes() == (tmp_path / "two.parquet").read_bytes()


def test_another_ending_and_an_empty_store_are_refused(store: Store, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither a \.csv nor a \.parquet"):
        write_table(campaign_table(store), tmp_path / "t.xlsx")
    empty = run_campaign(work(2), tmp_path / "empty", CampaignOptions(workers=1))
    assert empty.done == 2
    for path in (tmp_path / "empty" / "journals").iterdir():
        path.unlink()
    with pytest.raises(InputError, match="no result yet"):
        campaign_table(open_store(tmp_path / "empty"))


def test_reasons_that_differ_in_numbers_are_one(store: Store) -> None:
    reasons = list(failure_reasons(campaign_table(store)))
    assert [(r.count, r.example) for r in reasons] == [
        (4, "seed 6 has no square today; take another"),
        (2, "an error of the program (ZeroDivisionError): division by zero"),
    ]


def test_coverage_counts_intervals_that_hold_the_truth(store: Store) -> None:
    summary = campaign_summary(store, campaign_table(store))
    a, b = summary.coefficients
    assert (a.intervals, a.covered, b.covered) == (24, 24, 24)
    assert a.truth == 1.0
    assert a.coverage_interval == pytest.approx(binomtest(24, 24).proportion_ci(0.95, "exact"))
    assert a.rmse_over_bound == pytest.approx((a.rmse or 0.0) / 2.0)
    assert sum(a.error_counts) == 24


@pytest.mark.parametrize(("covered", "count"), [(0, 5), (5, 5), (93, 100), (1, 40)])
def test_the_interval_of_a_share_is_that_of_scipy(covered: int, count: int) -> None:
    low, high = binomtest(covered, count).proportion_ci(0.95, "exact")
    assert coverage_interval(covered, count) == pytest.approx((low, high))


def test_maps_over_two_keys(tmp_path: Path) -> None:
    keys = [{"x": x, "y": y, "seed": 0} for x in (1, 2, 3) for y in (0.5, 1.5)]
    run_campaign(Work({"kind": "grid"}, keys, over_keys), tmp_path / "store", CampaignOptions(workers=1))
    opened = open_store(tmp_path / "store")
    errors, scores = campaign_summary(opened, campaign_table(opened)).maps
    assert (errors.row_key, errors.column_key, errors.rows, errors.columns) == (
        "x",
        "y",
        ("1", "2", "3"),
        ("0.5", "1.5"),
    )
    assert [list(row) for row in errors.values] == [[2.5, 3.5], [4.5, 5.5], [6.5, 7.5]]
    assert scores.quantity == "median rms psi_deg, deg"
    assert scores.values[0] == (0.5, 1.5)
