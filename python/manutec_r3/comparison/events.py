"""Two lists of events side by side: whether they are the same, and how far apart in time.

Events are the same if their axes, elements and branches before and after are. Those of one instant
have no order among themselves, and instants as close as roundoff are one.
"""

from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import pairwise, zip_longest

import numpy as np

from ..arguments import number
from ..events import Event, Events


@dataclass(frozen=True)
class EventComparison:
    """What two lists of events have in common, and where they part.

    Attributes
    ----------
    pairs : tuple of (Event, Event)
        The same event in the list and in the reference.
    extra : tuple of Event
        Events of the list that the reference lacks.
    missing : tuple of Event
        Events of the reference that the list lacks.
    first_difference : (Event or None, Event or None) or None
        The first event of the list and of the reference that are not the same, None for one that
        has ended; None instead of both if the sequences are the same.
    """

    pairs: tuple[tuple[Event, Event], ...]
    extra: tuple[Event, ...]
    missing: tuple[Event, ...]
    first_difference: tuple[Event | None, Event | None] | None

    @property
    def same_sequence(self) -> bool:
        """Whether both lists are the same but for instants."""
        return self.first_difference is None

    @property
    def furthest(self) -> tuple[Event, Event] | None:
        """The pair whose instants are furthest apart; None if there is no pair."""
        return max(self.pairs, key=_apart, default=None)

    @property
    def largest_time_difference(self) -> float:
        """How far apart the instants of a pair are at most [s]."""
        furthest = self.furthest
        return _apart(furthest) if furthest else 0.0

    def __str__(self) -> str:
        if self.first_difference:
            ours, theirs = map(_words, self.first_difference)
            said = f"different, {len(self.extra)} too many, {len(self.missing)} missing\n"
            said += f"first difference: {ours}; in the reference {theirs}\n"
            said += f"{len(self.pairs)} are the same"
        elif self.pairs:
            said = f"the same {len(self.pairs)}"
        else:
            return "none in either"
        if self.furthest and self.largest_time_difference > 0.0:
            said += f", at most {self.largest_time_difference:.2g} s apart"
            said += f" ({_words(self.furthest[0])})"
        return said


def compare_events(
    events: Events, reference: Events, *, roundoff: float = 1e-12
) -> EventComparison:
    """Compare a list of events with another.

    Parameters
    ----------
    events, reference : Events
        Such as `Result.events`.
    roundoff : float
        Events that are not further apart in one of the lists [s] have no order there. The default
        is what independent implementations at tolerances of 1e-12 differ by.

    Returns
    -------
    EventComparison

    Raises
    ------
    TypeError, ValueError
        What was wrong, what was expected, what arrived.

    Examples
    --------
    >>> scenario = r3.Scenario.load("figure9-quintic")
    >>> compared = r3.compare_events(scenario.run().events, scenario.run(rtol=1e-10).events)
    >>> compared.same_sequence, compared.largest_time_difference < 1e-6
    (True, True)
    """
    for name, value in {"events": events, "reference": reference}.items():
        if not isinstance(value, Events):
            raise TypeError(f"{name}: expected Events, such as result.events, got {value!r}")
    roundoff = number("roundoff", roundoff, "s")
    if roundoff < 0.0:
        raise ValueError(f"roundoff: expected a time that is not negative, got {roundoff:g} s")

    ours, theirs = list(events), list(reference)
    pairs = _common_beginning(ours, theirs, roundoff)
    ours, theirs = (_ordered(rest[len(pairs) :], roundoff) for rest in (ours, theirs))
    extra, missing = [], []
    keys, their_keys = (list(map(_key, rest)) for rest in (ours, theirs))
    matcher = SequenceMatcher(None, keys, their_keys, autojunk=False)
    for tag, i, i_end, j, j_end in matcher.get_opcodes():
        if tag == "equal":
            pairs += zip(ours[i:i_end], theirs[j:j_end], strict=True)
        else:
            extra += ours[i:i_end]
            missing += theirs[j:j_end]
    beside = zip_longest(ours, theirs)
    first = next((both for both in beside if None in both or _key(both[0]) != _key(both[1])), None)
    return EventComparison(tuple(pairs), tuple(extra), tuple(missing), first)


def _key(event: Event) -> tuple[int, str, int, int]:
    return event[1:]


def _common_beginning(
    ours: list[Event], theirs: list[Event], roundoff: float
) -> list[tuple[Event, Event]]:
    """Pairs of the same events from the start on.

    As long as the lists are the same, events stand at the same places in both; so events are of one
    instant if they are in one of the lists.
    """
    n = min(len(ours), len(theirs))
    apart = (_gaps(ours[:n]) > roundoff) & (_gaps(theirs[:n]) > roundoff)
    begins = [0, *(1 + np.flatnonzero(apart)), n]
    pairs: list[tuple[Event, Event]] = []
    for begin, end in pairwise(begins):
        a, b = (sorted(events[begin:end], key=_key) for events in (ours, theirs))
        if list(map(_key, a)) != list(map(_key, b)):
            break
        pairs += zip(a, b, strict=True)
    return pairs


def _ordered(events: list[Event], roundoff: float) -> list[Event]:
    """Events with those of one instant in the order of their keys."""
    instants = np.concatenate(([0], np.cumsum(_gaps(events) > roundoff)))
    numbered = sorted(zip(instants, map(_key, events), events, strict=False))
    return [event for _, _, event in numbered]


def _gaps(events: list[Event]) -> np.ndarray:
    """Time from each event to the next [s]."""
    return np.diff([event.time for event in events])


def _apart(pair: tuple[Event, Event]) -> float:
    return abs(pair[0].time - pair[1].time)


def _words(event: Event | None) -> str:
    if event is None:
        return "no further event"
    place = f" of axis {event.axis}" if event.axis else ""
    switch = f", {event.before} to {event.after}" if event.before != event.after else ""
    return f"{event.element.replace('_', ' ')}{place} at {event.time:.9g} s{switch}"
