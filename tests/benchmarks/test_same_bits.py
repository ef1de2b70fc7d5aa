"""A sample of the comparison of bits: one example, with two threads and another order of sets."""

from benchmarks.same_bits import EXAMPLES, differences


def test_threads_and_the_order_of_sets_change_no_bit() -> None:
    circumstances = {
        "one": {"NUMBA_NUM_THREADS": "1", "PYTHONHASHSEED": "1"},
        "two": {"NUMBA_NUM_THREADS": "2", "PYTHONHASHSEED": "2"},
    }
    assert differences(EXAMPLES / "fin_decay.toml", circumstances) == []
