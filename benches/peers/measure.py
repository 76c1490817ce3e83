"""Timing and the JSON line that every peer prints: seconds and CPU seconds are medians over `reps` after one warm-up."""

import argparse
import json
import resource
import statistics
import time


def arguments():
    """Workload and options, the same as those of `cargo bench --bench workloads`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    parser.add_argument("--p", type=int)
    parser.add_argument("--n", type=int)
    parser.add_argument("--reps", type=int, default=3)
    parser.add_argument("--nosolve", action="store_true")
    return parser.parse_args()


def cpu():
    """User and system seconds of the process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def timed(work, reps):
    """Median seconds, median CPU seconds and the last result of `work`, run once before."""
    work()
    wall, used, result = [], [], None
    for _ in range(reps):
        result = None  # memory is given back first, as in a first assembly
        start, before = time.perf_counter(), cpu()
        result = work()
        wall.append(time.perf_counter() - start)
        used.append(cpu() - before)
    return statistics.median(wall), statistics.median(used), result


def line(peer, version, options, p, n, **fields):
    """The record."""
    record = {"peer": peer, "version": version, "workload": options.name, "p": p, "n": n, "threads": 1, "reps": options.reps}
    record.update(fields)
    record.setdefault("notes", "")
    record["peak_rss_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps(record))
