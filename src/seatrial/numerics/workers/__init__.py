"""Ordered maps over threads or processes, independent of their number."""

from seatrial.numerics.workers.pool import limited_workers, map_in_processes, map_in_threads, worker_count

__all__ = ["limited_workers", "map_in_processes", "map_in_threads", "worker_count"]
