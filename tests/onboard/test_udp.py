"""A socket anyone can reach: floods, giants and garbage are dropped and counted, in bounded memory."""

import socket
import tracemalloc
from collections.abc import Iterator
from threading import Event, Thread
from time import monotonic

import pytest

from seatrial.core.values import InputError
from seatrial.onboard.lines import MAX_DATAGRAM_BYTES, TokenBucket, UdpLines


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def lines(clock: Clock) -> Iterator[UdpLines]:
    made = UdpLines(0, rate=10.0, clock=clock)
    yield made
    made.close()


@pytest.fixture
def sender() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as made:
        yield made


def everything(lines: UdpLines) -> list[bytes]:
    found: list[bytes] = []
    while come := lines.read(0.05).lines:
        found += come
    return found


def test_a_datagram_holds_one_line_or_more(lines: UdpLines, sender: socket.socket) -> None:
    for datagram in (b"0,1", b"1,2\n2,3\r\n", b"", b"\n\n"):
        sender.sendto(datagram, ("127.0.0.1", lines.port))
    assert everything(lines) == [b"0,1", b"1,2", b"2,3\r"]
    assert lines.counts.dropped == 0 and not lines.is_over


def test_a_flood_is_cut_to_five_times_the_rate(lines: UdpLines, sender: socket.socket, clock: Clock) -> None:
    """1000 lines a second where 10 were expected, ten seconds long; the first second's worth is granted at once."""
    passed = 0
    for _ in range(100):
        clock.now += 0.1
        for k in range(100):
            sender.sendto(b"%d,1" % k, ("127.0.0.1", lines.port))
            if k % 50 == 49:
                passed += len(lines.read(0.0).lines)
    assert 500 <= passed <= 560
    assert passed + lines.counts.dropped == 10000 and "5 times" in lines.counts.last_problem


def test_after_a_flood_the_rate_passes_again(lines: UdpLines, sender: socket.socket, clock: Clock) -> None:
    for _ in range(100):
        sender.sendto(b"x", ("127.0.0.1", lines.port))
    everything(lines)
    dropped = lines.counts.dropped
    assert dropped > 0
    for k in range(50):
        clock.now += 0.1
        sender.sendto(b"%d" % k, ("127.0.0.1", lines.port))
        assert lines.read(0.5).lines == [b"%d" % k]
    assert lines.counts.dropped == dropped


def test_giants_are_dropped(lines: UdpLines, sender: socket.socket) -> None:
    sender.sendto(b"x" * (MAX_DATAGRAM_BYTES + 1), ("127.0.0.1", lines.port))
    sender.sendto(b"y" * 5000 + b"\n0,1", ("127.0.0.1", lines.port))
    assert everything(lines) == [b"0,1"] and lines.counts.dropped == 2


def test_a_flood_of_nothing_does_not_hold_the_reader(lines: UdpLines, sender: socket.socket) -> None:
    stop = Event()

    def flood() -> None:
        while not stop.is_set():
            sender.sendto(b"", ("127.0.0.1", lines.port))

    thread, since = Thread(target=flood), monotonic()
    thread.start()
    found = lines.read(0.1).lines
    stop.set()
    thread.join()
    assert found == [] and monotonic() - since < 2.0


def test_memory_stays_while_flooded(lines: UdpLines, sender: socket.socket) -> None:
    def flood() -> None:
        for _ in range(20):
            for _ in range(20):
                sender.sendto(b"z" * 4000, ("127.0.0.1", lines.port))
            lines.read(0.0)

    flood()
    tracemalloc.start()
    try:
        flood()
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(3):
            flood()
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 4000


def test_a_bucket_grants_the_rate_on_the_average(clock: Clock) -> None:
    bucket = TokenBucket(50.0, clock)
    total = 0
    for _ in range(1000):
        clock.now += 0.1
        total += bucket.take(7)
    assert total == pytest.approx(5000, abs=51)


@pytest.mark.parametrize(
    ("host", "port", "text"),
    [("a..b", 5000, "cannot listen"), ("192.0.2.7", 5000, "cannot listen"), ("127.0.0.1", 99999, "no UDP port 99999")],
)
def test_an_address_that_cannot_be_listened_to_is_refused(host: str, port: int, text: str) -> None:
    with pytest.raises(InputError, match=text):
        UdpLines(port, rate=10.0, host=host)


def test_a_port_in_use_is_refused(lines: UdpLines) -> None:
    with pytest.raises(InputError, match="choose another"):
        UdpLines(lines.port, rate=10.0)


def test_only_loopback_is_listened_to(lines: UdpLines) -> None:
    assert lines._socket.getsockname()[0] == "127.0.0.1"
