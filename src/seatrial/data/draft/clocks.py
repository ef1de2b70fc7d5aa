"""Clocks of the sources of one run that differ by whole quarters of an hour: local time beside UTC."""

import math
from collections.abc import Sequence
from dataclasses import replace

from seatrial.data.draft.survey import LogSurvey, TopicSummary
from seatrial.data.read.layout import TimeSpec

_ZONE_STEP_S = 900.0  # s; time zones differ by quarters of an hour
_LARGEST_ZONE_S = 15.0 * 3600.0  # s; of the zones in use
_LEAST_OVERLAP = 0.5  # of the shorter source, that the shift must give; chosen


def zone_offsets(surveys: Sequence[LogSurvey]) -> list[float]:
    """Return the s to add to the clock of each source of one run so that it runs with the others.

    The others are those that overlap with most; of equal numbers those with stamps in a message's header.
    """
    spans = [time_span(survey) for survey in surveys]
    counts = [
        (sum(_overlap(one, other) > 0.0 for other in spans), _has_header_stamp(survey))
        for one, survey in zip(spans, surveys, strict=True)
    ]
    reference = spans[max(range(len(spans)), key=lambda k: counts[k])]
    return [_zone_offset(span, reference) for span in spans]


def time_span(survey: LogSurvey) -> tuple[float, float]:
    """Return the first and the last stamp [s]; NaN where there is none."""
    topics = [topic for topic in survey.topics if math.isfinite(topic.start)]
    if not topics:
        return math.nan, math.nan
    return min(one.start for one in topics), max(one.start + one.duration for one in topics)


def _overlap(one: tuple[float, float], other: tuple[float, float]) -> float:
    return min(one[1], other[1]) - max(one[0], other[0])


def _has_header_stamp(survey: LogSurvey) -> bool:
    return any(isinstance(topic.time, TimeSpec) and bool(topic.time.nanoseconds) for topic in survey.topics)


def _zone_offset(span: tuple[float, float], reference: tuple[float, float]) -> float:
    """The s to add to a clock so that it runs with the reference; 0 where it does, or where no zone explains it."""
    if not math.isfinite(span[0] + reference[0]) or _overlap(span, reference) > 0.0:
        return 0.0
    offset = _ZONE_STEP_S * round((reference[0] - span[0]) / _ZONE_STEP_S)
    shorter = min(span[1] - span[0], reference[1] - reference[0])
    moved = (span[0] + offset, span[1] + offset)
    return offset if abs(offset) <= _LARGEST_ZONE_S and _overlap(moved, reference) > _LEAST_OVERLAP * shorter else 0.0


def shifted(survey: LogSurvey, offset: float) -> LogSurvey:
    """Return the survey with `offset` s added to its clock."""
    if offset == 0.0:
        return survey
    return replace(survey, topics=tuple(_with_offset(topic, offset) for topic in survey.topics))


def _with_offset(topic: TopicSummary, offset: float) -> TopicSummary:
    time = topic.time
    if time is None:
        return topic
    spec = time if isinstance(time, TimeSpec) else TimeSpec(time.symbol, time.source, time.unit)
    return replace(topic, time=replace(spec, clock_offset=offset), start=topic.start + offset)
