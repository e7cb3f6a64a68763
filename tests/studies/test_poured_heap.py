"""Flow rules on heaps that stand in no study: which are round, which are not."""

import numpy as np
import pandas as pd
import pytest

from bcre_pde import Material
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import REPORTS
from bcre_studies.validation.poured_heap import heaps, rills, study

SMALL = heaps.Heap(Material(0.8, 0.15, 1.5, 0.6), heaps.POURED.start, 16.0, 70.0, 6.0, 2.0)


@pytest.fixture(scope="module")
def radial():
    return heaps.reference(SMALL, 64)


@pytest.mark.parametrize("flow", ["split4", "facet8"])
def test_a_heap_comes_to_the_radial_solution_as_cells_shrink(flow, radial):
    errors = [heaps.difference(heaps.heap(SMALL, flow, d), d, *radial) for d in (1.0, 0.5)]
    assert errors[1] < 0.02
    assert errors[0] / errors[1] > 1.5


def test_a_heap_of_d8_is_an_octagon(radial):
    h = heaps.heap(SMALL, "d8", 0.5)
    assert heaps.difference(h, 0.5, *radial) > 0.04
    level = 0.1 * h.max()
    feet = [heaps.foot(h, 0.5, degrees, level) for degrees in (0.0, 22.5, 45.0)]
    assert feet[1] < 0.96 * min(feet[0], feet[2])


def test_the_foot_of_a_cone_is_where_it_meets_the_level():
    h = np.maximum(10 - 0.5 * heaps.radii(30.0, 0.5), 0)
    for degrees in (0.0, 30.0, 45.0):
        assert heaps.foot(h, 0.5, degrees, 1.0) == pytest.approx(18.0, abs=0.1)


def test_ripples_grow_at_their_rate_on_split4_and_not_at_all_on_d8():
    k, expected, measured = rills.growth("split4", 0.001, 12)
    assert k == pytest.approx(2 * np.pi * 12 / 32)
    assert measured == pytest.approx(expected, rel=0.05)
    assert abs(rills.growth("d8", 0.001, 12)[2]) < 1e-3 * expected


@pytest.fixture(scope="module")
def recorded():
    return pd.read_csv(REPORTS / "poured_heap" / "comparison.csv")


def verdicts(table):
    return {claim.name: claim.verdict for claim in study.judge({"comparison": table})}


def test_the_report_says_that_d8_does_not_converge_where_the_others_do(recorded):
    found = verdicts(recorded)
    for quantity in ("poured heap", "silo"):
        ends = [found[f"{quantity}, {flow}"] for flow in study.FLOWS]
        assert ends == [Verdict.AGREE, Verdict.AGREE, Verdict.DISAGREE]
    rows = recorded[(recorded["quantity"] == study.POURED) & (recorded["d"] == 0.25)]
    assert (rows.set_index("flow")["difference"] > 0.05).to_dict() == {
        "split4": False,
        "facet8": False,
        "d8": True,
    }


@pytest.mark.parametrize(
    ("claim", "column", "value"),
    [
        ("poured heap, split4", "difference", 0.012),
        ("silo, facet8", "difference", 0.04),
        ("collapse, split4", "difference", 0.03),
        ("rills, split4", "growth", 0.02),
    ],
)
def test_a_verdict_turns_when_its_number_does(recorded, claim, column, value):
    quantity, flow = claim.split(", ")
    row = (recorded["quantity"] == quantity) & (recorded["flow"] == flow)
    assert verdicts(recorded)[claim] is Verdict.AGREE
    turned = recorded.assign(**{column: recorded[column].where(~row, value)})
    assert verdicts(turned)[claim] is Verdict.DISAGREE
