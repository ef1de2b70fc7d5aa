"""What readings show together, in nats: kinematics, course, the answer to the rudder, waves."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from seatrial.data.readings.grids import Signal
from seatrial.numerics.local_polynomials import white_variance

Slots = Mapping[str, tuple[Signal, ...]]
"""What the readings of some variables show, on each grid."""
_LAGS = (1, 3, 9)  # bins over which rates are taken; the clearest counts; chosen
_MOST_NUMBERS = 40.0  # independent numbers that a comparison counts for at most; chosen: models are never exact
_CAP, _LEAST = 15.0, -10.0  # nats that one relation counts for softly, and that it costs at most; chosen
# share of the difference that is disagreement, and from which on a relation is no proof; chosen
_DISAGREEING, _PROVING = 0.08, 0.04
_HALF = 0.5  # share of the difference from which on two signals are unlike; chosen
_DISAGREEMENT = 6.0  # nats for each e-fold of the share beyond that; chosen
_MEANS = {"rate": 4.0, "ahead": 8.0, "aside": 2.0, "over ground": 5.0}  # nats' weight of means that agree; chosen
_CURRENT, _CURRENT_M_S = 0.12, 0.05  # of the speed, and m/s, by which a current may explain a mean; chosen
# sd of drift and compass errors [rad], share of logs that have them, numbers that directions count for; chosen
_COURSE_SD, _COURSE_SHARE, _COURSE_NUMBERS = math.radians(10.0), 0.9, 14.0
_SLOW = 0.3  # of the fastest speed, below which a craft has no course; chosen
_TURNING_CAP, _WAVES, _WAVES_SURE = 12.0, 6.0, 0.5  # nats, nats, share in phase from which a sign is sure; chosen
_LONG_WAVES = 0.5  # share of the waves' energy up to which they count as long; chosen
_FLOOR = 1e-9  # share of the variance that is rounding


@dataclass(frozen=True)
class Relation:
    """A relation of roles: its name for people, the roles that it compares, and its nats.

    roles: any one of each group must be there.
    """

    text: str
    roles: tuple[tuple[str, ...], ...]
    nats: Callable[[Slots], float]


def independent_numbers(values: Signal, beside: Signal | None = None) -> float:
    """Return for how many independent numbers a product of two signals counts: 2 sum S sum B / sum S B of spectra S, B.

    Bartlett 1946 (Journal of the Royal Statistical Society, Supplement 8, 27-41): the variance of a correlation of two
    independent series; of a signal with itself the degrees of freedom of a spectrum's sum (Priestley 1981, Spectral
    Analysis and Time Series, section 6.2.3).

    beside: the other signal; None: the signal itself.
    """
    power = np.abs(np.fft.rfft(values - values.mean())) ** 2
    other = power if beside is None else np.abs(np.fft.rfft(beside - beside.mean())) ** 2
    total = float((power * other).sum())
    return min(2.0 * float(power.sum()) * float(other.sum()) / total, _MOST_NUMBERS) if total > 0.0 else 0.0


def softly(nats: float, cap: float = _CAP) -> float:
    """Return nats that grow slowly beyond a cap, so that the better of two good readings still shows."""
    return nats if nats <= cap else cap + 2.0 * math.log1p(0.5 * (nats - cap))


def identity(first: Signal, second: Signal, means: float, noise: float = 0.0) -> float:
    """Return the nats for two signals being the same, (n,) each; negative where both move and disagree.

    means: nats' weight of means that agree; noise: variance of their difference that is no disagreement.
    """
    finite = np.isfinite(first) & np.isfinite(second)
    a, b = first[finite], second[finite]
    if a.size < 2 * max(_LAGS):
        return 0.0
    signals = np.stack([a, b, a - b])  # one call for all three: the arrays are short
    variances, squares, mean = np.var(signals, axis=1), np.mean(signals**2, axis=1), np.mean(signals, axis=1)
    total, scale, difference = float(variances[0] + variances[1]), float(squares[0] + squares[1]), float(variances[2])
    if total <= _FLOOR * scale or scale == 0.0:
        return 0.0
    share, disagreement = difference / total + _FLOOR, max(difference - noise, 0.0) / total + _FLOOR
    nats = _CAP * max(1.0 - 2.0 * share, 0.0) ** 2
    if share <= _HALF:
        count = min(independent_numbers(b), independent_numbers(a))
        proof = -0.5 * count * math.log(share)
        nats = proof if share <= _PROVING else min(proof, nats)
    nats -= max(_DISAGREEMENT * math.log(disagreement / _DISAGREEING), 0.0)
    if means:
        alike = min(max((_HALF - disagreement) / (_HALF - _DISAGREEING), 0.0), 1.0)
        off = float(mean[2]) ** 2 / (float(mean[0] ** 2 + mean[1] ** 2) + _FLOOR * scale)
        nats -= 0.5 * means * alike * math.log(off + _PROVING)
    return max(softly(nats), _LEAST)


def _rates(signal: Signal, lag: int) -> Signal:
    return signal[lag:] - signal[:-lag]


def _integral(rate: Signal, lag: int) -> Signal:
    """The integral of a rate over so many bins, in bins."""
    total = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))])
    return total[lag:] - total[:-lag]


def _derivative(angle: tuple[Signal, ...], rate: tuple[Signal, ...], steps: Sequence[float]) -> float:
    """The nats for one signal being the derivative of another; the clearest grid and lag counts."""
    results = [
        identity(_rates(a, lag), step * _integral(r, lag), _MEANS["rate"], noise)
        for a, r, step in zip(angle, rate, steps, strict=True)
        for lag in _LAGS
        for noise in [2.0 * white_variance(a) + lag * step**2 * white_variance(r)]  # of the difference
    ]
    return max(results, key=abs, default=0.0) if max(results, default=0.0) <= 0.0 else max(results)


@dataclass(frozen=True)
class Relations:
    """The relations of a run's readings on grids with these steps [s]."""

    steps: tuple[float, ...]

    @property
    def terms(self) -> tuple[Relation, ...]:
        """All relations."""
        over_ground = ("place", "fixes", "velocity", "sog")
        return (
            Relation("the rate of the heading", (("heading",), ("r",)), self._yaw_rate),
            Relation("the rate of the course", (("place", "fixes"), ("r",), ("no heading",)), self._course_rate),
            Relation("the rate of roll", (("phi",), ("p",)), lambda s: _derivative(s["phi"], s["p"], self.steps)),
            Relation("the derivative of position", (("place", "fixes"), ("velocity",), ("heading",)), self._track),
            Relation("the speed of the track", (("place", "fixes"), ("sog", "stw", "u")), self._speed),
            Relation("the course over ground", (over_ground, ("heading",)), self._course),
            Relation("the course of the track", (("place", "fixes"), ("cog",)), self._track_course),
            Relation("the fixes", (("place",), ("fixes",)), self._fixes),
            Relation("the turn that follows", (("delta",), ("r", "heading")), self._rudder),
            Relation("the waves", (("zeta",), ("z",)), lambda s: -_in_phase(s, "z", 1.0)),
            Relation("the slope of the waves", (("zeta",), ("theta",)), lambda s: _in_phase(s, "theta", 1j)),
        )

    def _yaw_rate(self, slots: Slots) -> float:
        return _derivative(slots["psi"], slots["r"], self.steps)

    def _course_rate(self, slots: Slots) -> float:
        course = tuple(np.unwrap(np.angle(v)) for v in self._velocities(slots["track"]))
        return _derivative(course, tuple(r[1:] for r in slots["r"]), self.steps)

    def _velocities(self, track: tuple[Signal, ...], lag: int = 1) -> Iterator[Signal]:
        for place, step in zip(track, self.steps, strict=True):
            yield (place[lag:] - place[:-lag]) / (lag * step)

    def _track(self, slots: Slots) -> float:
        """Velocities against the derivative of position, ahead and aside, less a current."""
        is_hull = "along the hull" in slots
        results, place_variance = [], self._place_variance(slots["track"][-1])
        for k, step in enumerate(self.steps):
            for lag in _LAGS[::2]:
                velocity = (slots["along the hull"] if is_hull else slots["over ground"])[k]
                axes = np.exp(1j * slots["psi"][k]) if is_hull else np.ones(len(velocity))
                mean = _integral(velocity * axes, lag) / lag
                rate = (slots["track"][k][lag:] - slots["track"][k][:-lag]) / (lag * step)
                turn = np.conj(_midway(axes, lag))
                off = _less_current(rate - mean, mean)
                noise = 2.0 * (place_variance / step) / (lag * step) ** 2  # of a difference
                means = (_MEANS["ahead"], _MEANS["aside"]) if is_hull else (_MEANS["over ground"],) * 2
                ahead = identity(((mean + off) * turn).real, (mean * turn).real, means[0], noise)
                aside = identity(((mean + off) * turn).imag, (mean * turn).imag, means[1], noise)
                results.append(ahead + aside)
        return max(results, default=0.0)

    def _place_variance(self, fine: Signal) -> float:
        """Variance [m^2 s] of white noise of a coordinate in bins of one second, by third differences of fine bins."""
        length = _LAGS[1]  # bins that are averaged: narrower ones than the samples hold no noise of their own
        means = np.mean(fine[: len(fine) // length * length].reshape(-1, length), axis=1)
        return 0.5 * white_variance(means) * length * self.steps[-1]  # 0.5: of two coordinates

    def _speed(self, slots: Slots) -> float:
        """A speed against that of the track."""
        speed = next(slots[s] for s in ("sog", "stw", "u") if s in slots)
        results = [0.0]
        for k, v in enumerate(self._velocities(slots["track"], _LAGS[1])):
            size, logged = np.abs(v), _integral(np.abs(speed[k]), _LAGS[1]) / _LAGS[1]
            if not np.any(np.isfinite(size - logged)):
                continue
            off = float(np.nanmean(size - logged))
            bound = _CURRENT * float(np.nanmean(logged)) + _CURRENT_M_S
            ratio = abs(off) / max(bound, 1e-9)  # never a zero
            nats = _MEANS["ahead"] - 0.5 * ratio**2 if np.isfinite(ratio) else 0.0
            results.append(max(nats, _LEAST) + 0.5 * identity(size - off, logged, 0.0))
        return max(results[1:], default=0.0)

    def _course(self, slots: Slots) -> float:
        """Where the craft points against where it goes."""
        return max((_alike(v, psi) for v, psi in self._courses(slots)), key=abs, default=0.0)

    def _courses(self, slots: Slots) -> Iterator[tuple[Signal, Signal]]:
        psi = slots["psi"]
        if "along the hull" in slots and "track" not in slots:
            yield from ((v, np.zeros(len(v))) for v in slots["along the hull"])
        elif "track" in slots:
            pairs = zip(self._velocities(slots["track"], _LAGS[0]), psi, strict=True)
            yield from ((v, 0.5 * (p[1:] + p[:-1])) for v, p in pairs)
        elif "over ground" in slots:
            yield from zip(slots["over ground"], psi, strict=True)
        elif "sog" in slots and "cog" in slots:
            yield from ((s * np.exp(1j * c), p) for s, c, p in zip(slots["sog"], slots["cog"], psi, strict=True))

    def _track_course(self, slots: Slots) -> float:
        pairs = zip(self._velocities(slots["track"]), slots["cog"], strict=True)
        return max((_alike(v, 0.5 * (c[1:] + c[:-1])) for v, c in pairs), key=abs, default=0.0)

    def _fixes(self, slots: Slots) -> float:
        """A pose against the fixes of the same run."""
        results = [
            identity(np.real(p), np.real(f), 0.0) + identity(np.imag(p), np.imag(f), 0.0)
            for p, f in zip(slots["place track"], slots["track"], strict=True)
        ]
        return results[0] if results else 0.0

    def _rudder(self, slots: Slots) -> float:
        """The yaw acceleration, the turn that follows and its changes against the rudder (Nomoto 1957, eq. 1)."""
        signed = [0.0]
        for k, step in enumerate(self.steps):
            delta = slots["delta"][k]
            delta = delta - delta[np.isfinite(delta)][:1].sum()  # a rudder that stays is exactly zero
            signed += self._answers(slots["r"][k] if "r" in slots else np.gradient(slots["psi"][k], step), delta)
        for_it, against = max(signed), -min(signed)
        nats = for_it - 0.5 * against if for_it >= against else -(against - 0.5 * for_it)
        return math.copysign(min(abs(nats), _TURNING_CAP), nats)

    def _answers(self, rate: Signal, delta: Signal) -> list[float]:
        """Signed nats for a yaw rate answering a rudder; of readings to the other side they have the other sign."""
        sides = _side(rate), _side(delta)
        rate, delta = (side * values + 0.0 for side, values in zip(sides, (rate, delta), strict=True))  # -0 + 0 is 0
        if (key := (rate.tobytes(), delta.tobytes())) not in self._known_answers:
            self._known_answers[key] = _answers(rate, delta)
        return [sides[0] * sides[1] * nats for nats in self._known_answers[key]]

    @cached_property
    def _known_answers(self) -> dict[tuple[bytes, bytes], list[float]]:
        """Yaw rate and rudder as bytes -> the nats of their answers."""
        return {}


def _side(values: Signal) -> float:
    """The sign of the first value that has one."""
    signs = np.sign(values[np.isfinite(values)])
    return float(signs[np.argmax(signs != 0.0)]) or 1.0 if signs.size else 1.0


def _answers(rate: Signal, delta: Signal) -> list[float]:
    signed = list[float]()
    for lag in (*_LAGS, 3 * _LAGS[-1]):
        mean_rate, mean_delta = _integral(rate, lag) / lag, _integral(delta, lag) / lag
        signed.append(_signed_nats(_rates(rate, lag), mean_delta, mean_rate, lag))
        signed.append(_signed_nats(rate[lag:], delta[:-lag], None, lag))
        # a turn that falls again under the same rudder follows it by its changes alone
        signed.append(_signed_nats(_rates(rate, lag), mean_delta - delta[:-lag], None, lag))
    return signed


def _midway(axes: Signal, lag: int) -> Signal:
    mean = _integral(axes, lag)
    return mean / np.maximum(np.abs(mean), _FLOOR)


def _less_current(off: Signal, velocity: Signal) -> Signal:
    """The residual of the track without what a steady current may be."""
    finite, speed = off[np.isfinite(off)], np.abs(velocity)
    if not finite.size:
        return off
    mean, bound = complex(np.mean(finite)), _CURRENT * float(np.mean(speed[np.isfinite(speed)])) + _CURRENT_M_S
    return off - (mean * min(1.0, bound / abs(mean)) if abs(mean) > 0.0 else 0.0)


def _alike(velocity: Signal, angle: Signal) -> float:
    """The nats for a velocity north + i east pointing along an angle: its turns, then its mean direction."""
    finite = np.isfinite(velocity) & np.isfinite(angle)
    v, a = velocity[finite], angle[finite]
    if v.size < 2 * max(_LAGS) or np.max(np.abs(v)) == 0.0:
        return 0.0
    moving = np.abs(v) > _SLOW * np.max(np.abs(v))
    course, heading = np.exp(1j * np.angle(v[moving])), np.exp(1j * a[moving])
    off = complex(np.mean(course * np.conj(heading)))
    apart = float(np.angle(off))
    spread = float(np.var(course) + np.var(heading))
    nats = 0.0
    if spread > 2.0 * _COURSE_SD**2:
        share = float(np.var(course - heading * np.exp(1j * apart))) / spread + _FLOOR
        count = min(max(independent_numbers(np.real(course)), independent_numbers(np.imag(course))), _COURSE_NUMBERS)
        nats = max(-0.5 * count * math.log(max(share, _PROVING)), _LEAST)
        nats -= _DISAGREEMENT * math.log(share / _HALF) if share > _HALF else 0.0
    density = math.exp(-0.5 * (apart / _COURSE_SD) ** 2) / (_COURSE_SD * math.sqrt(2.0 * math.pi))
    return max(nats + math.log(_COURSE_SHARE * density * math.tau + 1.0 - _COURSE_SHARE), _LEAST)


def _signed_nats(answer: Signal, cause: Signal, beside: Signal | None, lag: int) -> float:
    """Nats for an answer to a cause, with the sign of the partial correlation."""
    columns = [np.ones(len(answer)), *([] if beside is None else [beside])]
    table = np.stack([*columns, cause, answer], axis=1)
    table = table[np.all(np.isfinite(table), axis=1)][:: max(lag // 2, 1)]
    if len(table) < 2 * _LAGS[-1] // 2 or np.ptp(table[:, -2]) == 0.0:
        return 0.0
    basis = np.linalg.qr(table[:, :-2])[0]
    residuals = table[:, -2:] - basis @ (basis.T @ table[:, -2:])
    power = np.sum(residuals**2, axis=0)
    if np.min(power) <= _FLOOR * np.sum(table[:, -1] ** 2) or np.min(power) == 0.0:
        return 0.0
    product = float(residuals[:, 0] @ residuals[:, 1])
    correlation = product / math.sqrt(power[0] * power[1])
    if correlation**2 < _PROVING:
        return 0.0
    unexplained = residuals[:, 1] - residuals[:, 0] * product / power[0]
    count = independent_numbers(residuals[:, 0], unexplained)
    return math.copysign(0.5 * max(count - 1.0, 0.0) * -math.log1p(-min(correlation**2, 1.0 - _FLOOR)), correlation)


def _in_phase(slots: Slots, motion: str, slope: complex) -> float:
    """Nats for a motion in long waves being in phase with their elevation, or with its rate."""
    waves, moved = (_spectrum(slots[s][-1]) for s in ("zeta", motion))
    energy = np.cumsum(np.abs(waves) ** 2)
    if energy[-1] == 0.0:
        return 0.0
    long = energy <= _LONG_WAVES * energy[-1]
    followed = waves[long] * slope
    size = float(np.sqrt(np.sum(np.abs(followed) ** 2) * np.sum(np.abs(moved[long]) ** 2)))
    share = float(np.real(np.sum(np.conj(followed) * moved[long]))) / size if size > 0.0 else 0.0
    return _WAVES * max(min(share / _WAVES_SURE, 1.0), -1.0)


def _spectrum(values: Signal) -> Signal:
    finite = np.nan_to_num(values)
    return np.fft.rfft((finite - np.mean(finite)) * np.hanning(len(finite)))
