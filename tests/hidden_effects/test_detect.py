"""What can be seen, by hand. (Needs numba, as the truth does: `make explain-score` runs it, `make test` does not install that.)"""

import pytest

pytest.importorskip("numba", reason="the independent truth runs in .venv-score")

import numpy as np
from detect import Look, fitted, still, stratum
from sensors import Sensor

AT_S = np.array([0.0, 10.0, 20.0, 30.0])
EVERY = np.ones(4, dtype=bool)


def look(every=EVERY):
    """One sensor of noise 0.02 K, that is sqrt(1.25) 0.02 with the slow part, beside 27 degC; an effect adds 0.1 K to all samples."""
    sensor = Sensor("T", "pipe.t_k", "compare", "pt100_a", "K", "t")
    channels = {"t": np.array([np.full(40, 300.0), np.full(40, 300.1)])}
    there = Look([sensor], channels, AT_S, every)
    there.unread([channels])
    return there, there.of(channels, 1)


def test_gain_beside_noise():
    # r = 0.1/0.02236 = 4.472 four times: 4 * 20/2.
    there, r = look()
    assert r == pytest.approx(np.full(4, 20**0.5)) and there.gain(r) == pytest.approx(40.0)


def test_what_is_not_fitted_says_nothing():
    there, r = look(np.array([True, False, True, False]))
    assert there.gain(r) == pytest.approx(20.0)


def test_gain_beside_a_tolerance():
    # An offset of 0.1 K that is uncertain anyway: 80 - 80^2/81 = 0.988, half of it. It cannot be told from the effect.
    there, r = look()
    there.tolerate(r)
    there.ready()
    assert there.gain(r) == pytest.approx(0.5 * 80 / 81)
    assert there.cosine(r, 2 * r) == pytest.approx(1.0)
    # What alternates is none of it.
    other = r * np.array([1, -1, 1, -1])
    assert there.gain(other) == pytest.approx(40.0) and there.cosine(r, other) == pytest.approx(0.0)


def test_what_inputs_leave_open_with_the_effect():
    # As far off as the noise: half of the information.
    there, r = look()
    assert there.gain(r, there.sigma[None, :]) == pytest.approx(20.0)


def test_words_for_it():
    assert [stratum(x) for x in (4.9, 5, 14.9, 15, 59, 60)] == ["none", "hard", "hard", "medium", "medium", "easy"]
    split = '[[block]]\nrole = "identify"\nfrom_s = 0\nuntil_s = 10\n[[block]]\nrole = "show"\nfrom_s = 15\nuntil_s = 40\n'
    assert fitted(split, AT_S).tolist() == [True, True, False, False]
    # Nothing flows from 12 s on: within 3 s of that a meter may read nothing.
    flow = np.where(np.arange(40) < 12, 1.0, 0.0)
    assert still(flow, AT_S).tolist() == [False, True, True, True]
