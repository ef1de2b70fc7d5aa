"""One ordered map over threads or processes."""

from seatrial.numerics.workers.pool import mapped, mapped_in_processes, worker_count

__all__ = ["mapped", "mapped_in_processes", "worker_count"]
