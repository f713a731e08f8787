"""docs/slips.md says what `check` says."""

from __future__ import annotations

import pytest

from tests.language import slips


@pytest.mark.parametrize("slip", slips.slips(), ids=lambda slip: slip.text[:50])
def test_a_slip_is_told_as_the_table_says(slip: slips.Slip) -> None:
    assert slips.said(slip.place, slip.text) == slip.now


def test_every_slip_has_one_finding_with_a_way_out() -> None:
    rows = slips.slips()
    assert len(rows) >= 150
    assert [slip.text for slip in rows if "more)" in slip.now] == []
    assert [slip.text for slip in rows if not slip.now.endswith((".", "?"))] == []


def test_the_sketch_itself_has_no_findings() -> None:
    assert slips.said("more", "") == "nothing"
