"""Timing and the JSON line that every peer prints: seconds and CPU seconds are medians over `reps` after one warm-up.

What takes longer than LONG seconds is not repeated: its warm-up counts.
"""

import argparse
import json
import resource
import statistics
import time

LONG = 5.0


def arguments(folder=False):
    """Workload and options, the same as those of `cargo bench --bench workloads`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    parser.add_argument("--p", type=int)
    parser.add_argument("--n", type=int)
    parser.add_argument("--reps", type=int, default=3)
    parser.add_argument("--nosolve", action="store_true")
    if folder:
        parser.add_argument("--folder", required=True)
    return parser.parse_args()


def cpu():
    """User and system seconds of the process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def cpu_of(work):
    """The result of `work` and its CPU seconds."""
    before = cpu()
    result = work()
    return result, cpu() - before


def timed(work, reps):
    """Median seconds, median CPU seconds and the last result of `work`, run once before."""
    wall, used, result = [], [], None
    for k in range(reps + 1):
        result = None  # memory is given back first, as in a first assembly
        start = time.perf_counter()
        result, seconds = cpu_of(work)
        if seconds > LONG:
            return time.perf_counter() - start, seconds, result
        if k > 0:
            wall.append(time.perf_counter() - start)
            used.append(seconds)
    return statistics.median(wall), statistics.median(used), result


def line(peer, version, options, p, n, **fields):
    """The record."""
    record = {"peer": peer, "version": version, "workload": options.name, "p": p, "n": n, "threads": 1, "reps": options.reps}
    record.update(fields)
    record.setdefault("notes", "")
    record["peak_rss_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps(record))
