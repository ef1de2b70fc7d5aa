"""Campaigns from Python: one call to run, one to look, one to gather."""

from pathlib import Path

import pytest
from tests.campaigns.tasks import work

import seatrial as st
from seatrial.api import campaign_status, gather_campaign, retry_campaign


def test_a_campaign_from_python(tmp_path: Path) -> None:
    reports: list[str] = []
    status = st.campaign(work(8), tmp_path / "store", workers=1, report_progress=reports.append)
    assert (status.done, status.failed, len(reports)) == (7, 1, 8)
    assert campaign_status(tmp_path / "store").remaining == 0
    summary = gather_campaign(tmp_path / "store", tmp_path / "t.csv", tmp_path / "t.html")
    assert len(summary.coefficients) == 2
    assert "7 of 8 tasks done, 1 failed" in (tmp_path / "t.html").read_text(encoding="utf-8")
    with pytest.raises(st.InputError, match="begun from Python"):
        retry_campaign(tmp_path / "store")


def test_no_workers_can_do_nothing(tmp_path: Path) -> None:
    with pytest.raises(st.InputError, match="0 workers can do nothing"):
        st.campaign(work(8), tmp_path / "store", workers=0)
