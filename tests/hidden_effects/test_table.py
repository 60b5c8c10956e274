"""The arithmetic of the score by hand."""

import pytest
from table import captured, ece, head, metrics, share, wilson


def named(id_, component, probability, value=1.0):
    effect = {"id": id_, "component": component, "probability": probability, "params": {"factor": {"value": value, "lo": 0.9 * value, "hi": 1.1 * value}}}
    return {"verdict": "named", "effects": [effect], "class": [], "tried": [], "seconds": 2.0, "show_rmse_before": {"T": 3.0, "dp": 1.0},
            "show_rmse_after": {"T": 1.0, "dp": 1.05}, "z_fitted": {"T": 1.1, "dp": 1.3}, "oracle": {"T": 0.5, "dp": 1.0}}


NOTHING = {"verdict": "nothing", "effects": [], "class": [], "tried": [], "seconds": 4.0}


def single(id_, component, value=1.0, stratum="easy", more=()):
    return {"kind": "single", "rich": True, "stratum": stratum, "effects": [{"id": id_, "component": component, "parameter": "factor", "value": value}],
            "class": [[id_, component], *more], "strict": [[id_, component]], "near": [component, "beside"], "untouched": ["dp"]}


def test_interval_of_wilson():
    # 8 of 10: middle (0.8 + 0.19208)/1.38416 = 0.71674, half 1.96 sqrt(0.016 + 0.009604)/1.38416 = 0.22658.
    lo, hi = wilson(8, 10)
    assert lo == pytest.approx(0.4902, abs=1e-4) and hi == pytest.approx(0.9433, abs=1e-4)
    assert wilson(0, 0) == (0.0, 1.0) and share([]) == "no case"


def test_calibration():
    # Two say 0.9, one is right: |1.8 - 1|/2 = 0.4; Brier (0.1^2 + 0.9^2)/2 = 0.41.
    results = {"a": named("P1", "pipe", 0.9), "b": named("P2", "pipe", 0.9)}
    error, brier, n = ece(results, lambda n: n == "a")
    assert (error, brier, n) == (pytest.approx(0.4), pytest.approx(0.41), 2)


def test_share_of_the_gap():
    # T: (3 - 1)/(3 - 0.5) = 0.8; dp has no gap.
    assert captured(named("P1", "pipe", 0.9)) == pytest.approx(0.8)


def test_what_counts_as_right():
    answers = {"null": {"kind": "null", "rich": True, "edge": False}, "hit": single("P2", "pipe", 2.0), "like": single("P1", "pipe", more=[["P10", "pipe"]]),
               "missed": single("P2", "pipe", 2.0)}
    results = {"null": NOTHING, "hit": named("P2", "pipe", 0.9, 1.8), "like": named("P10", "pipe", 0.7), "missed": NOTHING}
    assert head(results["like"]) == ("P10", "pipe")
    rows = {name: reached for name, reached, _ in metrics(answers, results)}
    assert rows["false alarms on nulls"].startswith("0 %")
    assert rows["detection, medium and easy"].startswith("67 %")
    assert rows["first name in the true class, of all medium and easy"].endswith("2/3)")
    assert rows["first name in the class of 3 nats alone, of all medium and easy"].endswith("1/3)")
    assert rows["first name exactly right"].endswith("1/3)")
    # 1.8 instead of 2, over 2 - 1.
    assert rows["error of the parameter, median"].startswith("20.0 %")
    # T is affected, dp is not.
    assert rows["residuals at the affected sensors at most 1.2 sigma"].startswith("100 %")
    assert rows["share of the gap closed, median (10th percentile)"].startswith("0.80")
    # dp is untouched and 5 % worse, twice.
    assert rows["unaffected sensors made worse by more than 2 %"] == "2 of 2"
    assert rows["seconds a case, median (95th percentile)"] == "3 (4)"
